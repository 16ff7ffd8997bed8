#include "engine/output/array_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

namespace engine {
namespace {

constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);
constexpr std::size_t kPrefixBytes = 10;  // magic and the length of the header's text
constexpr std::size_t kDimensionsMax = 8;
constexpr std::size_t kEndBytes = 22;             // of a zip's end record, without a comment
constexpr std::uint64_t kDirectoryMax = 1 << 20;  // ours have some ten entries

api::Error damaged(std::string_view what) {
  return {api::Fault::internal, "not an array file of ours: " + std::string(what)};
}

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < count; ++k)
    value |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

api::Result<std::string> read_text(int file, std::uint64_t offset, std::uint64_t bytes) {
  std::string text(bytes, '\0');
  if (const auto read = read_at(file, offset, text.data(), bytes); !read) return read.error();
  return text;
}

api::Result<std::uint64_t> size_of(int file) {
  struct stat information {};
  if (::fstat(file, &information) != 0) return damaged("it has no size");
  return static_cast<std::uint64_t>(information.st_size);
}

/// What stands between `before` and `after` in the header's text.
std::string_view between(std::string_view text, std::string_view before, std::string_view after) {
  const std::size_t begin = text.find(before);
  if (begin == text.npos) return {};
  text.remove_prefix(begin + before.size());
  return text.substr(0, text.find(after));
}

std::optional<std::vector<std::uint64_t>> read_shape(std::string_view text) {
  std::vector<std::uint64_t> shape;
  while (!text.empty()) {
    std::uint64_t extent = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), extent);
    if (parsed.ec != std::errc() || shape.size() == kDimensionsMax) return std::nullopt;
    shape.push_back(extent);
    text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
    while (text.starts_with(',') || text.starts_with(' ')) text.remove_prefix(1);
  }
  return shape;
}

/// Bytes of one element: the digits of its type, four times that of unicode. 0: cannot be told.
std::uint64_t element_bytes(std::string_view dtype) {
  std::uint64_t count = 0;
  if (dtype.size() < 3) return 0;
  const auto parsed = std::from_chars(dtype.data() + 2, dtype.data() + dtype.size(), count);
  if (parsed.ec != std::errc() || parsed.ptr != dtype.data() + dtype.size() || count > (1u << 20)) return 0;
  return dtype[1] == 'U' ? 4 * count : count;
}

/// Does `shape` come to exactly `bytes`? Nothing overflows.
bool comes_to(const std::vector<std::uint64_t>& shape, std::uint64_t element, std::uint64_t bytes) {
  std::uint64_t product = element;
  for (const std::uint64_t extent : shape) {
    if (extent > 0 && product > bytes / extent) return false;
    product *= extent;
  }
  return element > 0 && product == bytes;
}

/// The array that takes [at, at + bytes) of the file.
api::Result<ArrayPlace> find_array(int file, std::uint64_t at, std::uint64_t bytes) {
  if (bytes < kPrefixBytes) return damaged("an array is cut short");
  const auto prefix = read_text(file, at, kPrefixBytes);
  if (!prefix) return prefix.error();
  if (!prefix->starts_with(kMagic)) return damaged("an array is not of NumPy's format 1.0");
  const std::uint64_t header_bytes = kPrefixBytes + number_at(*prefix, 8, 2);
  if (header_bytes > bytes) return damaged("the header of an array is cut short");
  const auto text = read_text(file, at + kPrefixBytes, header_bytes - kPrefixBytes);
  if (!text) return text.error();
  const auto shape = read_shape(between(*text, "'shape': (", ")"));
  ArrayPlace place{
      std::string(between(*text, "'descr': '", "'")), {}, at + header_bytes, bytes - header_bytes};
  if (!shape || text->find("'fortran_order': False") == text->npos ||
      !comes_to(*shape, element_bytes(place.dtype), place.bytes))
    return damaged("an array is of another shape than its size says");
  place.shape = *shape;
  return place;
}

/// The central directory: its bytes, found by the end record, which has no comment in ours.
api::Result<std::string> read_directory(int file, std::uint64_t size) {
  if (size < kEndBytes) return damaged("it is too short for an archive");
  const auto end = read_text(file, size - kEndBytes, kEndBytes);
  if (!end) return end.error();
  const std::uint64_t bytes = number_at(*end, 12, 4), offset = number_at(*end, 16, 4);
  if (!end->starts_with("PK\x05\x06") || bytes > kDirectoryMax || offset + bytes > size)
    return damaged("the end of the archive is not there");
  return read_text(file, offset, bytes);
}

constexpr std::size_t kEntryBytes = 46, kLocalBytes = 30;

/// Where the bytes of a directory entry begin.
api::Result<std::uint64_t> data_offset(int file, std::uint64_t local) {
  const auto header = read_text(file, local, kLocalBytes);
  if (!header) return header.error();
  if (!header->starts_with("PK\x03\x04")) return damaged("an entry is not where the archive says");
  return local + kLocalBytes + number_at(*header, 26, 2) + number_at(*header, 28, 2);
}

}  // namespace

api::Result<ArrayPlace> find_npy(int file) {
  const auto size = size_of(file);
  if (!size) return size.error();
  return find_array(file, 0, *size);
}

api::Result<std::map<std::string, ArrayPlace, std::less<>>> find_npz(int file) {
  const auto size = size_of(file);
  if (!size) return size.error();
  const auto directory = read_directory(file, *size);
  if (!directory) return directory.error();
  std::map<std::string, ArrayPlace, std::less<>> arrays;
  std::string_view rest = *directory;
  while (!rest.empty()) {
    if (rest.size() < kEntryBytes || !rest.starts_with("PK\x01\x02") || number_at(rest, 10, 2) != 0)
      return damaged("an entry of the archive is compressed or broken");
    const std::uint64_t bytes = number_at(rest, 24, 4), name_bytes = number_at(rest, 28, 2);
    const std::uint64_t whole = kEntryBytes + name_bytes + number_at(rest, 30, 2) + number_at(rest, 32, 2);
    if (whole > rest.size()) return damaged("the directory of the archive is cut short");
    const auto offset = data_offset(file, number_at(rest, 42, 4));
    if (!offset) return offset.error();
    if (*offset + bytes > *size) return damaged("an entry of the archive is cut short");
    auto place = find_array(file, *offset, bytes);
    if (!place) return place.error();
    std::string_view name = rest.substr(kEntryBytes, name_bytes);
    if (name.ends_with(".npy")) name.remove_suffix(4);
    arrays.emplace(name, std::move(*place));
    rest.remove_prefix(whole);
  }
  return arrays;
}

api::Status read_at(int file, std::uint64_t offset_bytes, void* to, std::uint64_t bytes) {
  auto* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t count = ::pread(file, at, bytes, static_cast<off_t>(offset_bytes));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return damaged("it cannot be read: " + std::generic_category().message(errno));
    if (count == 0) return damaged("it is cut short");
    at += count;
    offset_bytes += static_cast<std::uint64_t>(count);
    bytes -= static_cast<std::uint64_t>(count);
  }
  return api::Done{};
}

}  // namespace engine
