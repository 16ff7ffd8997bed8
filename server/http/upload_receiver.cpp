#include "server/http/upload_receiver.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "api/job_options.h"
#include "server/archives/archive.h"
#include "server/artefacts/files.h"
#include "server/http/field_text.h"

namespace server {
namespace {

constexpr std::size_t kNameBytesMax = 200;
constexpr std::size_t kShownBytesMax = 64;             // of a name that means nothing to us
constexpr std::string_view kOptions = "options";       // a part without a file
constexpr std::string_view kArchiveField = "archive";  // one that holds the others
constexpr std::array<std::string_view, 2> kReservedNames{"scene.obj", "animation.json"};

struct Field {
  std::string_view name;
  InputRole role;
  std::string_view stored_as;  ///< empty: under the part's own file name
};

constexpr std::array kFields{
    Field{"scene", InputRole::scene, "scene.obj"},
    Field{"materials", InputRole::material, ""},
    Field{"textures", InputRole::texture, ""},
    Field{"animation", InputRole::animation, "animation.json"},
};

}  // namespace

std::optional<std::string> safe_base_name(std::string_view file_name) {
  const std::size_t slash = file_name.find_last_of("/\\");
  const std::string_view name = slash == file_name.npos ? file_name : file_name.substr(slash + 1);
  if (name.size() > kNameBytesMax || name.starts_with('.') || !is_entry_name(name)) return std::nullopt;
  return std::string(name);
}

UploadReceiver::UploadReceiver(const DataFolder& folder, std::string id, UploadLimits limits)
    : folder_(folder),
      id_(std::move(id)),
      limits_(limits),
      input_folder_(folder.upload(id_) / "input"),
      room_(folder.room()) {
  for (const auto& path : {input_folder_.parent_path(), input_folder_})
    if (!refusal_ && ::mkdir(path.c_str(), 0700) != 0)
      refuse({0, file_error("make folder " + path.string(), errno)});
}

UploadReceiver::~UploadReceiver() {
  if (!finished_) (void)remove_tree(folder_.upload(id_));
}

bool UploadReceiver::reserve(std::int64_t bytes) {
  if (const api::Status room = room_.reserve(bytes); !room) return refuse({0, room.error()});
  return true;
}

bool UploadReceiver::refuse(Refusal refusal) {
  if (!refusal_) refusal_ = std::move(refusal);
  return false;
}

bool UploadReceiver::refuse_part(std::string_view part, std::string_view code, std::string detail,
                                 int status) {
  const std::string message = "the upload is refused: " + detail;
  return refuse({status,
                 {api::Fault::invalid_request,
                  message,
                  {{std::string(part), "", 0, 0, std::string(code), std::move(detail)}}}});
}

std::optional<InputFile> UploadReceiver::input_for(std::string_view field, std::string_view file_name) {
  const auto known =
      std::find_if(kFields.begin(), kFields.end(), [&](const Field& f) { return f.name == field; });
  if (known == kFields.end()) {
    const std::string_view shown = field.substr(0, kShownBytesMax);
    refuse_part(shown, "unknown_part",
                "there is no part '" + std::string(shown) +
                    "'; known are scene, materials, textures, animation, options, archive");
    return std::nullopt;
  }
  if (!known->stored_as.empty()) {
    // What has no name is sent under its part's, or as standard input.
    if (const auto given = safe_base_name(file_name);
        given && *given != known->stored_as && *given != field && *given != "-")
      given_names_[std::string(known->stored_as)] = *given;
    return InputFile{std::string(known->stored_as), known->role};
  }
  auto name = safe_base_name(file_name);
  const bool reserved =
      name && std::any_of(kReservedNames.begin(), kReservedNames.end(),
                          [&](std::string_view other) { return same_ignoring_case(*name, other); });
  if (!name || reserved) {
    refuse_part(field, "bad_name",
                "a part '" + std::string(field) +
                    "' needs a file name of its own, such as room.mtl; send it as a file: -F " +
                    std::string(field) + "=@FILE");
    return std::nullopt;
  }
  return InputFile{std::move(*name), known->role};
}

std::string UploadReceiver::shown_name(const InputFile& input) const {
  const auto given = given_names_.find(input.name);
  return given == given_names_.end() ? input.name : given->second;
}

// Beside the inputs, for the worker, whose reports then call them so.
bool UploadReceiver::keep_names() {
  if (given_names_.empty()) return true;
  const std::filesystem::path path = input_folder_.parent_path() / api::kGivenNamesFile;
  const FileHandle file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file) return refuse({0, file_error(path.string(), errno)});
  if (const api::Status written = write_all(file, api::given_names_json(given_names_)); !written)
    return refuse({0, written.error()});
  return true;
}

bool UploadReceiver::has_room_for(const InputFile& input) {
  // Materials and textures are looked up by name whatever the case, so two such names would be one.
  for (const InputFile& other : inputs_)
    if (same_ignoring_case(other.name, input.name))
      return refuse_part(input.name, "duplicate_part", "'" + input.name + "' comes twice");
  const auto of_role = static_cast<std::size_t>(std::count_if(
      inputs_.begin(), inputs_.end(), [&](const InputFile& other) { return other.role == input.role; }));
  const std::size_t most = input.role == InputRole::material  ? limits_.materials
                           : input.role == InputRole::texture ? limits_.textures
                                                              : 1;
  if (of_role >= most)
    return refuse_part(input.name, "too_many", "more than " + std::to_string(most) + " parts of one kind",
                       413);
  return true;
}

bool UploadReceiver::begin_options() {
  if (has_options_) return refuse_part(kOptions, "duplicate_part", "'options' comes twice");
  return has_options_ = in_options_ = true;
}

bool UploadReceiver::begin_part(std::string_view field, std::string_view file_name) {
  if (refusal_ || !close_file()) return false;
  in_options_ = in_archive_ = false;
  if (field == kOptions) return begin_options();
  if (field == kArchiveField) return begin_archive();
  if (file_name.empty() && hint_.empty())
    hint_ = "The part '" + std::string(field) + "' came without a file name; send it as a file: -F " +
            std::string(field) + "=@FILE";
  return begin_input(field, file_name);
}

bool UploadReceiver::begin_input(std::string_view field, std::string_view file_name) {
  auto input = input_for(field, file_name);
  if (!input || !has_room_for(*input)) return false;
  inputs_.push_back(std::move(*input));
  return open_file(input_folder_ / inputs_.back().name);
}

bool UploadReceiver::open_file(const std::filesystem::path& path) {
  file_ = FileHandle(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!file_) return refuse({0, file_error(path.string(), errno)});
  digest_.begin();
  return true;
}

bool UploadReceiver::take_option_bytes(std::string_view bytes) {
  if (options_.size() + bytes.size() > api::kJobOptionsBytesMax)
    return refuse_part(kOptions, "too_large",
                       "options are larger than " + std::to_string(api::kJobOptionsBytesMax) + " bytes", 413);
  options_ += bytes;
  return true;
}

bool UploadReceiver::take(std::string_view bytes) {
  if (refusal_) return false;
  if (in_options_) return take_option_bytes(bytes);
  if (in_archive_) {
    total_bytes_ += static_cast<std::int64_t>(bytes.size());
    if (total_bytes_ > limits_.total_bytes)
      return refuse_part(kArchiveField, "too_large",
                         "the upload is larger than " + std::to_string(limits_.total_bytes) + " bytes", 413);
    return write(bytes);
  }
  if (inputs_.empty()) return refuse({400, {api::Fault::invalid_request, "bytes before the first part"}});
  InputFile& input = inputs_.back();
  input.bytes += static_cast<std::int64_t>(bytes.size());
  total_bytes_ += static_cast<std::int64_t>(bytes.size());
  if (total_bytes_ > limits_.total_bytes)
    return refuse_part(shown_name(input), "too_large",
                       "the upload is larger than " + std::to_string(limits_.total_bytes) + " bytes", 413);
  if (input.role == InputRole::animation && input.bytes > limits_.animation_bytes)
    return refuse_part(shown_name(input), "too_large",
                       "animation is larger than " + std::to_string(limits_.animation_bytes) + " bytes", 413);
  return write(bytes);
}

bool UploadReceiver::write(std::string_view bytes) {
  const auto count = static_cast<std::int64_t>(bytes.size());
  if (const api::Status room = room_.make_sure_of(count); !room) return refuse({0, room.error()});
  if (const api::Status written = write_all(file_, bytes); !written) return refuse({0, written.error()});
  room_.wrote(count);
  digest_.take(bytes);
  return true;
}

std::optional<std::string> UploadReceiver::end_part() {
  const bool is_file = static_cast<bool>(file_);
  if (refusal_ || !close_file()) return std::nullopt;
  return is_file ? last_sha256_ : std::string();
}

// Made durable together with the others, when the upload becomes a job: JobService::submit.
bool UploadReceiver::close_file() {
  if (!file_) return true;
  if (::close(file_.release()) != 0) return refuse({0, file_error("keep an upload", errno)});
  last_sha256_ = digest_.end();
  if (!in_archive_) inputs_.back().sha256 = last_sha256_;
  return true;
}

api::Result<Upload> UploadReceiver::finish() {
  if (!refusal_ && close_file() && has_archive_) (void)unpack();
  for (const std::string_view needed : kReservedNames) {
    const bool here = std::any_of(inputs_.begin(), inputs_.end(),
                                  [&](const InputFile& input) { return input.name == needed; });
    if (!refusal_ && !here)
      refuse_part(needed, "missing",
                  "the part '" + std::string(needed.substr(0, needed.find('.'))) + "' is missing");
  }
  if (!refusal_) (void)keep_names();
  if (refusal_) return refusal_->error;
  finished_ = true;
  room_.release();
  return Upload{id_, inputs_, options_};
}

}  // namespace server
