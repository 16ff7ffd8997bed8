#include "engine/image/load_codecs.h"

#include <dlfcn.h>

#include <string>
#include <system_error>

namespace engine {
namespace {

constexpr const char* kFile = "keylume-codecs.so";

std::filesystem::path& chosen_file() {
  static std::filesystem::path file;
  return file;
}

std::filesystem::path file_to_open() {
  if (!chosen_file().empty()) return chosen_file();
  std::error_code none;
  return codecs_file(std::filesystem::read_symlink("/proc/self/exe", none).parent_path());
}

api::Error unusable(const std::filesystem::path& file, const std::string& why) {
  // The loader begins most of its reasons with the name.
  const std::string named = file.string() + ": ";
  return {api::Fault::internal,
          "EXR files and textures need " + named + (why.starts_with(named) ? why.substr(named.size()) : why)};
}

}  // namespace

std::filesystem::path codecs_file(const std::filesystem::path& program_folder) {
  const std::filesystem::path built = program_folder / kFile;
  const std::filesystem::path installed = program_folder.parent_path() / "lib/keylume" / kFile;
  std::error_code none;
  return !std::filesystem::exists(built, none) && std::filesystem::exists(installed, none) ? installed
                                                                                           : built;
}

api::Result<const Codecs*> open_codecs(const std::filesystem::path& file) {
  // A path with a slash: never looked for anywhere else. It is not closed again: what it loads starts threads
  // and keeps tables.
  void* const module = dlopen(std::filesystem::absolute(file).c_str(), RTLD_LAZY | RTLD_LOCAL);
  if (module == nullptr) return unusable(file, dlerror());
  const auto function = reinterpret_cast<CodecsFunction>(dlsym(module, kCodecsSymbol));
  if (function == nullptr) return unusable(file, std::string("it does not have ") + kCodecsSymbol);
  const Codecs* const codecs = function();
  if (codecs->version != kCodecsVersion)
    return unusable(file, "it is of version " + std::to_string(codecs->version) + ", not " +
                              std::to_string(kCodecsVersion));
  return codecs;
}

api::Result<const Codecs*> image_codecs() {
  static const api::Result<const Codecs*> loaded = open_codecs(file_to_open());
  return loaded;
}

void use_codecs(const std::filesystem::path& file) {
  chosen_file() = file;
}

}  // namespace engine
