#include "server/http/body_reader.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace server {
namespace {

constexpr std::size_t kReadPieceBytes = 64 << 10;
constexpr std::size_t kChunkLineBytesMax = 1024;  // a chunk's size and what some write behind it; a trailer
constexpr std::size_t kTrailerLinesMax = 100;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

/// Hexadecimal digits, and perhaps an extension behind a semicolon, which means nothing to us. None: no size.
std::optional<std::int64_t> chunk_size(std::string_view line) {
  std::int64_t size = 0;
  const char* end = line.data() + line.size();
  // from_chars takes a sign; a size has none.
  if (line.starts_with('-')) return std::nullopt;
  const auto parsed = std::from_chars(line.data(), end, size, 16);
  if (parsed.ec != std::errc()) return std::nullopt;
  const std::size_t rest = line.find_first_not_of(" \t", static_cast<std::size_t>(parsed.ptr - line.data()));
  if (rest != line.npos && line[rest] != ';') return std::nullopt;
  return size;
}

}  // namespace

ReadBody BodyReader::reading(std::int64_t bytes_max, BodyPatience patience) {
  bytes_max_ = bytes_max;
  patience_ = patience;
  return [this](const Take& take) { return read(take); };
}

bool BodyReader::read(const Take& take) {
  begun_ = SteadyClock::now();
  if (head_.expects_continue && client_.write(kContinue.data(), kContinue.size(), patience_.silence) < 0)
    return false;
  over_ = head_.body == BodyKind::chunked ? read_chunks(take) : read_counted(take);
  return over_;
}

bool BodyReader::read_counted(const Take& take) {
  return read_bytes(head_.body_bytes, take);
}

/// Source: RFC 9112, section 7.1.
bool BodyReader::read_chunks(const Take& take) {
  for (std::string line; read_line(line);) {
    const auto size = chunk_size(line);
    if (!size) return false;
    if (*size > 0) {
      if (!read_bytes(*size, take) || !read_line(line) || !line.empty()) return false;
      continue;
    }
    for (std::size_t trailers = 0; trailers < kTrailerLinesMax && read_line(line); ++trailers)
      if (line.empty()) return true;
    return false;
  }
  return false;
}

bool BodyReader::read_bytes(std::int64_t count, const Take& take) {
  too_large_ = count > bytes_max_ - bytes_;
  if (too_large_) return false;
  std::array<char, kReadPieceBytes> piece;
  while (count > 0) {
    const ssize_t got = receive(
        piece.data(), static_cast<std::size_t>(std::min<std::int64_t>(count, std::int64_t{piece.size()})));
    if (got <= 0) return false;
    count -= got;
    if (!take({piece.data(), static_cast<std::size_t>(got)})) return false;
  }
  return true;
}

bool BodyReader::read_line(std::string& line) {
  line.clear();
  for (char byte = 0; line.size() < kChunkLineBytesMax;) {
    if (receive(&byte, 1) <= 0) return false;
    line += byte;
    if (byte != '\n') continue;
    if (!line.ends_with("\r\n")) return false;
    line.resize(line.size() - 2);
    return line.find('\r') == line.npos;
  }
  return false;
}

ssize_t BodyReader::receive(char* to, std::size_t size) {
  const ssize_t got =
      client_.read(to, size, patience_.silence, [this] { return stopping_ || is_too_slow(); });
  if (got > 0) bytes_ += got;
  return got > 0 && (stopping_ || is_too_slow()) ? -1 : got;
}

bool BodyReader::is_too_slow() {
  const std::chrono::duration<double> elapsed = SteadyClock::now() - begun_;
  too_slow_ = elapsed > patience_.grace &&
              static_cast<double>(bytes_) < elapsed.count() * static_cast<double>(patience_.bytes_per_s);
  return too_slow_;
}

SmallBody read_small_body(const ReadBody& read_body, std::size_t bytes_max, std::string& to) {
  bool fits = true;
  const bool whole = read_body([&](std::string_view bytes) {
    fits = bytes.size() <= bytes_max - to.size();
    if (fits) to.append(bytes);
    return fits;
  });
  if (!fits) return SmallBody::too_large;
  return whole ? SmallBody::whole : SmallBody::cut_off;
}

}  // namespace server
