// How one attempt of a worker at a job ended, as the supervisor saw it.
#pragma once

#include <string>

#include "server/store/job_rows.h"

namespace server {

enum class OutcomeKind {
  done,            ///< says that every artefact is published; not yet believed
  refused,         ///< the job itself is wrong: no other attempt
  limit_exceeded,  ///< the job wants more than the limits allow: no other attempt
  disk_full,       ///< another attempt when there is room; not the job's fault
  time_over,       ///< we stopped it at the job's deadline or run time: no other attempt
  paused,          ///< we stopped it because the job is to pause
  server_stopped,  ///< we stopped it because the server ends; not the job's fault
  not_started,     ///< there was no worker; not the job's fault
  damaged,         ///< an input is no longer what came in: no other attempt
  lost,            ///< crashed, killed, or stuck: counts as an attempt
};

struct AttemptOutcome {
  OutcomeKind kind = OutcomeKind::lost;
  std::string reason;   ///< stable word: "worker_crashed", "stuck", ...
  std::string message;  ///< for people: signal or exit code
  AttemptEnd end;
  std::string log_tail;  ///< the last of what the worker wrote
  int looks_left = 5;    ///< at its files, where we fail to read them for reasons of our own
};

}  // namespace server
