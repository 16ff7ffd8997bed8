// How the worker ends. The server classifies an attempt by it; README and `keylume --help` list it.
#pragma once

namespace api {

enum class ExitCode : int {
  ok = 0,              ///< every artefact is published and listed in artefacts/manifest.json
  internal = 1,        ///< a bug or an I/O failure; worth another attempt
  invalid_input = 2,   ///< the job itself is wrong: violations are in report.json; do not try again
  limit_exceeded = 3,  ///< the job asks for more than the limits allow; do not try again
  stopped = 4,         ///< told to stop by SIGTERM or SIGINT
  disk_full = 6,       ///< try again when there is room
  usage = 64,          ///< wrong command line
};

}  // namespace api
