#include "engine/pipeline/job_fingerprint.h"

#include <unistd.h>

#include <array>

#include "engine/base/sha256.h"
#include "engine/scene/input_files.h"

namespace engine {
namespace {

// To be raised when checkpoints of the same program mean something else: the bytes of the program tell
// nothing of its shared libraries.
constexpr std::string_view kFormat = "keylume checkpoint 1";

/// The file behind /proc/self/exe, which itself is a link.
std::filesystem::path this_program() {
  std::array<char, 4096> path{};
  const ssize_t size = ::readlink("/proc/self/exe", path.data(), path.size());
  return std::string(path.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
}

api::Status add_file(Sha256& hash, const std::string& name, const std::filesystem::path& path) {
  const auto digest = digest_file(path);
  if (!digest) return digest.error();
  // A name holds neither '/' nor a zero byte, so no two lists of files give the same text.
  hash.add(name + '/' + std::to_string(digest->bytes) + '/' + digest->sha256 + '/');
  return api::Done{};
}

}  // namespace

api::Result<std::string> job_fingerprint(const std::filesystem::path& input_folder) {
  Sha256 hash;
  hash.add(kFormat);
  if (auto added = add_file(hash, "program", this_program()); !added) return added.error();
  for (const std::string& name : list_input_files(input_folder).names)
    if (auto added = add_file(hash, name, input_folder / name); !added) return added.error();
  return hash.hex();
}

}  // namespace engine
