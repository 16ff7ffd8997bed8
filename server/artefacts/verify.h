// Is what a worker says it left behind really there?
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "server/artefacts/files.h"

namespace server {

/// What the manifest says of one file.
struct ClaimedFile {
  std::string path;
  std::int64_t bytes = 0;
  std::string sha256;                  ///< lower-case hexadecimal
  std::string_view kind = "artefact";  ///< for messages
};

inline const std::atomic<bool> kNeverStops = false;

/// SHA-256 of what comes in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  /// Anew, whatever came before.
  void begin();
  void take(std::string_view bytes);
  /// Lower-case hexadecimal; empty where the library has no SHA-256.
  std::string end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 of the file from its start, lower-case hexadecimal; read in pieces, never held whole.
/// Fault::stopped soon after `stopping` turns true.
api::Result<std::string> sha256_of(const FileHandle& file, const std::atomic<bool>& stopping = kNeverStops);
std::string sha256_of(std::string_view bytes);

/// Its size alone. Errors: as verify_file.
api::Status verify_size(const std::filesystem::path& folder, const ClaimedFile& file);
/// One of them, as verify_files says. Errors: invalid_request where it is proven to be another file, or none;
/// internal where it could not be looked at, which proves nothing; stopped.
api::Status verify_file(const std::filesystem::path& folder, const ClaimedFile& file,
                        const std::atomic<bool>& stopping = kNeverStops);

/// Every file exists below `folder` as a regular file under a plain relative path, with that size and hash,
/// and no path comes twice. Errors: invalid_request naming the first file that does not; internal; stopped.
/// The worker has parsed a stranger's upload, so it is believed nothing, and must not make us read for days:
/// a file has one name only, all of them together are not much larger than what they take on disk, and half
/// an hour is enough to read them.
api::Status verify_files(const std::filesystem::path& folder, const std::vector<ClaimedFile>& files,
                         const std::atomic<bool>& stopping = kNeverStops);

}  // namespace server
