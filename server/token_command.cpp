// keylume-server token create|list|revoke
#include <fstream>
#include <iostream>

#include "server/auth/token_folder.h"
#include "server/auth/token_text.h"
#include "server/commands.h"
#include "server/store/job_store.h"
#include "server/text.h"

namespace server {
namespace {

constexpr std::int64_t kDaysMax = 36'500;
constexpr std::int64_t kDayMs = 24 * 3600 * 1000;

std::string day_of(std::int64_t time_ms) {
  constexpr std::size_t kDayBytes = 10;
  return utc_text(time_ms).substr(0, kDayBytes);
}

api::Result<std::optional<std::int64_t>> expiry_of(const CommandWords& words, std::int64_t now_ms) {
  const auto text = words.option("--expires-days");
  if (!text) return std::optional<std::int64_t>();
  const std::int64_t days = whole_number(*text).value_or(0);
  if (days < 1 || days > kDaysMax)
    return wrong_use("--expires-days: must be a whole number from 1 to " + std::to_string(kDaysMax));
  return std::optional(now_ms + days * kDayMs);
}

/// Into `path`, durably, before there is a token: a crash in between leaves a file, and with --if-none the
/// next start makes the token that the file holds.
api::Result<std::string> hand_over(const std::string& path, bool may_be_there, const std::string& text) {
  std::string known;
  std::ifstream(path) >> known;
  if (may_be_there && prefix_of(known)) return known;
  if (const api::Status written = write_new_file(path, text + "\n"); !written) return written.error();
  return text;
}

int create(TokenFolder& tokens, const CommandWords& words) {
  if (words.plain.size() != 2)
    return refuse_command(wrong_use("token create: a name is needed, and one only"), kExitUsage);
  if (words.has("--if-none")) {
    const auto known = tokens.list();
    if (!known) return refuse_command(known.error(), kExitFailed);
    if (!known->empty()) return 0;
  }
  const auto scopes = parse_scopes(words.option("--scopes").value_or("jobs:read,jobs:write"));
  if (!scopes) return refuse_command(scopes.error(), kExitUsage);
  const std::int64_t now = system_clock_ms();
  const auto expires = expiry_of(words, now);
  if (!expires) return refuse_command(expires.error(), kExitUsage);
  TokenFolder::HandOver into_file;
  if (const auto out = words.option("--out"))
    into_file = [&, path = *out](const std::string& text) {
      return hand_over(path, words.has("--if-none"), text);
    };
  const auto text = tokens.create(words.plain[1], *scopes, now, *expires, words.has("--again"), into_file);
  if (!text) return refuse_command(text.error(), kExitFailed);
  std::cout << *text << std::endl;
  std::cerr << "This is the only time that it is shown. From now on requests need a token.\n";
  return 0;
}

int list(const TokenFolder& tokens) {
  const auto known = tokens.list();
  if (!known) return refuse_command(known.error(), kExitFailed);
  for (const Token& token : *known)
    std::cout << token.name << "\tkl_" << token.prefix << "_...\t" << text_of(token.scopes) << "\tmade "
              << day_of(token.created_ms) << "\t"
              << (token.expires_ms ? "expires " + day_of(*token.expires_ms) : std::string("does not expire"))
              << "\n";
  return 0;
}

int revoke(TokenFolder& tokens, const CommandWords& words) {
  if (words.plain.size() != 2)
    return refuse_command(wrong_use("token revoke: a name is needed, and one only"), kExitUsage);
  if (const api::Status revoked = tokens.revoke(words.plain[1]); !revoked)
    return refuse_command(revoked.error(), kExitFailed);
  return 0;
}

}  // namespace

int run_token_command(std::span<const std::string_view> given) {
  const auto words = take_apart(given, {"--scopes", "--expires-days", "--out"}, {"--again", "--if-none"});
  if (!words) return refuse_command(words.error(), kExitUsage);
  TokenFolder tokens(*words->option("--data"));
  const std::string action = words->plain.empty() ? "" : words->plain[0];
  if (action == "create") return create(tokens, *words);
  if (action == "list") return list(tokens);
  if (action == "revoke") return revoke(tokens, *words);
  return refuse_command(wrong_use("token: create, list or revoke?"), kExitUsage);
}

}  // namespace server
