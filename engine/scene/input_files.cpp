#include "engine/scene/input_files.h"

#include <algorithm>
#include <system_error>

#include "engine/scene/names.h"

namespace engine {

InputFiles list_input_files(const std::filesystem::path& folder) {
  InputFiles files{folder, {}};
  std::error_code problem;
  std::filesystem::directory_iterator entry(folder, problem);
  for (const std::filesystem::directory_iterator end; !problem && entry != end; entry.increment(problem)) {
    std::error_code unknown;
    if (std::filesystem::is_regular_file(entry->symlink_status(unknown)))
      files.names.push_back(entry->path().filename().string());
  }
  std::sort(files.names.begin(), files.names.end());
  return files;
}

std::string_view base_name(std::string_view name) {
  const std::size_t slash = name.find_last_of("/\\");
  return slash == name.npos ? name : name.substr(slash + 1);
}

std::optional<std::filesystem::path> find_input_file(const InputFiles& files, std::string_view name) {
  const std::string_view wanted = base_name(name);
  const auto exact = std::find(files.names.begin(), files.names.end(), wanted);
  if (exact != files.names.end()) return files.folder / *exact;
  const auto similar =
      std::find_if(files.names.begin(), files.names.end(),
                   [&](const std::string& candidate) { return equal_but_for_case(candidate, wanted); });
  if (similar != files.names.end()) return files.folder / *similar;
  return std::nullopt;
}

}  // namespace engine
