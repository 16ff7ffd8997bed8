// Tar in blocks of 512 bytes: ustar, with long names as pax and GNU tar write them.
// Source: POSIX.1-2017, pax, "ustar Interchange Format" and "pax Header Block".
#include <algorithm>
#include <charconv>
#include <optional>

#include "server/archives/entry_keeper.h"

namespace server {
namespace {

constexpr std::int64_t kBlockBytes = 512;
constexpr std::int64_t kPieceBytes = 64 << 10;
constexpr std::int64_t kHeaderBytesMax = 64 << 10;  // of a pax header or a long name

api::Error broken_tar(std::string_view entry, std::string_view detail) {
  return archive_refusal(entry, "bad_archive", detail);
}

std::string_view text_at(std::string_view block, std::size_t at, std::size_t bytes) {
  const std::string_view field = block.substr(at, bytes);
  return field.substr(0, field.find('\0'));
}

/// Digits to the base 8, with spaces around and an end of spaces and zero bytes.
std::optional<std::int64_t> octal_at(std::string_view block, std::size_t at, std::size_t bytes) {
  std::string_view digits = text_at(block, at, bytes);
  digits.remove_prefix(std::min(digits.find_first_not_of(' '), digits.size()));
  digits = digits.substr(0, digits.find(' '));
  std::int64_t value = 0;
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), value, 8);
  if (digits.empty() || parsed.ec != std::errc() || parsed.ptr != digits.data() + digits.size() || value < 0)
    return std::nullopt;
  return value;
}

bool has_right_checksum(std::string_view block) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < block.size(); ++i)
    sum += i >= 148 && i < 156 ? ' ' : static_cast<unsigned char>(block[i]);
  return octal_at(block, 148, 8) == sum;
}

std::int64_t padded(std::int64_t bytes) {
  return (bytes + kBlockBytes - 1) / kBlockBytes * kBlockBytes;
}

/// The path among records of "length key=value\n"; an error where one changes what the blocks mean.
api::Result<std::optional<std::string>> path_of_pax(std::string_view records) {
  std::optional<std::string> path;
  while (!records.empty()) {
    std::size_t length = 0;
    const auto parsed = std::from_chars(records.data(), records.data() + records.size(), length);
    const auto digits = static_cast<std::size_t>(parsed.ptr - records.data());
    if (parsed.ec != std::errc() || length > records.size() || length < digits + 3 ||
        records[digits] != ' ' || records[length - 1] != '\n')
      return broken_tar("", "has a broken pax header");
    const std::string_view record = records.substr(digits + 1, length - digits - 2);
    const std::size_t equals = record.find('=');
    if (equals == record.npos) return broken_tar("", "has a broken pax header");
    const std::string_view key = record.substr(0, equals);
    if (key == "path") path = record.substr(equals + 1);
    if (key == "size" || key == "linkpath" || key.starts_with("GNU.sparse"))
      return archive_refusal("", "unsupported",
                             "has a file of more than 8 GiB, a link, or a file with holes");
    records.remove_prefix(length);
  }
  return path;
}

class TarReader {
 public:
  TarReader(const FileHandle& archive, std::int64_t size, EntryKeeper& keeper)
      : archive_(archive), size_(size), keeper_(keeper) {}

  api::Status read() {
    for (;;) {
      const std::string block = read_at(archive_, at_, kBlockBytes);
      if (block.empty()) return broken_tar("", "has no end: it was cut");
      at_ += kBlockBytes;
      if (block.find_first_not_of('\0') == block.npos) return end();
      if (const api::Status taken = take(block); !taken) return taken;
    }
  }

 private:
  api::Status end() const {
    if (long_name_) return broken_tar("", "ends after a long name");
    return api::Done{};
  }

  api::Status take(std::string_view block) {
    const std::string name = name_in(block);
    const auto bytes = octal_at(block, 124, 12);
    if (block.substr(257, 5) != "ustar" || !has_right_checksum(block) || !bytes)
      return broken_tar(name, "has a broken header");
    if (*bytes > size_ - at_) return broken_tar(name, "reaches beyond the archive");
    if (const api::Status counted = keeper_.count(); !counted) return counted;
    const char type = block[156];
    api::Status taken =
        type == '0' || type == '\0'  ? take_file(name, *bytes)
        : type == 'x' || type == 'L' ? take_long_name(type, *bytes)
        : type == 'g' || (type == '5' && *bytes == 0)
            ? api::Status(api::Done{})
            : api::Status(archive_refusal(name, "not_a_file", "is a link or a device, not a file"));
    if (type != 'x' && type != 'L') long_name_.reset();
    at_ += padded(*bytes);
    return taken;
  }

  std::string name_in(std::string_view block) const {
    if (long_name_) return *long_name_;
    const std::string name(text_at(block, 0, 100));
    // GNU tar keeps times where ustar has the beginning of a long path.
    const std::string prefix(block.substr(257, 6) == std::string_view("ustar\0", 6) ? text_at(block, 345, 155)
                                                                                    : std::string_view());
    return prefix.empty() ? name : prefix + "/" + name;
  }

  api::Status take_long_name(char type, std::int64_t bytes) {
    if (bytes > kHeaderBytesMax || long_name_) return broken_tar("", "has a header of unreasonable length");
    const std::string text = read_at(archive_, at_, static_cast<std::size_t>(bytes));
    if (type == 'L') {
      long_name_ = text.substr(0, text.find('\0'));
      return api::Done{};
    }
    auto path = path_of_pax(text);
    if (!path) return path.error();
    long_name_ = std::move(*path);
    return api::Done{};
  }

  api::Status take_file(std::string name, std::int64_t bytes) {
    if (name.starts_with("./")) name.erase(0, 2);  // as `tar -c .` writes
    if (const api::Status begun = keeper_.begin(name, bytes); !begun) return begun;
    for (std::int64_t done = 0; done < bytes;) {
      const auto wanted = static_cast<std::size_t>(std::min(kPieceBytes, bytes - done));
      const std::string piece = read_at(archive_, at_ + done, wanted);
      if (piece.empty()) return broken_tar(name, "ends early");
      if (const api::Status taken = keeper_.take(piece); !taken) return taken;
      done += static_cast<std::int64_t>(wanted);
    }
    return api::Done{};
  }

  const FileHandle& archive_;
  const std::int64_t size_;
  EntryKeeper& keeper_;
  std::int64_t at_ = 0;
  std::optional<std::string> long_name_;  ///< for the next entry
};

}  // namespace

api::Status read_tar(const FileHandle& archive, std::int64_t size, EntryKeeper& keeper) {
  return TarReader(archive, size, keeper).read();
}

}  // namespace server
