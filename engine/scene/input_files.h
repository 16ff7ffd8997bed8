// The files of a job, found by what an OBJ or MTL calls them, and nothing outside the job's folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace engine {

/// The regular files directly in a folder (links are passed over), sorted by name.
struct InputFiles {
  std::filesystem::path folder;
  std::vector<std::string> names;
};
InputFiles list_input_files(const std::filesystem::path& folder);

/// What follows the last '/' or '\'.
std::string_view base_name(std::string_view name);

/// The file whose name is the base name of `name`; without regard to the case of ASCII letters where none has
/// it exactly. "..\textures\Wood.PNG" finds wood.png.
std::optional<std::filesystem::path> find_input_file(const InputFiles& files, std::string_view name);

}  // namespace engine
