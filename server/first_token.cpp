#include "server/first_token.h"

#include <fstream>
#include <iostream>
#include <system_error>

#include "server/auth/token_text.h"
#include "server/store/job_store.h"

namespace server {
namespace {

/// The token that the file holds; empty: there is no such file.
api::Result<std::string> token_in(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::string();
  std::ifstream stream(file);
  std::string text(kPrefixChars + kSecretChars + 5, '\0');  // longer than a token is
  stream >> std::ws;
  stream.getline(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(text.find('\0'));
  while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.pop_back();
  if (prefix_of(text)) return text;
  return api::Error{api::Fault::invalid_request,
                    "--token-file: " + file.string() + " cannot be read or holds no token (kl_...)"};
}

}  // namespace

api::Status make_first_token(const Config& config, TokenFolder& tokens) {
  if (config.token_file.empty() || !asks_for_tokens(config) || tokens.exists()) return api::Done{};
  const auto held = token_in(config.token_file);
  if (!held) return held.error();
  const auto scopes = parse_scopes("jobs:read,jobs:write,queue:admin,metrics:read");
  if (!scopes) return scopes.error();
  // Into the file before it counts: one that counts and that nobody was told would keep all out.
  const auto keep = [&](const std::string& made) -> api::Result<std::string> {
    if (!held->empty()) return *held;
    if (const api::Status kept = write_new_file(config.token_file, made + "\n"); !kept) return kept.error();
    return made;
  };
  const auto text = tokens.create(kFirstTokenName, *scopes, system_clock_ms(), std::nullopt, true, keep);
  if (!text) return text.error();
  if (held->empty())
    std::cout << "The first token, shown this once; it is kept in " << config.token_file.string() << ":\n"
              << *text << std::endl;
  return api::Done{};
}

}  // namespace server
