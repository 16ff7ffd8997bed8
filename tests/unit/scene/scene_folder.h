// A job's input folder on disk, for tests that load scenes.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "engine/scene/scene.h"

namespace engine {

/// Removed with all that is in it when it goes out of scope.
class SceneFolder {
 public:
  SceneFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "keylume_scene_XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  SceneFolder& with(const std::string& name, std::string_view bytes) {
    std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    return *this;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// "file:line:column code", or "file pointer code" for JSON; one per line, as load_scene lists them.
inline std::string places_of(const api::Error& error) {
  std::ostringstream text;
  for (const api::Violation& v : error.violations) {
    text << v.file;
    if (v.file == "animation.json")
      text << ' ' << v.pointer;
    else
      text << ':' << v.line << ':' << v.column;
    text << ' ' << v.code << '\n';
  }
  return text.str();
}

inline api::SceneDescription dark() {
  api::SceneDescription description;
  description.allow_dark = true;
  return description;
}

/// Loads scene.obj alone, where dark is allowed.
inline api::Result<Scene> load_obj(std::string_view obj, const SceneLimits& limits = {}) {
  SceneFolder folder;
  folder.with("scene.obj", obj);
  return load_scene(folder.path(), dark(), limits);
}

inline std::string places_in_obj(std::string_view obj) {
  const auto scene = load_obj(obj);
  return scene ? "loaded" : places_of(scene.error());
}

/// Four vertices of a unit square; faces of a test begin in line 5.
inline const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

inline bool has_warning(const Scene& scene, std::string_view part) {
  for (const std::string& warning : scene.warnings)
    if (warning.find(part) != warning.npos) return true;
  return false;
}

}  // namespace engine
