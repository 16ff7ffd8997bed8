#include "server/auth/sessions.h"

#include <sys/random.h>

#include <algorithm>
#include <array>

#include "server/artefacts/verify.h"

namespace server {
namespace {

constexpr std::size_t kSecretBytes = 32;

api::Result<std::string> new_name() {
  std::array<unsigned char, kSecretBytes> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return api::Error{api::Fault::internal, "the kernel has no randomness"};
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string name;
  for (const unsigned char byte : bytes) {
    name += kDigits[byte >> 4];
    name += kDigits[byte & 15];
  }
  return name;
}

}  // namespace

void Sessions::make_room(std::string_view token_text, std::int64_t now_ms) {
  std::erase_if(sessions_, [&](const auto& each) { return now_ms >= each.second.ends_ms; });
  const auto end_oldest = [&](const auto& is_one_of_them, std::size_t most) {
    const auto count = std::count_if(sessions_.begin(), sessions_.end(), is_one_of_them);
    if (static_cast<std::size_t>(count) < most) return;
    auto oldest = sessions_.end();
    for (auto at = sessions_.begin(); at != sessions_.end(); ++at)
      if (is_one_of_them(*at) && (oldest == sessions_.end() || at->second.number < oldest->second.number))
        oldest = at;
    if (oldest != sessions_.end()) sessions_.erase(oldest);
  };
  end_oldest([&](const auto& each) { return each.second.token_text == token_text; }, rules_.per_token_max);
  end_oldest([](const auto&) { return true; }, rules_.all_max);
}

api::Result<std::string> Sessions::begin(std::string_view token_text, std::int64_t now_ms) {
  auto name = new_name();
  if (!name) return name;
  const std::lock_guard lock(mutex_);
  make_room(token_text, now_ms);
  sessions_[sha256_of(*name)] = {std::string(token_text), now_ms + rules_.lasts_ms, next_++};
  return name;
}

std::optional<std::string> Sessions::token_of(std::string_view session, std::int64_t now_ms) {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(sha256_of(session));
  if (found == sessions_.end() || now_ms >= found->second.ends_ms) return std::nullopt;
  return found->second.token_text;
}

void Sessions::end(std::string_view session) {
  const std::lock_guard lock(mutex_);
  sessions_.erase(sha256_of(session));
}

std::size_t Sessions::count() const {
  const std::lock_guard lock(mutex_);
  return sessions_.size();
}

}  // namespace server
