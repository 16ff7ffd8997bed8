#include "engine/base/checkpoint.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

#include "engine/base/durable_file.h"
#include "engine/base/sha256.h"

namespace engine {
namespace {

namespace fs = std::filesystem;

// File: kMagic, fingerprint length and fingerprint, number of parts, length of each, the parts, SHA-256 of
// all before it in hexadecimal. Lengths are 64 bits of this machine: another one's file has another magic.
constexpr std::uint64_t kMagic = 0x6b6c6370'74303031;  // "klcpt001"
constexpr std::size_t kDigestBytes = 64;
constexpr std::size_t kPartsMax = 1024;
constexpr std::size_t kFingerprintBytesMax = 1024;

std::string_view chars(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void append_number(std::string& text, std::uint64_t number) {
  text += chars(std::as_bytes(std::span(&number, 1)));
}

std::string header_of(const std::string& fingerprint, std::span<const CheckpointPart> parts) {
  std::string header;
  append_number(header, kMagic);
  append_number(header, fingerprint.size());
  header += fingerprint;
  append_number(header, parts.size());
  for (const CheckpointPart part : parts) append_number(header, part.size());
  return header;
}

api::Status write_parts(const fs::path& path, const std::string& header,
                        std::span<const CheckpointPart> parts) {
  auto file = DurableFile::create(path);
  if (!file) return file.error();
  Sha256 hash;
  const auto append = [&](std::string_view bytes) {
    hash.add(bytes);
    return file->append(bytes);
  };
  if (auto written = append(header); !written) return written;
  for (const CheckpointPart part : parts)
    if (auto written = append(chars(part)); !written) return written;
  if (auto written = file->append(hash.hex()); !written) return written;
  if (auto published = file->publish(); !published) return published;
  return sync_folder(path.parent_path());
}

/// All of `to`, from `offset` on.
bool read_at(int file, std::size_t offset, std::span<std::byte> to) {
  while (!to.empty()) {
    const ssize_t got = ::pread(file, to.data(), to.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::size_t>(got);
    to = to.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

bool read_number(int file, std::size_t& offset, std::uint64_t& number) {
  if (!read_at(file, offset, std::as_writable_bytes(std::span(&number, 1)))) return false;
  offset += sizeof number;
  return true;
}

bool read_text(int file, std::size_t& offset, std::string& text) {
  if (!read_at(file, offset, std::as_writable_bytes(std::span(text)))) return false;
  offset += text.size();
  return true;
}

struct Contents {
  std::vector<std::size_t> part_bytes;
  std::size_t offset = 0;  ///< of the first part
};

/// Where the parts lie, if the file is of this fingerprint and as long as it says.
std::optional<Contents> read_header(int file, const std::string& fingerprint, std::size_t file_bytes) {
  Contents contents;
  std::uint64_t magic = 0, length = 0, parts = 0;
  std::size_t& at = contents.offset;
  if (!read_number(file, at, magic) || magic != kMagic || !read_number(file, at, length) ||
      length > kFingerprintBytesMax)
    return std::nullopt;
  std::string theirs(length, '\0');
  if (!read_text(file, at, theirs) || theirs != fingerprint || !read_number(file, at, parts) ||
      parts > kPartsMax)
    return std::nullopt;
  std::uint64_t sum = 0;
  for (std::uint64_t k = 0; k < parts; ++k) {
    std::uint64_t bytes = 0;
    if (!read_number(file, at, bytes) || bytes > Checkpoints::kBytesMax) return std::nullopt;
    contents.part_bytes.push_back(bytes);
    sum += bytes;
  }
  if (at + sum + kDigestBytes != file_bytes) return std::nullopt;
  return contents;
}

bool has_its_digest(int file, std::size_t file_bytes) {
  Sha256 hash;
  std::vector<std::byte> buffer(1u << 20);
  const std::size_t end = file_bytes - kDigestBytes;
  for (std::size_t at = 0; at < end;) {
    const std::span piece(buffer.data(), std::min(buffer.size(), end - at));
    if (!read_at(file, at, piece)) return false;
    hash.add(chars(piece));
    at += piece.size();
  }
  std::string digest(kDigestBytes, '\0');
  return read_at(file, end, std::as_writable_bytes(std::span(digest))) && digest == hash.hex();
}

}  // namespace

SavedCheckpoint::SavedCheckpoint(int file, std::vector<std::size_t> part_bytes, std::size_t offset)
    : file_(file), part_bytes_(std::move(part_bytes)), offset_(offset) {}

SavedCheckpoint::SavedCheckpoint(SavedCheckpoint&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      part_bytes_(std::move(other.part_bytes_)),
      next_(other.next_),
      offset_(other.offset_) {}

SavedCheckpoint::~SavedCheckpoint() {
  if (file_ >= 0) ::close(file_);
}

bool SavedCheckpoint::take_bytes(std::span<std::byte> to) {
  if (parts_left() == 0 || to.size() != next_bytes() || !read_at(file_, offset_, to)) return false;
  offset_ += to.size();
  ++next_;
  return true;
}

Checkpoints::Checkpoints(fs::path folder, std::string fingerprint, std::chrono::milliseconds apart)
    : folder_(std::move(folder)), fingerprint_(std::move(fingerprint)), apart_(apart) {
  if (!folder_.empty()) next_due_ = Clock::now() + apart_;
}

fs::path Checkpoints::path_of(std::string_view name) const {
  return folder_ / name;
}

api::Status Checkpoints::save(std::string_view name, std::span<const CheckpointPart> parts) {
  if (folder_.empty()) return api::Done{};
  const Clock::time_point began = Clock::now();
  std::size_t bytes = 0;
  for (const CheckpointPart part : parts) bytes += part.size();
  api::Status saved = api::Done{};
  if (bytes > kBytesMax || parts.size() > kPartsMax) {
    saved = api::Error{api::Fault::out_of_resources,
                       "a checkpoint of " + std::to_string(bytes >> 20) + " MiB is more than is kept"};
  } else {
    std::error_code failed;
    if (fs::create_directories(folder_, failed)) saved = sync_folder(folder_.parent_path());
    if (failed) saved = file_error("make", folder_, failed.value());
    if (saved) saved = write_parts(path_of(name), header_of(fingerprint_, parts), parts);
  }
  const Clock::time_point now = Clock::now();
  const auto apart =
      std::max<Clock::duration>(apart_, std::min<Clock::duration>(20 * (now - began), kFurthestApart));
  next_due_ = now + apart;
  return saved;
}

std::optional<SavedCheckpoint> Checkpoints::load(std::string_view name) const {
  if (folder_.empty()) return std::nullopt;
  const fs::path path = path_of(name);
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (file < 0) return std::nullopt;
  SavedCheckpoint saved(file, {}, 0);
  struct stat about {};
  if (::fstat(file, &about) == 0 && S_ISREG(about.st_mode)) {
    const auto bytes = static_cast<std::size_t>(about.st_size);
    if (auto contents = read_header(file, fingerprint_, bytes); contents && has_its_digest(file, bytes)) {
      saved.part_bytes_ = std::move(contents->part_bytes);
      saved.offset_ = contents->offset;
      return saved;
    }
  }
  std::error_code ignored;
  fs::remove(path, ignored);
  return std::nullopt;
}

bool Checkpoints::due() const {
  return Clock::now() >= next_due_;
}

void Checkpoints::remove(std::string_view name) {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove(path_of(name), ignored);
}

void Checkpoints::clear() {
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace engine
