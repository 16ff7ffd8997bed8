// What the operator asked for: the command line of keylume-server, checked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "api/result.h"
#include "server/log.h"
#include "server/settings.h"

namespace server {

struct Address {
  std::string host;
  int port = 0;  ///< 0: any free one
};

struct Config {
  std::filesystem::path data;
  std::string host = "127.0.0.1";
  int port = 8080;  ///< 0: any free one; the log says which
  /// For /healthz, /readyz, /metrics and /version alone, so that clients cannot crowd it out. Empty host:
  /// none.
  std::optional<Address> ops;         ///< none given: 127.0.0.1 and the port after `port`, if it is free
  std::filesystem::path worker;       ///< the worker executable, found and executable
  std::filesystem::path dashboard;    ///< the folder that browsers are shown; empty: none was built
  unsigned worker_threads = 0;        ///< of one job; 0: worker_threads_total
  unsigned worker_threads_total = 0;  ///< of all jobs that run at once; 0: all cores
  std::int64_t worker_memory_mb = 0;  ///< the same; 0: four fifths of this machine's
  std::int64_t upload_bytes_max = std::int64_t{2} << 30;
  std::int64_t queued_per_owner_max = 10'000;
  std::int64_t stored_bytes_max = INT64_MAX;            ///< of all jobs and their results
  std::int64_t stored_bytes_per_owner_max = INT64_MAX;  ///< of those of one token
  std::int64_t check_seconds = 24 * 3600;               ///< from one integrity check to the next; 0: never
  std::optional<double> requests_per_second;  ///< of one token or address; 0: no limit; none: see rate_limit
  std::int64_t blob_bytes_max = std::int64_t{8} << 30;  ///< of all blobs together
  std::int64_t blob_hours = 24;                         ///< that a blob is kept without being used
  std::optional<std::int64_t> ttl_days;  ///< of jobs that do not say how long they are to be kept
  bool evict = false;  ///< remove what nobody has used for longest rather than be over stored_bytes_max
  std::vector<std::string> public_hosts;  ///< names that a Host header may have
  std::vector<std::string> proxies;       ///< addresses and names whose X-Forwarded-* headers are believed
  std::filesystem::path token_file;       ///< of the first token, see make_first_token; empty: none is made
  LogFormat log_format = LogFormat::automatic;
  bool insecure_public = false;  ///< listen beyond this machine although anybody may then use the service
  bool ops_open = false;         ///< `ops` asks nobody for a token, wherever it listens
};

struct ShowHelp {};
struct ShowVersion {};

using CommandLine = std::variant<Config, ShowHelp, ShowVersion>;

/// ShowHelp or ShowVersion, where a word asks for it; for that nothing else need be right.
std::optional<CommandLine> asked_to_tell(std::span<const std::string_view> words);

/// `words` are argv without the program's name. Options are `--name value` or `--name=value`; flags `--name`,
/// `--name=false` or `--no-name`.
/// Errors: invalid_request; the message names the word that is wrong.
api::Result<CommandLine> parse_command_line(std::span<const std::string_view> words);

/// All options, for with_settings.
std::span<const OptionName> option_names();

/// The options alone: what is not given is as in an empty Config, and nothing is looked up.
/// Errors: as of parse_command_line.
api::Result<Config> parse_options(std::span<const std::string_view> words);

/// Can others than this machine reach the service, or what the second listener tells, so that tokens are
/// asked for from the start?
bool asks_for_tokens(const Config& config);

/// Requests per second of one token or address: as told, or none where `host` is loopback and 50 elsewhere.
double rate_limit(const Config& config, std::string_view host);

/// Is `host` an address that only this machine can reach?
bool is_loopback(std::string_view host);

std::string help_text();

}  // namespace server
