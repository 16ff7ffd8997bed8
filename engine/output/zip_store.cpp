#include "engine/output/zip_store.h"

#include <zlib.h>

#include <cassert>

namespace engine {
namespace {

constexpr std::uint64_t kLimitBytes = 0xffffffffu;  // this value itself means "see zip64"
constexpr std::uint64_t kCrcOffsetBytes = 14;       // in a local header
constexpr std::uint64_t kLocalHeaderBytes = 30, kDirectoryEntryBytes = 46;

void put16(std::string& out, std::uint64_t value) {
  out += static_cast<char>(value & 0xff);
  out += static_cast<char>((value >> 8) & 0xff);
}
void put32(std::string& out, std::uint64_t value) {
  put16(out, value & 0xffff);
  put16(out, value >> 16);
}

/// What local header and directory entry have in common, from "version needed" to the lengths.
void put_common(std::string& out, std::uint32_t crc, std::uint32_t size_bytes, std::size_t name_bytes) {
  put16(out, 10);      // version needed: 1.0
  put16(out, 0x0800);  // names are UTF-8
  put16(out, 0);       // stored
  put16(out, 0);       // 00:00:00
  put16(out, 0x0021);  // 1980-01-01
  put32(out, crc);
  put32(out, size_bytes);
  put32(out, size_bytes);
  put16(out, name_bytes);
  put16(out, 0);  // no extra field
}

}  // namespace

api::Status ZipStore::begin(std::string_view name, std::uint64_t size_bytes) {
  if (auto closed = close_entry(); !closed) return closed;
  std::uint64_t directory_bytes = 64;
  for (const Entry& entry : entries_) directory_bytes += kDirectoryEntryBytes + entry.name.size();
  const std::uint64_t total_bytes =
      end_bytes_ + kLocalHeaderBytes + 2 * name.size() + kDirectoryEntryBytes + size_bytes + directory_bytes;
  if (total_bytes >= kLimitBytes || entries_.size() + 1 >= 0xffff)
    return api::Error{api::Fault::out_of_resources,
                      "archive entry '" + std::string(name) + "' would bring the archive to " +
                          std::to_string(total_bytes) + " bytes; 4 GiB is the limit"};

  std::string header = "PK\x03\x04";
  put_common(header, 0, static_cast<std::uint32_t>(size_bytes), name.size());
  header += name;
  entries_.push_back(
      {std::string(name), static_cast<std::uint32_t>(end_bytes_), static_cast<std::uint32_t>(size_bytes), 0});
  missing_bytes_ = size_bytes;
  end_bytes_ += header.size() + size_bytes;
  return file_.append(header);
}

api::Status ZipStore::append(std::string_view bytes) {
  assert(bytes.size() <= missing_bytes_);
  missing_bytes_ -= bytes.size();
  Entry& entry = entries_.back();
  entry.crc32 = static_cast<std::uint32_t>(
      ::crc32_z(entry.crc32, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  return file_.append(bytes);
}

api::Status ZipStore::close_entry() {
  assert(missing_bytes_ == 0);
  if (entries_.empty()) return api::Done{};
  std::string crc;
  put32(crc, entries_.back().crc32);
  return file_.write_at(entries_.back().offset_bytes + kCrcOffsetBytes, crc);
}

api::Status ZipStore::finish() {
  if (auto closed = close_entry(); !closed) return closed;
  std::string directory;
  for (const Entry& entry : entries_) {
    directory += "PK\x01\x02";
    put16(directory, 0x0314);  // made by: Unix, 2.0
    put_common(directory, entry.crc32, entry.size_bytes, entry.name.size());
    put16(directory, 0);                   // no comment
    put16(directory, 0);                   // first disk
    put16(directory, 0);                   // binary
    put32(directory, 0x81a40000u);         // -rw-r--r--
    put32(directory, entry.offset_bytes);  // of the local header
    directory += entry.name;
  }
  const std::size_t directory_bytes = directory.size();
  directory += "PK\x05\x06";
  put32(directory, 0);  // one disk
  put16(directory, entries_.size());
  put16(directory, entries_.size());
  put32(directory, directory_bytes);
  put32(directory, end_bytes_);
  put16(directory, 0);  // no comment
  return file_.append(directory);
}

}  // namespace engine
