#include "api/job_request.h"

#include "api/json/job_sections.h"
#include "api/json/names.h"
#include "api/json/parents.h"
#include "api/json/strict_check.h"
#include "api/read_request.h"
#include "api/value_places.h"

namespace api {
namespace {

constexpr std::array kUpAxes{Named<UpAxis>{"y", UpAxis::y}, Named<UpAxis>{"z", UpAxis::z}};
constexpr Range kFps{.lowest = 0, .highest = 1000, .lowest_excluded = true};
constexpr Range kMetresPerUnit{1e-6, 1e6};

void read_frame_range(const Node& node, JobRequest& request) {
  // Where the count is wrong, keys are held against the largest there can be: no errors that only follow.
  if (!is_object_of(node, {"count", "fps"})) {
    request.frame_count = kFramesMax;
    return;
  }
  if (const auto count = member(node, "count"))
    request.frame_count = static_cast<std::uint32_t>(whole(*count, 1, kFramesMax).value_or(kFramesMax));
  if (const auto fps = member(node, "fps")) take(number(*fps, kFps), request.fps);
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

void read_scene_parts(const Node& root, FrameIndex frame_count, SceneDescription& scene) {
  const auto with_frames = [&](auto read) {
    return [read, frame_count](const Node& node) { return read(node, frame_count); };
  };
  if (const auto objects = member(root, "objects")) {
    read_named(*objects, kObjectsMax, is_obj_name, with_frames(read_object), scene.objects);
    check_parents(*objects, scene.objects);
  }
  if (const auto materials = member(root, "materials"))
    read_named(*materials, kMaterialsMax, is_obj_name, with_frames(read_material), scene.materials);
  if (const auto lights = member(root, "lights")) {
    read_named(*lights, kLightsMax, is_obj_name, with_frames(read_light), scene.lights);
    check_parents(*lights, scene.lights, scene.objects);
  }
  if (const auto cameras = member(root, "cameras"))
    read_named(*cameras, kCamerasMax, is_folder_name, with_frames(read_camera), scene.cameras);
}

/// Lights without a surface are points to global lines: none ever meets one.
void check_lines_carry(const Node& lighting, const LightingOptions& options, const SceneDescription& scene) {
  if (options.direct == DirectLight::pure && !scene.lights.empty())
    add_violation(lighting, "lines", "conflict",
                  "cannot be \"pure\" beside \"lights\": no line leaves a light without a surface");
}

JobRequest read_job(const Node& root) {
  JobRequest request;
  if (!is_object_of(root, {"name", "frames", "metres_per_unit", "up", "allow_dark", "objects", "materials",
                           "lights", "cameras", "lighting", "images"}))
    return request;
  if (const auto name = member(root, "name")) take(text(*name, kNameBytesMax), request.name);
  if (const auto frames = member(root, "frames")) read_frame_range(*frames, request);
  SceneDescription& scene = request.scene;
  if (const auto unit = member(root, "metres_per_unit"))
    take(number(*unit, kMetresPerUnit), scene.metres_per_unit);
  if (const auto up = member(root, "up")) take(one_of(*up, kUpAxes), scene.up);
  if (const auto dark = member(root, "allow_dark")) take(boolean(*dark), scene.allow_dark);

  read_scene_parts(root, request.frame_count, scene);
  if (const auto lighting = member(root, "lighting")) {
    request.lighting = read_lighting(*lighting);
    check_lines_carry(*lighting, request.lighting, scene);
  }
  if (const auto images = member(root, "images")) request.images = read_images(*images, scene.cameras);
  return request;
}

}  // namespace

ReadRequest read_request(std::string_view bytes, std::string_view file) {
  Findings findings{std::string(file), {}};
  ReadRequest read;
  if (const auto json = parse_strictly(bytes, file, JsonLimits{}, findings.violations)) {
    read.is_document = true;
    read.request = read_job({&*json, "", &findings});
  }
  read.violations = std::move(findings.violations);
  if (read.is_document) add_places(bytes, file, read.violations);
  return read;
}

Result<JobRequest> parse_job_request(std::string_view bytes, std::string_view file) {
  ReadRequest read = read_request(bytes, file);
  if (!read.violations.empty()) return refusal(file, std::move(read.violations));
  return std::move(read.request);
}

}  // namespace api
