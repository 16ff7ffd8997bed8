#include "server/config.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <system_error>

namespace server {
namespace {

api::Error wrong(std::string message) {
  return {api::Fault::invalid_request, std::move(message)};
}

template <class Number>
bool take_number(std::string_view text, Number least, Number most, Number& value) {
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() && value >= least &&
         value <= most;
}

api::Status take_listen(std::string_view text, Config& config) {
  const std::size_t colon = text.rfind(':');
  if (colon == text.npos || colon == 0 || !take_number(text.substr(colon + 1), 0, 65535, config.port))
    return wrong("--listen: '" + std::string(text) + "' is not HOST:PORT");
  std::string_view host = text.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  config.host = host;
  return api::Done{};
}

api::Status take_option(std::string_view name, std::string_view value, Config& config) {
  if (name == "--data") config.data = value;
  if (name == "--worker") config.worker = value;
  if (name == "--listen") return take_listen(value, config);
  if (name == "--worker-threads" && !take_number(value, 1u, 1024u, config.worker_threads))
    return wrong("--worker-threads: must be a whole number from 1 to 1024");
  if (name == "--max-upload-bytes" &&
      !take_number(value, std::int64_t{1}, std::int64_t{1} << 40, config.upload_bytes_max))
    return wrong("--max-upload-bytes: must be a whole number from 1 to 2^40");
  return api::Done{};
}

bool is_program(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

/// Beside this program, or along PATH.
std::filesystem::path find_worker() {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
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
  if (config.data.empty()) return wrong("--data DIR is missing: where jobs are to be kept");
  if (config.worker.empty()) config.worker = find_worker();
  if (config.worker.empty())
    return wrong("the worker 'keylume' is not found; say where it is with --worker PATH");
  if (!is_program(config.worker)) return wrong("--worker: " + config.worker.string() + " cannot be executed");
  config.worker = std::filesystem::absolute(config.worker);
  if (!is_loopback(config.host) && !config.insecure_public)
    return wrong("--listen: " + config.host +
                 " can be reached from other machines, and whoever reaches the service may use it; listen on "
                 "127.0.0.1, or give --insecure-public where something else keeps strangers out");
  return CommandLine(std::move(config));
}

}  // namespace

bool is_loopback(std::string_view host) {
  in_addr address{};
  const std::string text(host);
  if (::inet_pton(AF_INET, text.c_str(), &address) == 1) return (ntohl(address.s_addr) >> 24) == 127;
  return host == "localhost" || host == "::1";
}

api::Result<CommandLine> parse_command_line(std::span<const std::string_view> words) {
  constexpr std::array<std::string_view, 5> kWithValue{"--data", "--listen", "--worker", "--worker-threads",
                                                       "--max-upload-bytes"};
  Config config;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word == "--help" || word == "-h") return CommandLine(ShowHelp{});
    if (word == "--version") return CommandLine(ShowVersion{});
    if (word == "--insecure-public") {
      config.insecure_public = true;
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    if (std::find(kWithValue.begin(), kWithValue.end(), name) == kWithValue.end())
      return wrong("'" + std::string(word) + "' is not an option");
    if (equals == word.npos && i + 1 == words.size())
      return wrong(std::string(name) + ": a value is missing");
    const std::string_view value = equals == word.npos ? words[++i] : word.substr(equals + 1);
    if (const api::Status taken = take_option(name, value, config); !taken) return taken.error();
  }
  return complete(std::move(config));
}

std::string help_text() {
  return R"(keylume-server: renders animated radiosity for whoever asks over HTTP

usage: keylume-server --data DIR [options]

  --data DIR              where jobs, uploads and results are kept; made if missing
  --listen HOST:PORT      default 127.0.0.1:8080; port 0 takes any free one
  --worker PATH           the worker program; default: keylume beside this program, or along PATH
  --worker-threads N      threads of one job; default: all cores
  --max-upload-bytes N    of one job; default 2147483648
  --insecure-public       allow a HOST that other machines can reach (there is no authentication)
  --help, --version

GET /openapi.json describes every request. SIGTERM stops the service; a running job stays queued.

exit codes: 0 stopped as told, 1 failed, 64 wrong command line, 69 the port cannot be taken,
            75 another server uses the data folder
)";
}

}  // namespace server
