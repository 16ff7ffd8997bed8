#include "server/artefacts/npz_body.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

namespace server {
namespace {

constexpr std::int64_t kLocalBytes = 30, kDescriptorBytes = 16, kDirectoryEntryBytes = 46, kEndBytes = 22;
constexpr std::int64_t kLimitBytes = 0xffffffff;
constexpr std::size_t kPieceBytes = 256 * 1024;

void put16(std::string& out, std::uint64_t value) {
  out += static_cast<char>(value & 0xff);
  out += static_cast<char>(value >> 8 & 0xff);
}
void put32(std::string& out, std::uint64_t value) {
  put16(out, value & 0xffff);
  put16(out, value >> 16);
}

/// From "version needed" to the lengths, in local header and directory.
void put_common(std::string& out, std::uint32_t crc, std::int64_t bytes, std::size_t name_bytes) {
  put16(out, 20);
  put16(out, 0x0808);  // sums behind the data, names are UTF-8
  put16(out, 0);       // stored
  put16(out, 0);
  put16(out, 0x0021);  // 1980-01-01
  put32(out, crc);
  put32(out, static_cast<std::uint64_t>(bytes));
  put32(out, static_cast<std::uint64_t>(bytes));
  put16(out, name_bytes);
  put16(out, 0);
}

std::uint32_t add_to_crc(std::uint32_t crc, const char* bytes, std::int64_t count) {
  return static_cast<std::uint32_t>(
      ::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes), static_cast<z_size_t>(count)));
}

std::int64_t read_file(const FileHandle& file, std::int64_t at, char* to, std::int64_t size) {
  ssize_t count = 0;
  do {
    count = ::pread(file.get(), to, static_cast<std::size_t>(size), at);
  } while (count < 0 && errno == EINTR);
  return count > 0 ? count : -1;
}

/// What of `made`, which stands at `begin`, lies from `at` on.
std::int64_t copy_part(const std::string& made, std::int64_t begin, std::int64_t at, char* to,
                       std::int64_t size) {
  size = std::min(size, begin + static_cast<std::int64_t>(made.size()) - at);
  std::memcpy(to, made.data() + (at - begin), static_cast<std::size_t>(size));
  return size;
}

}  // namespace

api::Result<NpzBody> NpzBody::of(std::vector<NpzEntry> entries) {
  NpzBody body;
  std::int64_t directory_bytes = 0;
  for (NpzEntry& entry : entries) {
    const auto name_bytes = static_cast<std::int64_t>(entry.name.size());
    const std::int64_t begin = body.directory_at_;
    body.directory_at_ += kLocalBytes + name_bytes + entry.bytes + kDescriptorBytes;
    directory_bytes += kDirectoryEntryBytes + name_bytes;
    body.places_.push_back({std::move(entry), begin, 0, 0});
  }
  body.size_ = body.directory_at_ + directory_bytes + kEndBytes;
  if (body.size_ >= kLimitBytes)
    return api::Error{api::Fault::out_of_resources, "the archive would have more than 4 GiB"};
  return body;
}

std::string NpzBody::local_header(const Place& place) const {
  std::string header = "PK\x03\x04";
  put_common(header, 0, 0, place.entry.name.size());
  return header + place.entry.name;
}

bool NpzBody::complete_crc(Place& place) {
  if (place.summed == place.entry.bytes) return true;
  const auto piece = std::make_unique<char[]>(kPieceBytes);
  while (place.summed < place.entry.bytes) {
    const std::int64_t wanted = std::min<std::int64_t>(kPieceBytes, place.entry.bytes - place.summed);
    const std::int64_t count = read_file(place.entry.file, place.summed, piece.get(), wanted);
    if (count < 0) return false;
    place.crc = add_to_crc(place.crc, piece.get(), count);
    place.summed += count;
  }
  return true;
}

std::int64_t NpzBody::read_data(Place& place, std::int64_t at, char* to, std::int64_t size) {
  const std::int64_t count = read_file(place.entry.file, at, to, std::min(size, place.entry.bytes - at));
  if (count > 0 && at == place.summed) {
    place.crc = add_to_crc(place.crc, to, count);
    place.summed += count;
  }
  return count;
}

bool NpzBody::make_end(std::string& bytes) {
  for (Place& place : places_) {
    if (!complete_crc(place)) return false;
    bytes += "PK\x01\x02";
    put16(bytes, 0x0314);  // made by: Unix, 2.0
    put_common(bytes, place.crc, place.entry.bytes, place.entry.name.size());
    put16(bytes, 0);
    put16(bytes, 0);
    put16(bytes, 0);
    put32(bytes, 0x81a40000u);  // -rw-r--r--
    put32(bytes, static_cast<std::uint64_t>(place.begin));
    bytes += place.entry.name;
  }
  const std::size_t directory_bytes = bytes.size();
  bytes += "PK\x05\x06";
  put32(bytes, 0);
  put16(bytes, places_.size());
  put16(bytes, places_.size());
  put32(bytes, directory_bytes);
  put32(bytes, static_cast<std::uint64_t>(directory_at_));
  put16(bytes, 0);
  return true;
}

std::int64_t NpzBody::read(std::int64_t at, char* to, std::int64_t size) {
  size = std::min(size, size_ - at);
  if (size <= 0) return 0;
  if (at >= directory_at_) {
    std::string end;
    return make_end(end) ? copy_part(end, directory_at_, at, to, size) : -1;
  }
  const auto after = std::upper_bound(places_.begin(), places_.end(), at,
                                      [](std::int64_t a, const Place& place) { return a < place.begin; });
  Place& place = *std::prev(after);
  const std::string header = local_header(place);
  const std::int64_t data_at = place.begin + static_cast<std::int64_t>(header.size());
  if (at < data_at) return copy_part(header, place.begin, at, to, size);
  if (at < data_at + place.entry.bytes) return read_data(place, at - data_at, to, size);
  if (!complete_crc(place)) return -1;
  std::string descriptor = "PK\x07\x08";
  put32(descriptor, place.crc);
  put32(descriptor, static_cast<std::uint64_t>(place.entry.bytes));
  put32(descriptor, static_cast<std::uint64_t>(place.entry.bytes));
  return copy_part(descriptor, data_at + place.entry.bytes, at, to, size);
}

}  // namespace server
