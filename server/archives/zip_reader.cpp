// Zip, as far as people send scenes in it: stored or deflated files, one volume, below 4 GiB.
// Source: PKWARE APPNOTE 6.3.10, sections 4.3 and 4.4.
#include <zlib.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "server/archives/entry_keeper.h"

namespace server {
namespace {

constexpr std::size_t kEndBytes = 22;
constexpr std::size_t kCommentBytesMax = 65535;
constexpr std::size_t kCentralBytes = 46;
constexpr std::size_t kLocalBytes = 30;
constexpr std::int64_t kDirectoryBytesMax = 1 << 20;
constexpr std::size_t kZipPieceBytes = 64 << 10;
constexpr std::uint32_t kZip64 = 0xFFFFFFFF;
constexpr unsigned kUnix = 3;
constexpr unsigned kFileType = 0170000, kRegular = 0100000, kFolder = 0040000;

/// Little-endian numbers of a record that is known to be long enough.
std::uint32_t u16(std::string_view record, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(record[i]));
  };
  return byte(at) | byte(at + 1) << 8;
}
std::uint32_t u32(std::string_view record, std::size_t at) {
  return u16(record, at) | u16(record, at + 2) << 16;
}

struct Entry {
  std::string name;
  unsigned flags = 0;
  unsigned method = 0;
  std::uint32_t crc = 0;
  std::int64_t stored_bytes = 0;
  std::int64_t bytes = 0;
  std::int64_t header_at = 0;
  unsigned unix_mode = 0;  ///< 0: not made on a system that has them
  std::int64_t data_at = 0;

  bool is_folder() const { return name.ends_with('/'); }
};

struct Directory {
  std::int64_t at = 0;
  std::int64_t bytes = 0;
  std::size_t entries = 0;
};

api::Error broken_zip(std::string_view entry, std::string_view detail) {
  return archive_refusal(entry, "bad_archive", detail);
}

/// The record at the very end, behind which there is its comment and nothing else.
api::Result<Directory> find_directory(const FileHandle& archive, std::int64_t size) {
  const auto tail_bytes =
      static_cast<std::size_t>(std::min<std::int64_t>(size, kEndBytes + kCommentBytesMax));
  const std::string tail = read_at(archive, size - static_cast<std::int64_t>(tail_bytes), tail_bytes);
  for (std::size_t at = tail.size(); at-- > 0;) {
    if (at + kEndBytes > tail.size() || tail.compare(at, 4, "PK\x05\x06") != 0) continue;
    const std::string_view record = std::string_view(tail).substr(at);
    if (kEndBytes + u16(record, 20) != record.size()) continue;
    const Directory found{u32(record, 16), u32(record, 12), u16(record, 10)};
    if (u16(record, 4) != 0 || u16(record, 6) != 0 || u16(record, 8) != u16(record, 10))
      return archive_refusal("", "unsupported", "is one volume of several");
    if (found.at == kZip64 || found.bytes == kZip64 || found.entries == 0xFFFF)
      return archive_refusal("", "unsupported", "is a zip64 archive, for files beyond 4 GiB");
    if (found.bytes > kDirectoryBytesMax)
      return archive_refusal("", "too_many", "has a directory beyond reason");
    if (found.at + found.bytes != size - static_cast<std::int64_t>(record.size()))
      return broken_zip("", "has bytes before or after it, or was cut");
    return found;
  }
  return broken_zip("", "has no end: it was cut, or bytes follow it");
}

/// Takes one record off the front of the directory.
api::Result<Entry> take_entry(std::string_view& directory) {
  if (directory.size() < kCentralBytes || !directory.starts_with("PK\x01\x02"))
    return broken_zip("", "has a directory that ends early");
  const std::string_view record = directory;
  Entry entry;
  const std::size_t name_bytes = u16(record, 28);
  const std::size_t whole = kCentralBytes + name_bytes + u16(record, 30) + u16(record, 32);
  if (directory.size() < whole) return broken_zip("", "has a directory that ends early");
  entry.name = record.substr(kCentralBytes, name_bytes);
  entry.flags = u16(record, 8);
  entry.method = u16(record, 10);
  entry.crc = u32(record, 16);
  entry.stored_bytes = u32(record, 20);
  entry.bytes = u32(record, 24);
  entry.header_at = u32(record, 42);
  if (u16(record, 4) >> 8 == kUnix) entry.unix_mode = u32(record, 38) >> 16;
  directory.remove_prefix(whole);
  return entry;
}

api::Status check_kind(const Entry& entry) {
  if ((entry.flags & 0x2041u) != 0)  // encrypted, strongly so, or with a hidden directory
    return archive_refusal(entry.name, "encrypted", "is encrypted");
  if (entry.method != 0 && entry.method != 8)
    return archive_refusal(entry.name, "unsupported", "is compressed by another method than deflate");
  if (entry.stored_bytes == kZip64 || entry.bytes == kZip64 || entry.header_at == kZip64)
    return archive_refusal(entry.name, "unsupported", "has a size of zip64");
  const unsigned type = entry.unix_mode & kFileType;
  const unsigned expected = entry.is_folder() ? kFolder : kRegular;
  if (type != 0 && type != expected)
    return archive_refusal(entry.name, "not_a_file", "is a link or a device, not a file");
  if (entry.is_folder() && entry.bytes != 0)
    return archive_refusal(entry.name, "not_a_file", "is a folder that holds bytes");
  if (entry.method == 0 && entry.bytes != entry.stored_bytes)
    return broken_zip(entry.name, "is stored as it is, and yet has two sizes");
  return api::Done{};
}

/// Finds the entry's bytes, and checks that both of its headers tell the same.
api::Status locate(const FileHandle& archive, std::int64_t directory_at, Entry& entry) {
  const std::string header = read_at(archive, entry.header_at, kLocalBytes);
  if (header.empty() || !header.starts_with("PK\x03\x04"))
    return broken_zip(entry.name, "is not where it should be");
  const std::size_t name_bytes = u16(header, 26);
  entry.data_at = entry.header_at + static_cast<std::int64_t>(kLocalBytes + name_bytes + u16(header, 28));
  if (entry.data_at + entry.stored_bytes > directory_at)
    return broken_zip(entry.name, "reaches beyond the archive");
  if (name_bytes != entry.name.size() ||
      (name_bytes > 0 &&
       read_at(archive, entry.header_at + static_cast<std::int64_t>(kLocalBytes), name_bytes) != entry.name))
    return broken_zip(entry.name, "has two names");
  if (u16(header, 8) != entry.method) return broken_zip(entry.name, "has two methods");
  const bool sizes_follow = (u16(header, 6) & 8u) != 0;  // behind the bytes, where nobody needs them
  if (!sizes_follow && (u32(header, 18) != entry.stored_bytes || u32(header, 22) != entry.bytes))
    return broken_zip(entry.name, "has two sizes");
  return api::Done{};
}

/// Bytes that serve several entries are the way to petabytes out of megabytes.
api::Status refuse_overlaps(const std::vector<Entry>& entries) {
  std::vector<const Entry*> by_place;
  for (const Entry& entry : entries) by_place.push_back(&entry);
  std::sort(by_place.begin(), by_place.end(),
            [](const Entry* a, const Entry* b) { return a->header_at < b->header_at; });
  for (std::size_t i = 1; i < by_place.size(); ++i)
    if (by_place[i]->header_at < by_place[i - 1]->data_at + by_place[i - 1]->stored_bytes)
      return broken_zip(by_place[i]->name, "overlaps '" + by_place[i - 1]->name + "'");
  return api::Done{};
}

/// Counts and sums what comes out.
class Output {
 public:
  Output(const Entry& entry, EntryKeeper& keeper) : entry_(entry), keeper_(keeper) {}

  api::Status take(std::string_view bytes) {
    count_ += static_cast<std::int64_t>(bytes.size());
    if (count_ > entry_.bytes) return broken_zip(entry_.name, "is larger than it says");
    crc_ = crc32_z(crc_, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return keeper_.take(bytes);
  }
  api::Status finish() const {
    if (count_ != entry_.bytes) return broken_zip(entry_.name, "is smaller than it says");
    if (crc_ != entry_.crc) return broken_zip(entry_.name, "has a wrong checksum");
    return api::Done{};
  }

 private:
  const Entry& entry_;
  EntryKeeper& keeper_;
  std::int64_t count_ = 0;
  uLong crc_ = 0;
};

class Inflater {
 public:
  Inflater() { ready_ = inflateInit2(&stream_, -MAX_WBITS) == Z_OK; }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  bool ended() const { return ended_; }

  api::Status feed(std::string_view bytes, const Entry& entry, Output& output) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {
      if (!ready_ || ended_) return broken_zip(entry.name, "has bytes behind its end");
      stream_.next_out = piece_.data();
      stream_.avail_out = static_cast<uInt>(piece_.size());
      const int answer = inflate(&stream_, Z_NO_FLUSH);
      if (answer != Z_OK && answer != Z_STREAM_END && answer != Z_BUF_ERROR)
        return broken_zip(entry.name, "cannot be decompressed");
      const std::string_view out(reinterpret_cast<const char*>(piece_.data()),
                                 piece_.size() - stream_.avail_out);
      if (const api::Status taken = output.take(out); !taken) return taken;
      ended_ = answer == Z_STREAM_END;
      // A full piece may mean that more waits inside, also where all of the input is taken.
    } while (stream_.avail_in > 0 || (stream_.avail_out == 0 && !ended_));
    return api::Done{};
  }

 private:
  z_stream stream_{};
  std::array<Bytef, kZipPieceBytes> piece_;
  bool ready_ = false;
  bool ended_ = false;
};

api::Status copy_entry(const FileHandle& archive, const Entry& entry, EntryKeeper& keeper) {
  Output output(entry, keeper);
  const auto inflater = entry.method == 8 ? std::make_unique<Inflater>() : nullptr;
  for (std::int64_t done = 0; done < entry.stored_bytes;) {
    const auto wanted =
        static_cast<std::size_t>(std::min<std::int64_t>(kZipPieceBytes, entry.stored_bytes - done));
    const std::string piece = read_at(archive, entry.data_at + done, wanted);
    if (piece.empty()) return broken_zip(entry.name, "ends early");
    done += static_cast<std::int64_t>(piece.size());
    const api::Status taken = inflater ? inflater->feed(piece, entry, output) : output.take(piece);
    if (!taken) return taken;
  }
  if (inflater && !inflater->ended()) return broken_zip(entry.name, "ends early");
  return output.finish();
}

api::Result<std::vector<Entry>> read_directory(const FileHandle& archive, std::int64_t size,
                                               EntryKeeper& keeper) {
  const auto found = find_directory(archive, size);
  if (!found) return found.error();
  const std::string bytes = read_at(archive, found->at, static_cast<std::size_t>(found->bytes));
  std::string_view rest = bytes;
  std::vector<Entry> entries;
  while (!rest.empty()) {
    if (const api::Status counted = keeper.count(); !counted) return counted.error();
    auto entry = take_entry(rest);
    if (!entry) return entry.error();
    if (const api::Status fine = check_kind(*entry); !fine) return fine.error();
    if (const api::Status found_it = locate(archive, found->at, *entry); !found_it) return found_it.error();
    entries.push_back(std::move(*entry));
  }
  if (entries.size() != found->entries) return broken_zip("", "has another number of entries than it says");
  if (const api::Status apart = refuse_overlaps(entries); !apart) return apart.error();
  return entries;
}

}  // namespace

api::Status read_zip(const FileHandle& archive, std::int64_t size, EntryKeeper& keeper) {
  const auto entries = read_directory(archive, size, keeper);
  if (!entries) return entries.error();
  for (const Entry& entry : *entries) {
    if (entry.is_folder()) continue;
    if (const api::Status begun = keeper.begin(entry.name, entry.stored_bytes); !begun) return begun;
    if (const api::Status copied = copy_entry(archive, entry, keeper); !copied) return copied;
  }
  return api::Done{};
}

}  // namespace server
