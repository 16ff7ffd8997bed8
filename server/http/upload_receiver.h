// Takes the parts of a multipart upload as they come in, straight to disk, and counts them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "api/given_names.h"
#include "api/job_request.h"
#include "api/result.h"
#include "server/archives/archive.h"
#include "server/artefacts/data_folder.h"
#include "server/artefacts/verify.h"
#include "server/http/message.h"
#include "server/jobs/job_service.h"

namespace server {

struct UploadLimits {
  std::int64_t total_bytes = std::int64_t{2} << 30;
  std::int64_t animation_bytes = std::int64_t{api::kAnimationBytesMax};
  std::size_t materials = 16;
  std::size_t textures = 256;
  ArchiveLimits archive;
};

/// Nothing is held in memory but the part at hand's name. Unless it is finished, the destructor removes what
/// came in.
class UploadReceiver {
 public:
  UploadReceiver(const DataFolder& folder, std::string id, UploadLimits limits);
  ~UploadReceiver();
  UploadReceiver(const UploadReceiver&) = delete;
  UploadReceiver& operator=(const UploadReceiver&) = delete;

  /// So many bytes are to come, as far as is known. False: there is no room for them.
  bool reserve(std::int64_t bytes);
  /// The next part begins. False: refused, read no further.
  bool begin_part(std::string_view field, std::string_view file_name);
  /// Bytes of the part at hand. False: refused, read no further.
  bool take(std::string_view bytes);
  /// The part at hand is over. -> SHA-256 of what it held, empty for options; none: refused
  std::optional<std::string> end_part();
  /// All parts are here and durable. From now on the files belong to whoever has the Upload.
  api::Result<Upload> finish();

  /// Why it was refused, as HTTP tells it: 413 for too large, 422 for wrong parts, 507, 500.
  struct Refusal {
    int status = 0;  ///< 0: as the error's fault says
    api::Error error;
  };
  const std::optional<Refusal>& refusal() const { return refusal_; }
  /// For whoever wrote -F scene=FILE, which sends the file's name instead of the file; empty where every part
  /// came as a file.
  const std::string& hint() const { return hint_; }

 private:
  bool refuse(Refusal refusal);
  bool refuse_part(std::string_view part, std::string_view code, std::string detail, int status = 422);
  bool begin_options();
  bool begin_archive();
  bool begin_input(std::string_view field, std::string_view file_name);
  bool take_option_bytes(std::string_view bytes);
  bool write(std::string_view bytes);
  bool unpack();
  api::Status take_entry(const std::string& name);
  bool open_file(const std::filesystem::path& path);
  bool close_file();
  std::string shown_name(const InputFile& input) const;
  bool keep_names();
  std::optional<InputFile> input_for(std::string_view field, std::string_view file_name);
  bool has_room_for(const InputFile& input);

  const DataFolder& folder_;
  std::string id_;
  UploadLimits limits_;
  std::filesystem::path input_folder_;
  RoomClaim room_;
  FileHandle file_;
  Sha256 digest_;  ///< of what is in that file so far
  std::string last_sha256_;
  std::vector<InputFile> inputs_;  ///< the last one is being received
  api::GivenNames given_names_;
  std::string options_;  ///< of the part `options`, which is no file
  bool has_options_ = false;
  bool in_options_ = false;  ///< that part is being received
  bool has_archive_ = false;
  bool in_archive_ = false;
  std::int64_t total_bytes_ = 0;
  std::optional<Refusal> refusal_;
  std::string hint_;
  bool finished_ = false;
};

/// The last component of a file name as clients send it ("C:\\a\\b.mtl", "a/b.mtl" -> "b.mtl"), or none where
/// that is no name to keep a file under: empty, hidden, longer than 200 bytes, or none that a file of an
/// archive may have (is_entry_name): not UTF-8, with control characters.
std::optional<std::string> safe_base_name(std::string_view file_name);

}  // namespace server
