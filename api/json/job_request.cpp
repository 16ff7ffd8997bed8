#include "api/job_request.h"

#include <algorithm>

#include "api/json/job_sections.h"
#include "api/json/strict_check.h"

namespace api {
namespace {

constexpr std::array kUpAxes{Named<UpAxis>{"y", UpAxis::y}, Named<UpAxis>{"z", UpAxis::z}};
constexpr Range kFps{.lowest = 0, .highest = 1000, .lowest_excluded = true};
constexpr Range kMetresPerUnit{1e-6, 1e6};
constexpr std::size_t kCameraNameBytesMax = 64;

void read_frames(const Node& node, JobRequest& request) {
  // Where the count is wrong, keys are held against the largest there can be: no errors that only follow.
  if (!is_object_of(node, {"count", "fps"})) {
    request.frame_count = kFramesMax;
    return;
  }
  if (const auto count = member(node, "count"))
    request.frame_count = static_cast<std::uint32_t>(whole(*count, 1, kFramesMax).value_or(kFramesMax));
  if (const auto fps = member(node, "fps")) take(number(*fps, kFps), request.fps);
}

/// A camera's name becomes the name of a folder.
bool is_folder_name(const Node& node, std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  if (!name.empty() && name.size() <= kCameraNameBytesMax && std::all_of(name.begin(), name.end(), plain) &&
      name[0] != '.' && name[0] != '-')
    return true;
  add_violation(
      node, "bad_name",
      "must be named with 1 to 64 letters, digits, '_', '-' or '.', the first a letter, digit or '_'");
  return false;
}

bool is_obj_name(const Node& node, std::string_view name) {
  if (!name.empty()) return is_printable(node, name, kNameBytesMax);
  add_violation(node, "bad_name", "must not have an empty name");
  return false;
}

/// Every member of `node` read by `read` into `values`, under its name.
template <class T, class IsName, class Read>
void read_named(const Node& node, std::size_t most, IsName is_name, Read read,
                std::map<std::string, T>& values) {
  if (!is_object_of_at_most(node, most)) return;
  for (const auto& [name, value] : members(node)) {
    is_name(value, name);
    values.emplace(name, read(value));
  }
}

JobRequest read_job(const Node& root) {
  JobRequest request;
  if (!is_object_of(root, {"name", "frames", "metres_per_unit", "up", "allow_dark", "objects", "materials",
                           "cameras", "lighting", "images"}))
    return request;
  if (const auto name = member(root, "name")) take(text(*name, kNameBytesMax), request.name);
  if (const auto frames = member(root, "frames")) read_frames(*frames, request);
  SceneDescription& scene = request.scene;
  if (const auto unit = member(root, "metres_per_unit"))
    take(number(*unit, kMetresPerUnit), scene.metres_per_unit);
  if (const auto up = member(root, "up")) take(one_of(*up, kUpAxes), scene.up);
  if (const auto dark = member(root, "allow_dark")) take(boolean(*dark), scene.allow_dark);

  const auto with_frames = [&](auto read) {
    return [read, count = request.frame_count](const Node& node) { return read(node, count); };
  };
  if (const auto objects = member(root, "objects"))
    read_named(*objects, kObjectsMax, is_obj_name, with_frames(read_object), scene.objects);
  if (const auto materials = member(root, "materials"))
    read_named(*materials, kMaterialsMax, is_obj_name, with_frames(read_material), scene.materials);
  if (const auto cameras = member(root, "cameras"))
    read_named(*cameras, kCamerasMax, is_folder_name, with_frames(read_camera), scene.cameras);

  if (const auto lighting = member(root, "lighting")) request.lighting = read_lighting(*lighting);
  if (const auto images = member(root, "images")) request.images = read_images(*images, scene.cameras);
  return request;
}

}  // namespace

Result<JobRequest> parse_job_request(std::string_view bytes, std::string_view file) {
  Findings findings{std::string(file), {}};
  const auto json = parse_strictly(bytes, file, JsonLimits{}, findings.violations);
  if (!json) return refusal(file, std::move(findings.violations));
  JobRequest request = read_job({&*json, "", &findings});
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return request;
}

}  // namespace api
