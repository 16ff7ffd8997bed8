#include "server/http/origin.h"

#include <arpa/inet.h>

#include <algorithm>
#include <string>

#include "server/http/field_text.h"
#include "server/http/problem.h"

namespace server {
namespace {

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

bool answers_for(std::string_view host, const HostRules& rules) {
  const std::size_t colon = host.find(':', host.starts_with('[') ? host.find(']') : 0);
  if (colon != host.npos) {
    if (!is_port(host.substr(colon + 1))) return false;
    host = host.substr(0, colon);
  }
  const auto is_named = [&](std::string_view name) { return same_ignoring_case(host, name); };
  if (is_named("localhost") || std::any_of(rules.names.begin(), rules.names.end(), is_named)) return true;
  if (host.starts_with('[') && host.ends_with(']')) {
    in6_addr address{};
    const std::string digits(host.substr(1, host.size() - 2));
    if (::inet_pton(AF_INET6, digits.c_str(), &address) != 1) return false;
    return !rules.this_machine_only || IN6_IS_ADDR_LOOPBACK(&address);
  }
  in_addr address{};
  if (::inet_pton(AF_INET, std::string(host).c_str(), &address) != 1) return false;
  return !rules.this_machine_only || (ntohl(address.s_addr) >> 24) == 127;
}

std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request, const HostRules& rules) {
  const auto host = request.header("Host");
  if (host && !answers_for(*host, rules))
    return problem(
        421,
        "this service does not answer for the host that was asked for; its operator can name it with "
        "--public-host",
        request.path);
  const auto origin = request.header("Origin");
  if (!origin || request.method == "GET" || request.method == "HEAD") return std::nullopt;
  const auto theirs = authority_of(*origin);
  if (theirs && host && same_ignoring_case(*theirs, *host)) return std::nullopt;
  return problem(403, "a page of another origin may not change anything here", request.path);
}

}  // namespace server
