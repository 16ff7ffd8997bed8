#include "engine/bench/bench_files.h"

#include <cerrno>
#include <fstream>
#include <iterator>

namespace engine {

namespace fs = std::filesystem;

api::Error bench_file_error(const fs::path& path, std::error_code why) {
  return {api::Fault::internal, path.string() + ": " + why.message()};
}

api::Result<std::string> read_bench_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return api::Error{api::Fault::not_found, "cannot read " + path.string()};
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) return api::Error{api::Fault::internal, "cannot read all of " + path.string()};
  return bytes;
}

api::Status write_bench_file(const fs::path& path, std::string_view bytes) {
  std::error_code failed;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), failed);
  if (failed) return bench_file_error(path, failed);
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return api::Error{api::Fault::internal, "cannot write " + path.string()};
  return api::Done{};
}

api::Status copy_geometry(const fs::path& from, const fs::path& into) {
  std::error_code failed;
  if (!fs::is_regular_file(from / "scene.obj", failed))
    return api::Error{api::Fault::not_found,
                      from.string() + " holds no scene.obj; name the examples with --examples"};
  for (const fs::directory_entry& entry : fs::directory_iterator(from, failed)) {
    const auto extension = entry.path().extension();
    if (extension != ".obj" && extension != ".mtl") continue;
    fs::copy_file(entry.path(), into / entry.path().filename(), fs::copy_options::overwrite_existing, failed);
    if (failed) return bench_file_error(entry.path(), failed);
  }
  return failed ? api::Status(bench_file_error(from, failed)) : api::Status(api::Done{});
}

}  // namespace engine
