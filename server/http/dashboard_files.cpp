#include "server/http/dashboard_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "server/artefacts/verify.h"

namespace server {
namespace {

namespace fs = std::filesystem;

struct MediaType {
  std::string_view ending;
  std::string_view content_type;
};

constexpr std::array kMediaTypes{
    MediaType{".html", "text/html; charset=utf-8"},
    MediaType{".js", "text/javascript; charset=utf-8"},
    MediaType{".css", "text/css; charset=utf-8"},
    MediaType{".json", "application/json"},
    MediaType{".svg", "image/svg+xml"},
    MediaType{".png", "image/png"},
    MediaType{".jpg", "image/jpeg"},
    MediaType{".obj", "model/obj"},
    MediaType{".mtl", "model/mtl"},
};

api::Error wrong(const fs::path& path, const std::string& what) {
  return {api::Fault::invalid_request, "the dashboard's " + path.string() + " " + what};
}

bool is_plain(std::string_view name) {
  return !name.starts_with('.') && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  });
}

/// Takes the ending of a compressed file off `name`. -> where its bytes belong
std::string DashboardFile::*member_of(std::string& name) {
  for (const auto& [ending, member] : {std::pair{std::string_view(".gz"), &DashboardFile::gzip},
                                       std::pair{std::string_view(".br"), &DashboardFile::brotli}})
    if (name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
      return member;
    }
  return &DashboardFile::bytes;
}

class Reader {
 public:
  explicit Reader(const DashboardLimits& limits) : limits_(limits) {}

  api::Status take(const fs::path& path, const fs::path& below) {
    if (++files_ > limits_.files)
      return wrong(below, "is one file too many: at most " + std::to_string(limits_.files));
    std::string name = below.generic_string();
    std::string DashboardFile::*member = member_of(name);
    const std::string_view type = dashboard_content_type(name);
    if (type.empty() || !is_plain(below.filename().string()))
      return wrong(below, "is not a file that browsers get from here");
    DashboardFile& file = found_[name];
    file.content_type = type;
    std::ifstream in(path, std::ios::binary);
    (file.*member).assign(std::istreambuf_iterator<char>(in), {});
    if (!in) return wrong(below, "cannot be read");
    bytes_ += static_cast<std::int64_t>((file.*member).size());
    if (bytes_ > limits_.bytes)
      return wrong(below, "is too much: at most " + std::to_string(limits_.bytes) + " bytes in all");
    return api::Done{};
  }

  api::Result<DashboardFiles> finish() {
    for (auto& [name, file] : found_) {
      if (file.bytes.empty()) return wrong(name, "is empty, or there only compressed");
      file.sha256 = sha256_of(file.bytes);
    }
    if (!found_.contains("index.html")) return wrong("index.html", "is missing");
    return std::move(found_);
  }

 private:
  const DashboardLimits limits_;
  DashboardFiles found_;
  std::size_t files_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace

std::string_view dashboard_content_type(std::string_view name) {
  for (const MediaType& kind : kMediaTypes)
    if (name.ends_with(kind.ending) && name.size() > kind.ending.size()) return kind.content_type;
  return {};
}

api::Result<DashboardFiles> read_dashboard(const fs::path& folder, const DashboardLimits& limits) {
  std::error_code error;
  fs::recursive_directory_iterator at(folder, error);
  if (error)
    return api::Error{api::Fault::not_found,
                      "the dashboard's folder " + folder.string() + ": " + error.message()};
  Reader reader(limits);
  for (const fs::recursive_directory_iterator end; at != end;) {
    const fs::path below = at->path().lexically_relative(folder);
    // Links are not followed: what is served is what was built, not what it points to.
    const fs::file_status status = at->symlink_status(error);
    if (fs::is_directory(status) && static_cast<std::size_t>(at.depth()) >= limits.folders_within_max)
      return wrong(below, "lies too deep");
    if (!fs::is_directory(status)) {
      if (!fs::is_regular_file(status)) return wrong(below, "is no regular file");
      if (const api::Status taken = reader.take(at->path(), below); !taken) return taken.error();
    }
    at.increment(error);
    if (error) return wrong(below, "cannot be looked behind: " + error.message());
  }
  return reader.finish();
}

}  // namespace server
