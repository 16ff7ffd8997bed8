#include "server/workers/view_files.h"

#include <functional>
#include <system_error>
#include <vector>

namespace server {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

void remove_where(const fs::path& folder, const std::function<bool(const std::string& name)>& is_meant) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (is_meant(at->path().filename().string())) found.push_back(at->path());
  for (const fs::path& path : found) fs::remove_all(path, failed);
}

std::string without(std::string_view name, std::string_view ending) {
  return std::string(name.substr(0, name.size() - ending.size()));
}

}  // namespace

bool is_view_name(std::string_view name) {
  return name.size() == kViewNameBytes && name.find_first_not_of("0123456789abcdef") == name.npos;
}

std::string key_of_view(std::string_view job_id, std::string_view name) {
  return std::string(job_id) + "/views/" + std::string(name);
}

void remove_half_made(const fs::path& job_folder) {
  const fs::path views = job_folder / "views", videos = job_folder / "videos";
  remove_where(views, [&](const std::string& name) {
    return name.starts_with(kUnfinished) || name.ends_with(".report.json") ||
           (name.ends_with(".hashes") && !is_there(views / without(name, ".hashes")));
  });
  // A video without its sum was not finished, a sum without its video not removed.
  remove_where(videos, [&](const std::string& name) {
    const bool is_sum = name.ends_with(".sha256");
    return name.starts_with(kUnfinished) ||
           !is_there(videos / (is_sum ? without(name, ".sha256") : name + ".sha256"));
  });
}

}  // namespace server
