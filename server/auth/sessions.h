// Who has logged in with a browser. A cookie goes to every port of a host, so what it holds is not the token
// but a random name for this login, of no use anywhere else, after its end, or once the token is revoked.
//
// Kept in memory alone: a file of them would be one more secret to guard, and after a restart of the service
// people log in again.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "api/result.h"

namespace server {

struct SessionRules {
  std::int64_t lasts_ms = std::int64_t{7} * 24 * 3600 * 1000;
  std::size_t per_token_max = 50;  ///< beyond it the oldest of the token ends
  std::size_t all_max = 10'000;    ///< beyond it the oldest of all
};

/// Safe for use by several threads.
class Sessions {
 public:
  explicit Sessions(SessionRules rules = {}) : rules_(rules) {}

  /// -> the name of a new login. `token_text` has been found to be valid. Errors: internal without
  /// randomness.
  api::Result<std::string> begin(std::string_view token_text, std::int64_t now_ms);
  /// The token that the login was made with; whether it is still valid is to be asked. None: there is no such
  /// login, or its time is over.
  std::optional<std::string> token_of(std::string_view session, std::int64_t now_ms);
  void end(std::string_view session);
  std::size_t count() const;

 private:
  struct Session {
    std::string token_text;
    std::int64_t ends_ms = 0;
    std::uint64_t number = 0;  ///< in the order of their begin
  };
  void make_room(std::string_view token_text, std::int64_t now_ms);

  const SessionRules rules_;
  mutable std::mutex mutex_;
  std::uint64_t next_ = 0;
  std::map<std::string, Session>
      sessions_;  ///< by the SHA-256 of their names: looking one up tells nothing of it
};

}  // namespace server
