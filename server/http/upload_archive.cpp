// An upload whose files come in one archive: they become the same inputs as parts of their own would.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "server/http/upload_receiver.h"

namespace server {
namespace {

constexpr std::string_view kArchive = "archive";
constexpr std::string_view kOptionsFile = "options.json";

struct EntryKind {
  std::string_view ending;  ///< of the name, in lower case
  std::string_view field;   ///< of the part that such a file would be sent as
};
constexpr std::array kEntryKinds{
    EntryKind{".obj", "scene"},    EntryKind{".mtl", "materials"}, EntryKind{"animation.json", "animation"},
    EntryKind{".png", "textures"}, EntryKind{".jpg", "textures"},  EntryKind{".jpeg", "textures"},
};

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

/// None: a file that is no part of a job.
std::string_view field_of(const std::string& base_name) {
  for (const EntryKind& kind : kEntryKinds)
    if (base_name.ends_with(kind.ending) && (kind.ending[0] == '.' || base_name == kind.ending))
      return kind.field;
  return {};
}

bool is_too_large(const api::Error& error) {
  return !error.violations.empty() &&
         (error.violations[0].code == "too_large" || error.violations[0].code == "too_many");
}

}  // namespace

bool UploadReceiver::begin_archive() {
  if (has_archive_) return refuse_part(kArchive, "duplicate_part", "'archive' comes twice");
  has_archive_ = in_archive_ = true;
  return open_file(input_folder_.parent_path() / kArchive);
}

/// A file of the archive begins; which it is, its name tells.
api::Status UploadReceiver::take_entry(const std::string& name) {
  if (!close_file()) return refusal_->error;
  const std::string base = lower_case(std::string_view(name).substr(name.rfind('/') + 1));
  in_options_ = false;
  bool begun = false;
  if (base == kOptionsFile) {
    begun = begin_options();
  } else if (const std::string_view field = field_of(base); !field.empty()) {
    begun = begin_input(field, name);
  } else {
    return archive_refusal(name, "unknown_entry",
                           "is no file of a job: .obj, .mtl, .png, .jpg, animation.json or options.json");
  }
  return begun ? api::Status(api::Done{}) : api::Status(refusal_->error);
}

bool UploadReceiver::unpack() {
  const std::filesystem::path path = input_folder_.parent_path() / kArchive;
  const FileHandle archive(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!archive) return refuse({0, file_error("read " + path.string(), errno)});
  in_archive_ = false;
  total_bytes_ = 0;
  const EntrySink sink{[this](const std::string& name) { return take_entry(name); },
                       [this](std::string_view bytes) -> api::Status {
                         if (!take(bytes)) return refusal_->error;
                         return api::Done{};
                       }};
  const api::Status unpacked = read_archive(archive, limits_.archive, sink);
  in_options_ = false;
  if (!unpacked) return refuse({is_too_large(unpacked.error()) ? 413 : 0, unpacked.error()});
  if (::unlink(path.c_str()) != 0) return refuse({0, file_error("remove " + path.string(), errno)});
  return close_file();
}

}  // namespace server
