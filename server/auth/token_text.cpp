#include "server/auth/token_text.h"

#include <sys/random.h>

#include <algorithm>
#include <array>

namespace server {
namespace {

constexpr std::string_view kBase64Url = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
constexpr std::string_view kStart = "kl_";
constexpr std::size_t kSecretPartBytes = 32;

bool is_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Without padding.
std::string base64url(const unsigned char* bytes, std::size_t count) {
  std::string text;
  unsigned pending = 0, bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    pending = (pending << 8) | bytes[i];
    for (bits += 8; bits >= 6; bits -= 6) text += kBase64Url[(pending >> (bits - 6)) & 63];
  }
  if (bits > 0) text += kBase64Url[(pending << (6 - bits)) & 63];
  return text;
}

}  // namespace

api::Result<std::string> new_token_text() {
  // The prefix takes 6 bits a byte and leaves out '-' and '_': 64 bytes hold 8 such, but for one in 10^50.
  std::array<unsigned char, 64 + kSecretPartBytes> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    return api::Error{api::Fault::internal, "the system has no random bytes"};
  std::string prefix;
  for (std::size_t i = 0; i < 64 && prefix.size() < kPrefixChars; ++i) {
    const char c = kBase64Url[bytes[i] & 63];
    if (is_alphanumeric(c)) prefix += c;
  }
  if (prefix.size() != kPrefixChars) return api::Error{api::Fault::internal, "the random bytes are none"};
  return std::string(kStart) + prefix + "_" + base64url(bytes.data() + 64, kSecretPartBytes);
}

std::optional<std::string> prefix_of(std::string_view text) {
  if (text.size() != kStart.size() + kPrefixChars + 1 + kSecretChars || !text.starts_with(kStart))
    return std::nullopt;
  const std::string_view prefix = text.substr(kStart.size(), kPrefixChars);
  const std::string_view secret = text.substr(kStart.size() + kPrefixChars + 1);
  if (!std::all_of(prefix.begin(), prefix.end(), is_alphanumeric) ||
      text[kStart.size() + kPrefixChars] != '_' || secret.find_first_not_of(kBase64Url) != secret.npos)
    return std::nullopt;
  return std::string(prefix);
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  return difference == 0;
}

}  // namespace server
