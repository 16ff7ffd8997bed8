// What the operator asked for: the command line of keylume-server, checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "api/result.h"

namespace server {

struct Config {
  std::filesystem::path data;
  std::string host = "127.0.0.1";
  int port = 8080;               ///< 0: any free one; the log says which
  std::filesystem::path worker;  ///< the worker executable, found and executable
  unsigned worker_threads = 0;   ///< of one job; 0: all cores
  std::int64_t upload_bytes_max = std::int64_t{2} << 30;
  bool insecure_public = false;  ///< listen beyond this machine although anybody may then use the service
};

struct ShowHelp {};
struct ShowVersion {};

using CommandLine = std::variant<Config, ShowHelp, ShowVersion>;

/// `words` are argv without the program's name. Options are `--name value` or `--name=value`.
/// Errors: invalid_request; the message names the word that is wrong.
api::Result<CommandLine> parse_command_line(std::span<const std::string_view> words);

/// Is `host` an address that only this machine can reach?
bool is_loopback(std::string_view host);

std::string help_text();

}  // namespace server
