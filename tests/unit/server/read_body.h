// Reads answers that are made up as they are sent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace server {

/// Bytes [at, at + size) in pieces of at most `piece`; fewer where the body ends.
template <class Body>
std::string read_from(Body& body, std::int64_t at, std::int64_t size, std::int64_t piece) {
  std::string bytes, buffer(static_cast<std::size_t>(piece), '?');
  while (size > 0) {
    const std::int64_t got = body.read(at, buffer.data(), std::min(piece, size));
    if (got <= 0) break;
    bytes.append(buffer, 0, static_cast<std::size_t>(got));
    at += got;
    size -= got;
  }
  return bytes;
}

}  // namespace server
