#include "server/artefacts/verify.h"

#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <set>

namespace server {
namespace {

constexpr std::size_t kReadBytes = 64 * 1024;
constexpr std::int64_t kBlockBytes = 512;  // of st_blocks, whatever the file system's are
// File systems compress, pictures of nothing more than others.
constexpr std::int64_t kBytesPerByteOnDiskMax = 32;
constexpr std::int64_t kBytesWithoutQuestion = std::int64_t{4} << 30;
constexpr std::chrono::minutes kReadingTimeMax{30};

using Digest = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

Digest new_digest() {
  Digest digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  if (digest && EVP_DigestInit_ex(digest.get(), EVP_sha256(), nullptr) != 1) digest.reset();
  return digest;
}

std::string hexadecimal(Digest& digest) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned int size = 0;
  EVP_DigestFinal_ex(digest.get(), bytes.data(), &size);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    text += kDigits[bytes[i] >> 4];
    text += kDigits[bytes[i] & 15];
  }
  return text;
}

api::Error bad(const ClaimedFile& file, std::string_view what) {
  return {api::Fault::invalid_request, std::string(file.kind) + " '" + file.path + "' " + std::string(what)};
}

/// What the disk itself says it cannot give back is damaged.
api::Error not_read(int error_number) {
  api::Error error = file_error("it cannot be read", error_number);
  if (error_number == EIO || error_number == EUCLEAN || error_number == EBADMSG)
    error.fault = api::Fault::invalid_request;
  return error;
}

api::Error of_file(const ClaimedFile& file, const api::Error& why) {
  return {why.fault, std::string(file.kind) + " '" + file.path + "': " + why.message};
}

/// One that is not there is bad. Of one that could not be looked at, for want of a descriptor or of the
/// right to, nothing is known.
api::Error not_opened(const ClaimedFile& file, const api::Error& why) {
  api::Error error = bad(file, "cannot be opened: " + why.message);
  const bool proven = why.fault == api::Fault::not_found || why.fault == api::Fault::invalid_request;
  if (!proven) error.fault = why.fault;
  return error;
}

}  // namespace

struct Sha256::State {
  Digest digest = new_digest();
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;

void Sha256::begin() {
  state_->digest = new_digest();
}

void Sha256::take(std::string_view bytes) {
  if (state_->digest) EVP_DigestUpdate(state_->digest.get(), bytes.data(), bytes.size());
}

std::string Sha256::end() {
  return state_->digest ? hexadecimal(state_->digest) : std::string();
}

api::Result<std::string> sha256_of(const FileHandle& file, const std::atomic<bool>& stopping) {
  Digest digest = new_digest();
  if (!digest) return api::Error{api::Fault::internal, "SHA-256 is not available"};
  const auto piece = std::make_unique<std::array<char, kReadBytes>>();
  for (off_t offset = 0;;) {
    if (stopping) return api::Error{api::Fault::stopped, "stopped while a file was read"};
    const ssize_t count = ::pread(file.get(), piece->data(), piece->size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return not_read(errno);
    if (count == 0) return hexadecimal(digest);
    EVP_DigestUpdate(digest.get(), piece->data(), static_cast<std::size_t>(count));
    offset += count;
  }
}

std::string sha256_of(std::string_view bytes) {
  Digest digest = new_digest();
  if (!digest) return {};
  EVP_DigestUpdate(digest.get(), bytes.data(), bytes.size());
  return hexadecimal(digest);
}

namespace {

api::Result<FileHandle> open_of_size(const std::filesystem::path& folder, const ClaimedFile& file) {
  auto opened = open_below(folder, file.path);
  if (!opened) return not_opened(file, opened.error());
  const auto size = size_of(*opened);
  if (!size) return size.error();
  if (*size != file.bytes)
    return bad(file, "has " + std::to_string(*size) + " bytes, not " + std::to_string(file.bytes));
  return opened;
}

}  // namespace

api::Status verify_size(const std::filesystem::path& folder, const ClaimedFile& file) {
  const auto opened = open_of_size(folder, file);
  return opened ? api::Status(api::Done{}) : api::Status(opened.error());
}

api::Status verify_file(const std::filesystem::path& folder, const ClaimedFile& file,
                        const std::atomic<bool>& stopping) {
  const auto opened = open_of_size(folder, file);
  if (!opened) return opened.error();
  const auto hash = sha256_of(*opened, stopping);
  if (!hash) return of_file(file, hash.error());
  if (*hash != file.sha256) return bad(file, "has another SHA-256 than when it was made");
  return api::Done{};
}

namespace {

/// Is there anything that would take long to read without having taken long to write?
api::Status look_at(const std::filesystem::path& folder, const std::vector<ClaimedFile>& files) {
  std::set<std::string_view> seen;
  std::int64_t bytes = 0, on_disk_bytes = 0;
  for (const ClaimedFile& file : files) {
    if (!seen.insert(file.path).second) return bad(file, "is listed twice");
    const auto opened = open_below(folder, file.path);
    if (!opened) return not_opened(file, opened.error());
    struct stat about {};
    if (::fstat(opened->get(), &about) != 0) return file_error(file.path, errno);
    if (about.st_nlink != 1) return bad(file, "has another name beside this one");
    bytes += std::int64_t{about.st_size};
    on_disk_bytes += std::int64_t{about.st_blocks} * kBlockBytes;
    if (bytes > kBytesWithoutQuestion && bytes / kBytesPerByteOnDiskMax > on_disk_bytes)
      return bad(file, "and those before it are mostly holes");
  }
  return api::Done{};
}

}  // namespace

api::Status verify_files(const std::filesystem::path& folder, const std::vector<ClaimedFile>& files,
                         const std::atomic<bool>& stopping) {
  if (api::Status readable = look_at(folder, files); !readable) return readable;
  const auto deadline = std::chrono::steady_clock::now() + kReadingTimeMax;
  for (const ClaimedFile& file : files) {
    if (std::chrono::steady_clock::now() > deadline)
      return bad(file, "is not read: that would take too long");
    if (api::Status fine = verify_file(folder, file, stopping); !fine) return fine;
  }
  return api::Done{};
}

}  // namespace server
