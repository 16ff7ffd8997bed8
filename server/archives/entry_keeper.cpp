#include "server/archives/entry_keeper.h"

#include <unistd.h>

#include <cerrno>
#include <cstdint>

namespace server {
namespace {

constexpr std::size_t kNameBytesMax = 512;
constexpr std::size_t kShownBytesMax = 200;
constexpr std::int64_t kAnyRatioBytes = 64 << 10;

/// Length of the UTF-8 sequence at the front of `text`; 0: there is none (RFC 3629: no surrogates, nothing
/// longer than needed).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    if (!follows(1) || !follows(2)) return 0;
    const bool fits = (first != 0xE0 || byte(1) >= 0xA0) && (first != 0xED || byte(1) < 0xA0);
    return fits ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    if (!follows(1) || !follows(2) || !follows(3)) return 0;
    const bool fits = (first != 0xF0 || byte(1) >= 0x90) && (first != 0xF4 || byte(1) < 0x90);
    return fits ? 4 : 0;
  }
  return 0;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string folded(std::string_view name) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

/// What a name may be shown as: refused names hold anything.
std::string shown(std::string_view name) {
  std::string text;
  for (const char c : name.substr(0, kShownBytesMax)) text += c >= 0x20 && c < 0x7f ? c : '?';
  return text;
}

/// Added by systems without anybody's asking.
bool is_left_out(std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::string_view base = slash == name.npos ? name : name.substr(slash + 1);
  return base.starts_with('.') || name.starts_with("__MACOSX/");
}

}  // namespace

bool is_entry_name(std::string_view name) {
  return name.size() <= kNameBytesMax && is_plain_relative_path(name) && name.find(':') == name.npos &&
         is_utf8(name);
}

api::Error archive_refusal(std::string_view entry, std::string_view code, std::string_view detail) {
  const std::string name = entry.empty() ? "archive" : shown(entry);
  std::string sentence = "'" + name + "' " + std::string(detail);
  std::string message = "the archive is refused: " + sentence;
  return {api::Fault::invalid_request,
          std::move(message),
          {{name, "", 0, 0, std::string(code), std::move(sentence)}}};
}

api::Status EntryKeeper::count() {
  if (++entries_ <= limits_.entries) return api::Done{};
  return archive_refusal("", "too_many", "has more than " + std::to_string(limits_.entries) + " entries");
}

api::Status EntryKeeper::begin(const std::string& name, std::int64_t stored_bytes) {
  if (!is_entry_name(name))
    return archive_refusal(name, "bad_name",
                           "is no name of a file within a folder: UTF-8, parts joined by '/', without '..', "
                           "drive or leading slash");
  if (!folded_names_.insert(folded(name)).second)
    return archive_refusal(name, "duplicate_entry", "comes twice, apart from upper and lower case");
  name_ = name;
  stored_bytes_ = stored_bytes;
  bytes_ = 0;
  left_out_ = is_left_out(name);
  return left_out_ ? api::Status(api::Done{}) : sink_.begin(name);
}

api::Status EntryKeeper::take(std::string_view bytes) {
  bytes_ += static_cast<std::int64_t>(bytes.size());
  total_bytes_ += static_cast<std::int64_t>(bytes.size());
  if (bytes_ > limits_.entry_bytes)
    return archive_refusal(name_, "too_large",
                           "is larger than " + std::to_string(limits_.entry_bytes) + " bytes");
  if (total_bytes_ > limits_.total_bytes)
    return archive_refusal("", "too_large",
                           "holds more than " + std::to_string(limits_.total_bytes) + " bytes");
  if (bytes_ > kAnyRatioBytes && bytes_ / limits_.ratio > stored_bytes_)
    return archive_refusal(name_, "too_large",
                           "grows to more than " + std::to_string(limits_.ratio) + " times its size");
  return left_out_ ? api::Status(api::Done{}) : sink_.take(bytes);
}

std::string read_at(const FileHandle& file, std::int64_t offset, std::size_t count) {
  std::string bytes(count, '\0');
  std::size_t have = 0;
  while (have < count) {
    const ssize_t got = ::pread(file.get(), bytes.data() + have, count - have,
                                static_cast<off_t>(offset) + static_cast<off_t>(have));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return {};
    have += static_cast<std::size_t>(got);
  }
  return bytes;
}

api::Status read_archive(const FileHandle& archive, const ArchiveLimits& limits, const EntrySink& sink) {
  constexpr std::size_t kTarMagicAt = 257;
  const auto size = size_of(archive);
  if (!size) return size.error();
  EntryKeeper keeper(limits, sink);
  const std::string start = read_at(archive, 0, 4);
  if (start == "PK\x03\x04") return read_zip(archive, *size, keeper);
  if (read_at(archive, kTarMagicAt, 5) == "ustar") return read_tar(archive, *size, keeper);
  const bool compressed = start.starts_with("\x1f\x8b") || start.starts_with("BZh") ||
                          start.starts_with(
                              "\xfd"
                              "7zX") ||
                          start.starts_with("7z\xbc\xaf");
  return archive_refusal("", compressed ? "unsupported" : "bad_archive",
                         compressed ? "is compressed in a way that is not taken; send a .zip or a plain .tar"
                                    : "is neither a zip nor a tar archive");
}

}  // namespace server
