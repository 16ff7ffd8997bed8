#include "server/auth/scopes.h"

namespace server {
namespace {

constexpr std::array<std::string_view, 4> kNames{"jobs:read", "jobs:write", "queue:admin", "metrics:read"};
static_assert(kNames.size() == kScopes.size());

}  // namespace

std::string_view name_of(Scope scope) {
  return kNames[static_cast<std::size_t>(scope)];
}

std::optional<Scope> scope_named(std::string_view name) {
  for (const Scope scope : kScopes)
    if (name_of(scope) == name) return scope;
  return std::nullopt;
}

api::Result<Scopes> parse_scopes(std::string_view list) {
  Scopes scopes;
  while (!list.empty()) {
    const std::size_t comma = list.find(',');
    const std::string_view name = list.substr(0, comma);
    const auto scope = scope_named(name);
    if (!scope)
      return api::Error{api::Fault::invalid_request,
                        "'" + std::string(name) +
                            "' is no scope; there are jobs:read, jobs:write, queue:admin and metrics:read"};
    scopes.add(*scope);
    list = comma == list.npos ? std::string_view() : list.substr(comma + 1);
  }
  if (scopes.empty()) return api::Error{api::Fault::invalid_request, "a token needs at least one scope"};
  return scopes;
}

std::string text_of(const Scopes& scopes) {
  std::string text;
  for (const Scope scope : kScopes)
    if (scopes.has(scope)) text += (text.empty() ? "" : ",") + std::string(name_of(scope));
  return text;
}

}  // namespace server
