#include "server/config.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>
#include <system_error>

#include "server/text.h"

namespace server {
namespace {

std::optional<std::int64_t> number_within(std::string_view text, std::int64_t least, std::int64_t most) {
  const auto value = whole_number(text);
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

api::Result<Address> parse_address(std::string_view option, std::string_view text) {
  Address address;
  const std::size_t colon = text.rfind(':');
  const auto port = colon == text.npos ? std::nullopt : number_within(text.substr(colon + 1), 0, 65535);
  if (!port || colon == 0)
    return wrong_use(std::string(option) + ": '" + std::string(text) + "' is not HOST:PORT");
  address.port = static_cast<int>(*port);
  std::string_view host = text.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  address.host = host;
  return address;
}

api::Status take_listen(std::string_view text, Config& config) {
  auto address = parse_address("--listen", text);
  if (!address) return address.error();
  config.host = std::move(address->host);
  config.port = address->port;
  return api::Done{};
}

api::Status take_ops_listen(std::string_view text, Config& config) {
  config.ops = Address{};
  if (text == "off") return api::Done{};
  auto address = parse_address("--ops-listen", text);
  if (!address) return address.error();
  config.ops = std::move(*address);
  return api::Done{};
}

api::Status take_log_format(std::string_view text, Config& config) {
  if (text != "text" && text != "json") return wrong_use("--log: must be text or json");
  config.log_format = text == "json" ? LogFormat::json : LogFormat::text;
  return api::Done{};
}

bool is_name_of_machine(std::string_view text) {
  return !text.empty() && text.size() <= 253 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' || c == '-';
  });
}

/// A name without a port, as browsers send it: "render.example.org".
api::Status take_public_host(std::string_view text, Config& config) {
  if (!is_name_of_machine(text))
    return wrong_use("--public-host: '" + std::string(text) + "' is not the name of a host, without a port");
  config.public_hosts.emplace_back(text);
  return api::Done{};
}

struct NumberOption {
  std::string_view name;
  std::int64_t least;
  std::int64_t most;
  void (*set)(Config& config, std::int64_t value);
};

constexpr std::int64_t kBytesMost = std::int64_t{1} << 60;
constexpr std::int64_t kDaysMost = 36'500;

constexpr std::array kNumbers{
    NumberOption{"--check-seconds", 0, kDaysMost * 86'400,
                 [](Config& config, std::int64_t n) { config.check_seconds = n; }},
    NumberOption{"--worker-threads", 1, 1024,
                 [](Config& config, std::int64_t n) { config.worker_threads = static_cast<unsigned>(n); }},
    NumberOption{
        "--worker-threads-total", 1, 1024,
        [](Config& config, std::int64_t n) { config.worker_threads_total = static_cast<unsigned>(n); }},
    NumberOption{"--worker-memory-mb", 64, std::int64_t{1} << 30,
                 [](Config& config, std::int64_t n) { config.worker_memory_mb = n; }},
    NumberOption{"--max-upload-bytes", 1, std::int64_t{1} << 40,
                 [](Config& config, std::int64_t n) { config.upload_bytes_max = n; }},
    NumberOption{"--rate-limit", 0, 1'000'000,
                 [](Config& config, std::int64_t n) { config.requests_per_second = static_cast<double>(n); }},
    NumberOption{"--max-queued-per-token", 1, 10'000,
                 [](Config& config, std::int64_t n) { config.queued_per_owner_max = n; }},
    NumberOption{"--max-stored-bytes", 1, kBytesMost,
                 [](Config& config, std::int64_t n) { config.stored_bytes_max = n; }},
    NumberOption{"--max-stored-bytes-per-token", 1, kBytesMost,
                 [](Config& config, std::int64_t n) { config.stored_bytes_per_owner_max = n; }},
    NumberOption{"--max-blob-bytes", 1, kBytesMost,
                 [](Config& config, std::int64_t n) { config.blob_bytes_max = n; }},
    NumberOption{"--blob-hours", 1, 24 * kDaysMost,
                 [](Config& config, std::int64_t n) { config.blob_hours = n; }},
    NumberOption{"--default-ttl-days", 1, kDaysMost,
                 [](Config& config, std::int64_t n) { config.ttl_days = n; }},
};

/// As the system writes addresses of clients, which is what it is compared with.
api::Status take_proxy(std::string_view text, Config& config) {
  const std::string given(text);
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  std::array<char, INET6_ADDRSTRLEN> shown{};
  for (const int family : {AF_INET, AF_INET6})
    if (::inet_pton(family, given.c_str(), bytes.data()) == 1) {
      config.proxies.emplace_back(::inet_ntop(family, bytes.data(), shown.data(), shown.size()));
      return api::Done{};
    }
  // What ends in a digit is meant as an address, and no name does.
  if (!is_name_of_machine(text) || (text.back() >= '0' && text.back() <= '9'))
    return wrong_use("--proxy: '" + given + "' is neither the address nor the name of a machine");
  config.proxies.push_back(given);
  return api::Done{};
}

const NumberOption* number_named(std::string_view name) {
  const auto* found = std::find_if(kNumbers.begin(), kNumbers.end(),
                                   [&](const NumberOption& option) { return option.name == name; });
  return found == kNumbers.end() ? nullptr : found;
}

api::Status take_option(std::string_view name, std::string_view value, Config& config) {
  if (name == "--data") config.data = value;
  if (name == "--worker") config.worker = value;
  if (name == "--dashboard") config.dashboard = value;
  if (name == "--token-file") config.token_file = value;
  if (name == "--listen") return take_listen(value, config);
  if (name == "--ops-listen") return take_ops_listen(value, config);
  if (name == "--public-host") return take_public_host(value, config);
  if (name == "--log") return take_log_format(value, config);
  if (name == "--proxy") return take_proxy(value, config);
  const NumberOption* number = number_named(name);
  if (!number) return api::Done{};
  const auto given = number_within(value, number->least, number->most);
  if (!given)
    return wrong_use(std::string(name) + ": must be a whole number from " + std::to_string(number->least) +
                     " to " + std::to_string(number->most));
  number->set(config, *given);
  return api::Done{};
}

constexpr std::array kOthers{OptionName{"--dashboard"},
                             OptionName{"--data"},
                             OptionName{"--listen"},
                             OptionName{"--log"},
                             OptionName{"--ops-listen"},
                             OptionName{"--token-file"},
                             OptionName{"--worker"},
                             OptionName{"--proxy", OptionKind::list},
                             OptionName{"--public-host", OptionKind::list},
                             OptionName{"--evict", OptionKind::flag},
                             OptionName{"--insecure-public", OptionKind::flag},
                             OptionName{"--ops-open", OptionKind::flag}};

bool takes_value(std::string_view name) {
  const auto* found = std::find_if(kOthers.begin(), kOthers.end(),
                                   [&](const OptionName& option) { return option.name == name; });
  return found == kOthers.end() ? number_named(name) != nullptr : found->kind != OptionKind::flag;
}

struct FlagOption {
  std::string_view name;
  bool Config::*value;
};
constexpr std::array kFlags{FlagOption{"--evict", &Config::evict},
                            FlagOption{"--insecure-public", &Config::insecure_public},
                            FlagOption{"--ops-open", &Config::ops_open}};

/// "--evict", "--evict=false", "--no-evict". False: `word` is no flag. Errors: invalid_request for a value
/// that is neither true nor false.
api::Result<bool> take_flag(std::string_view word, Config& config) {
  const std::size_t equals = word.find('=');
  for (const FlagOption& flag : kFlags) {
    if (word == flag.name || word == opposite_of(flag.name)) {
      config.*flag.value = word == flag.name;
      return true;
    }
    if (equals == word.npos || word.substr(0, equals) != flag.name) continue;
    const auto truth = truth_of(word.substr(equals + 1));
    if (!truth) return wrong_use(std::string(flag.name) + ": must be true or false");
    config.*flag.value = *truth;
    return true;
  }
  return false;
}

bool is_program(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

std::filesystem::path folder_of_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

/// Where the build puts it; empty: it was built without.
std::filesystem::path find_dashboard() {
  std::error_code error;
  const auto beside = folder_of_program() / "dashboard";
  return std::filesystem::is_directory(beside, error) ? beside : std::filesystem::path();
}

/// Beside this program, or along PATH.
std::filesystem::path find_worker() {
  const auto here = folder_of_program();
  if (is_program(here / "keylume")) return here / "keylume";
  const char* variable = std::getenv("PATH");
  std::string_view folders = variable ? variable : "";
  while (!folders.empty()) {
    const std::size_t colon = folders.find(':');
    const auto path = std::filesystem::path(folders.substr(0, colon)) / "keylume";
    if (is_program(path)) return path;
    folders = colon == folders.npos ? std::string_view() : folders.substr(colon + 1);
  }
  return {};
}

api::Result<CommandLine> complete(Config config) {
  if (config.data.empty()) return wrong_use("--data DIR is missing: where jobs are to be kept");
  if (config.worker.empty()) config.worker = find_worker();
  if (config.worker.empty())
    return wrong_use("the worker 'keylume' is not found; say where it is with --worker PATH");
  if (!is_program(config.worker))
    return wrong_use("--worker: " + config.worker.string() + " cannot be executed");
  config.worker = std::filesystem::absolute(config.worker);
  std::error_code error;
  if (config.dashboard.empty())
    config.dashboard = find_dashboard();
  else if (!std::filesystem::is_directory(config.dashboard, error))
    return wrong_use("--dashboard: " + config.dashboard.string() + " is no folder");
  return CommandLine(std::move(config));
}

}  // namespace

double rate_limit(const Config& config, std::string_view host) {
  constexpr double kOfStrangers = 50;
  return config.requests_per_second.value_or(is_loopback(host) ? 0 : kOfStrangers);
}

bool is_loopback(std::string_view host) {
  in_addr address{};
  const std::string text(host);
  if (::inet_pton(AF_INET, text.c_str(), &address) == 1) return (ntohl(address.s_addr) >> 24) == 127;
  return host == "localhost" || host == "::1";
}

bool asks_for_tokens(const Config& config) {
  const bool ops_is_public =
      config.ops && !config.ops->host.empty() && !config.ops_open && !is_loopback(config.ops->host);
  return !config.insecure_public && (ops_is_public || !is_loopback(config.host));
}

std::span<const OptionName> option_names() {
  static const std::vector<OptionName> all = [] {
    std::vector<OptionName> names(kOthers.begin(), kOthers.end());
    for (const NumberOption& number : kNumbers) names.push_back({number.name});
    return names;
  }();
  return all;
}

api::Result<Config> parse_options(std::span<const std::string_view> words) {
  Config config;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    const auto is_flag = take_flag(word, config);
    if (!is_flag) return is_flag.error();
    if (*is_flag) continue;
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    if (!takes_value(name)) return wrong_use(std::string("'").append(word).append("' is not an option"));
    if (equals == word.npos && i + 1 == words.size())
      return wrong_use(std::string(name) + ": a value is missing");
    const std::string_view value = equals == word.npos ? words[++i] : word.substr(equals + 1);
    if (const api::Status taken = take_option(name, value, config); !taken) return taken.error();
  }
  return config;
}

std::optional<CommandLine> asked_to_tell(std::span<const std::string_view> words) {
  for (const std::string_view word : words) {
    if (word == "--help" || word == "-h") return CommandLine(ShowHelp{});
    if (word == "--version") return CommandLine(ShowVersion{});
  }
  return std::nullopt;
}

api::Result<CommandLine> parse_command_line(std::span<const std::string_view> words) {
  if (auto asked = asked_to_tell(words)) return std::move(*asked);
  auto config = parse_options(words);
  if (!config) return config.error();
  return complete(std::move(*config));
}

std::string help_text() {
  return R"(keylume-server: renders animated radiosity for whoever asks over HTTP

usage: keylume-server --data DIR [options]

  --data DIR              where jobs, uploads and results are kept; made if missing
  --listen HOST:PORT      default 127.0.0.1:8080; port 0 takes any free one
  --ops-listen HOST:PORT  a second listener with threads of its own, for /healthz, /readyz, /metrics and /version
                          alone, or off; default: 127.0.0.1 and the port after --listen's, if it is free
  --dashboard DIR         the web dashboard, as it was built; default: the folder dashboard beside this program, if
                          there is one
  --worker PATH           the worker program; default: keylume beside this program, or along PATH
  --worker-threads N      threads of one job; default: as many as all jobs together may use
  --worker-threads-total N
                          threads of all jobs that run at once; default: all cores
  --worker-memory-mb N    memory of all jobs that run at once, by their forecasts; a job that needs more runs
                          alone; default: four fifths of this machine's
  --max-upload-bytes N    of one job; default 2147483648
  --max-queued-per-token N
                          jobs that those who share a token may have in the queue; default 10000
  --max-stored-bytes N    of all jobs with their results, views and videos, and all blobs; default: what the disk
                          holds
  --max-stored-bytes-per-token N
                          of those of one token; default: no limit
  --evict                 above --max-stored-bytes, remove finished jobs that are not pinned rather than refuse new
                          ones, those first whose results nobody has asked for for longest
  --default-ttl-days N    that a finished job is kept which does not say so itself (ttl_seconds); default: until it
                          is removed
  --max-blob-bytes N      of all blobs together; default 8589934592
  --blob-hours N          that a blob is kept without being used; default 24
  --check-seconds N       how often the database and the files of jobs are checked, in the background: a share of the
                          files each time, for a 24th of N at most; 0: never; default 86400. What is damaged is
                          refused, logged, and told by /readyz and /metrics
  --rate-limit N          requests per second of one token or address, 0 for no limit; default: none where only
                          this machine can reach HOST, else 50
  --public-host NAME      a name by which browsers may ask for the service, without a port; may be given several
                          times. Others are refused, but for localhost and, where other machines can reach HOST,
                          any address in numbers
  --proxy ADDRESS         a proxy in front of the service, by address or name, whose X-Forwarded-For and
                          X-Forwarded-Proto are believed; may be given several times
  --log text|json         how lines on standard error look; default: text on a terminal, else json
  --insecure-public       allow a HOST that other machines can reach without a token, because something else keeps
                          strangers out
  --ops-open              the second listener asks nobody for a token, wherever it listens: for a network that only
                          those who watch the service reach
  --token-file FILE       where other machines can reach HOST and there has never been a token: take the one in FILE,
                          or make one, put it there and print it, once. Its name is operator, its scopes are all
  --config FILE           more options, a line each: max-upload-bytes = 1000000; # begins a comment
  --help, --version

Every option is also a variable of the environment: KEYLUME_MAX_UPLOAD_BYTES=1000000; flags are true or false, several
names are separated by commas. The command line comes before the environment, that before the file; there
--no-evict, or --evict=false, takes a flag back.

other commands, each but health with --data DIR or KEYLUME_DATA:
  token create NAME [--scopes LIST] [--expires-days N] [--out FILE] [--if-none] [--again]
                          make a token and print it, once; LIST: jobs:read,jobs:write,queue:admin,metrics:read
                          (default jobs:read,jobs:write). From the first one on the service asks for tokens. Jobs
                          belong to the token's NAME; with queue:admin one sees and steers those of all. --again:
                          another token of a NAME that has one, to replace it: both share their jobs
  token list              names, scopes and dates
  token revoke NAME       all tokens of that name, or the one with that prefix; at once, also where a server runs
  backup FOLDER           the database, tokens and files of all jobs into a new FOLDER, with SHA256SUMS; also while
                          a server runs. Without blobs: they are sent again
  restore FOLDER          a backup into a data folder that does not exist yet
  check                   is the database whole, and every file as it was made? Also while a server runs
  gc                      remove what a crash left and jobs whose time is over; a running server does so by itself
  migrate                 bring the database to this version's schema; the server does so when it starts
  health                  does the server answer that has these options or this environment? Exit code 0: it does

GET /openapi.json describes every request. SIGTERM stops the service within 10 s: no new connections, short
requests end, running jobs leave a checkpoint and stay queued; a second SIGTERM ends it at once.

exit codes: 0 stopped as told, 1 failed, 64 wrong command line, 69 the port cannot be taken,
            75 another server uses the data folder
)";
}

}  // namespace server
