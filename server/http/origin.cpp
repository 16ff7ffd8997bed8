#include "server/http/origin.h"

#include <arpa/inet.h>
#include <strings.h>

#include <string>

#include "server/http/problem.h"

namespace server {
namespace {

bool same_ignoring_case(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

bool is_port(std::string_view text) {
  return text.find_first_not_of("0123456789") == text.npos;
}

/// Host and port of an http or https origin; none for "null" and what is no web page's.
std::optional<std::string_view> authority_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  return std::nullopt;
}

}  // namespace

bool names_this_machine(std::string_view host) {
  const std::size_t colon = host.find(':', host.starts_with('[') ? host.find(']') : 0);
  if (colon != host.npos) {
    if (!is_port(host.substr(colon + 1))) return false;
    host = host.substr(0, colon);
  }
  if (same_ignoring_case(host, "localhost") || host == "[::1]") return true;
  in_addr address{};
  return ::inet_pton(AF_INET, std::string(host).c_str(), &address) == 1 &&
         (ntohl(address.s_addr) >> 24) == 127;
}

std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, bool this_machine_only) {
  const auto host = request.header("Host");
  if (this_machine_only && host && !names_this_machine(*host))
    return problem(421, "this service answers for localhost only, not for the host that was asked for",
                   request.path);
  const auto origin = request.header("Origin");
  if (!origin || request.method == "GET" || request.method == "HEAD") return std::nullopt;
  const auto theirs = authority_of(*origin);
  if (theirs && host && same_ignoring_case(*theirs, *host)) return std::nullopt;
  return problem(403, "a page of another origin may not change anything here", request.path);
}

}  // namespace server
