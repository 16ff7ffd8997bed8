#include "server/artefacts/tar_body.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>

namespace server {
namespace {

constexpr std::int64_t kTarBlockBytes = 512;
constexpr std::size_t kNameMax = 100;
constexpr std::int64_t kSizeMax = std::int64_t{1} << 33;  // 11 octal digits

std::int64_t padded(std::int64_t bytes) {
  return (bytes + kTarBlockBytes - 1) / kTarBlockBytes * kTarBlockBytes;
}

struct Field {
  std::size_t at, size;
};
constexpr Field kName{0, 100}, kMode{100, 8}, kUser{108, 8}, kGroup{116, 8}, kSize{124, 12}, kTime{136, 12},
    kSum{148, 8}, kType{156, 1}, kFormat{257, 8};

void put(std::string& block, Field field, std::string_view text) {
  text = text.substr(0, field.size);
  std::copy(text.begin(), text.end(), block.begin() + static_cast<std::ptrdiff_t>(field.at));
}

void put_octal(std::string& block, Field field, std::int64_t value) {
  std::array<char, 24> digits{};
  std::snprintf(digits.data(), digits.size(), "%0*llo", static_cast<int>(field.size - 1),
                static_cast<unsigned long long>(value));
  put(block, field, digits.data());
}

std::string block_of(std::string_view name, std::int64_t bytes, char type, std::int64_t time_s) {
  std::string block(kTarBlockBytes, '\0');
  put(block, kName, name);
  put_octal(block, kMode, 0644);
  put_octal(block, kUser, 0);
  put_octal(block, kGroup, 0);
  put_octal(block, kSize, bytes < kSizeMax ? bytes : 0);
  put_octal(block, kTime, time_s);
  put(block, kType, std::string_view(&type, 1));
  put(block, kFormat, std::string_view("ustar\00000", 8));
  put(block, kSum, "        ");
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  std::array<char, 9> digits{};
  std::snprintf(digits.data(), digits.size(), "%06o", sum);
  put(block, kSum, std::string_view(digits.data(), 7));
  return block;
}

/// "27 path=...\n": a record begins with its own length.
std::string pax_record(std::string_view key, std::string_view value) {
  const std::size_t rest = 1 + key.size() + 1 + value.size() + 1;
  std::size_t length = rest + 1;
  while (length != rest + std::to_string(length).size()) length = rest + std::to_string(length).size();
  return std::to_string(length) + " " + std::string(key) + "=" + std::string(value) + "\n";
}

bool is_plain_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

}  // namespace

std::string TarBody::header_of(const TarEntry& entry) const {
  std::string extended;
  if (entry.path.size() > kNameMax || !is_plain_ascii(entry.path)) extended += pax_record("path", entry.path);
  if (entry.bytes >= kSizeMax) extended += pax_record("size", std::to_string(entry.bytes));
  std::string header;
  if (!extended.empty()) {
    const auto bytes = static_cast<std::int64_t>(extended.size());
    extended.resize(static_cast<std::size_t>(padded(bytes)), '\0');
    header = block_of("PaxHeaders/entry", bytes, 'x', time_s_) + extended;
  }
  return header + block_of(entry.path, entry.bytes, '0', time_s_);
}

TarBody::TarBody(std::vector<TarEntry> entries, std::int64_t time_s)
    : entries_(std::move(entries)), time_s_(time_s) {
  for (TarEntry& entry : entries_) {
    if (entry.folder.empty()) entry.bytes = static_cast<std::int64_t>(entry.text.size());
    begins_.push_back(size_);
    size_ += static_cast<std::int64_t>(header_of(entry).size()) + padded(entry.bytes);
  }
  size_ += 2 * kTarBlockBytes;  // the end
}

std::int64_t TarBody::read_entry(std::size_t index, std::int64_t at, char* to, std::int64_t size) {
  const TarEntry& entry = entries_[index];
  if (entry.folder.empty()) {
    std::memcpy(to, entry.text.data() + at, static_cast<std::size_t>(size));
    return size;
  }
  if (!open_ || open_entry_ != index) {
    auto file = open_below(entry.folder, entry.file);
    if (!file) return -1;
    open_ = std::move(*file);
    open_entry_ = index;
  }
  ssize_t count = 0;
  do {
    count = ::pread(open_.get(), to, static_cast<std::size_t>(size), at);
  } while (count < 0 && errno == EINTR);
  return count > 0 ? count : -1;
}

std::int64_t TarBody::read(std::int64_t at, char* to, std::int64_t size) {
  size = std::min(size, size_ - at);
  if (size <= 0) return 0;
  const auto after = std::upper_bound(begins_.begin(), begins_.end(), at);
  if (after == begins_.begin()) {
    std::memset(to, 0, static_cast<std::size_t>(size));
    return size;
  }
  const auto index = static_cast<std::size_t>(after - begins_.begin()) - 1;
  const TarEntry& entry = entries_[index];
  const std::string header = header_of(entry);
  std::int64_t within = at - begins_[index];
  if (const auto bytes = static_cast<std::int64_t>(header.size()); within < bytes) {
    size = std::min(size, bytes - within);
    std::memcpy(to, header.data() + within, static_cast<std::size_t>(size));
    return size;
  } else {
    within -= bytes;
  }
  if (within < entry.bytes) return read_entry(index, within, to, std::min(size, entry.bytes - within));
  // Zeros up to the next entry, or to the end.
  const std::int64_t next = index + 1 < begins_.size() ? begins_[index + 1] : size_;
  size = std::min(size, next - at);
  std::memset(to, 0, static_cast<std::size_t>(size));
  return size;
}

}  // namespace server
