// The lines of a request before its body.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/http/request_head.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using server::BodyKind;
  const auto [head, refused] =
      server::parse_head(std::string_view(reinterpret_cast<const char*>(data), size));
  if (refused) {
    if (refused->status < 400 || refused->status > 505 || refused->detail.empty()) std::abort();
    return 0;
  }
  const auto is_bad = [](char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; };
  if (!head.target.starts_with('/') || std::any_of(head.target.begin(), head.target.end(), is_bad))
    std::abort();
  if (head.body_bytes < 0 || (head.body_bytes > 0 && head.body != BodyKind::counted)) std::abort();
  if (head.body == BodyKind::counted && head.field("Transfer-Encoding")) std::abort();
  if (head.body == BodyKind::chunked && head.field("Content-Length")) std::abort();
  for (const auto& [name, value] : head.fields)
    if (name.empty() || value.find_first_of("\r\n") != value.npos) std::abort();
  return 0;
}
