// What a token allows.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "api/result.h"

namespace server {

enum class Scope { jobs_read, jobs_write, queue_admin, metrics_read };

inline constexpr std::array kScopes{Scope::jobs_read, Scope::jobs_write, Scope::queue_admin,
                                    Scope::metrics_read};

/// "jobs:read"
std::string_view name_of(Scope scope);
std::optional<Scope> scope_named(std::string_view name);

/// A set of scopes.
class Scopes {
 public:
  Scopes() = default;
  void add(Scope scope) { bits_ |= 1u << static_cast<unsigned>(scope); }
  bool has(Scope scope) const { return (bits_ & (1u << static_cast<unsigned>(scope))) != 0; }
  bool empty() const { return bits_ == 0; }

 private:
  unsigned bits_ = 0;
};

/// "jobs:read,jobs:write", in any order. Errors: invalid_request naming the word that is no scope; an empty
/// list.
api::Result<Scopes> parse_scopes(std::string_view list);
/// The names with commas between them.
std::string text_of(const Scopes& scopes);

}  // namespace server
