// Views.
#include "api/json/job_sections.h"
#include "api/json/json_text.h"
#include "api/nearest_name.h"
#include "api/value_places.h"
#include "api/view_request.h"

namespace api {
namespace {

/// None given: all of them.
std::vector<FrameIndex> frames_of_view(const std::optional<Node>& node, std::uint32_t frame_count) {
  std::vector<FrameIndex> frames;
  if (!node) {
    for (FrameIndex frame = 0; frame < frame_count; ++frame) frames.push_back(frame);
    return frames;
  }
  if (!is_array_of(*node, 1, frame_count)) return frames;
  for (std::size_t i = 0; i < node->json->size(); ++i) {
    const Node entry = element(*node, i);
    const auto frame = whole(entry, 0, frame_count - 1, "the job has no more frames");
    if (!frame) continue;
    if (!frames.empty() && *frame <= frames.back())
      add_violation(entry, "not_increasing", "must be greater than the frame before it");
    frames.push_back(static_cast<FrameIndex>(*frame));
  }
  return frames;
}

void read_camera_of(const Node& node, const ViewedJob& job, ViewRequest& view) {
  if (node.json->is_object())
    view.own_camera = read_camera(node, job.frame_count);
  else
    read_camera_name(node, job.cameras, view.image);
}

void read_light_gains(const Node& node, const ViewedJob& job, ViewRequest& view) {
  if (!is_object_of_at_most(node, kLightGroupsMax + 1)) return;
  const std::vector<std::string_view> known(job.light_groups.begin(), job.light_groups.end());
  for (const auto& [name, value] : members(node)) {
    if (!job.light_groups.contains(name)) {
      add_violation(value, "unknown_light_group",
                    known.empty() ? "the job has not kept the light of any group apart"
                                  : "is not a light group of this job" + suggestion(name, known));
    } else if (const auto gain = number_or_vec3(value, {0, kLightGainMax})) {
      view.light_gains.emplace(name, *gain);
    }
  }
}

/// Three numbers each, so that 2 and [2, 2, 2] are the same view, and 1 is no gain at all.
ParsedJson gains_json(const ViewRequest& view) {
  ParsedJson json = ParsedJson::object();
  for (const auto& [name, gain] : view.light_gains)
    if (gain != Vec3{1, 1, 1}) json[name] = gain;
  return json;
}

void check_size(const Node& root, const ViewRequest& view) {
  const double pixels = static_cast<double>(view.image.width) * view.image.height;
  if (pixels * static_cast<double>(view.frames.size()) > kViewPixelsMax)
    add_violation(root, "limit_exceeded", "all frames together have more than 2.1e9 pixels");
}

std::string canonical(const ParsedJson& camera, const ViewRequest& view) {
  const ImageOptions& image = view.image;
  ParsedJson formats = ParsedJson::array();
  if (image.exr) formats.push_back("exr");
  if (image.jpg) formats.push_back("jpg");
  if (image.png) formats.push_back("png");
  // ParsedJson keeps its members by name.
  ParsedJson json{
      {"camera", camera},
      {"frames", view.frames},
      {"width", image.width},
      {"height", image.height},
      {"formats", formats},
      {"exposure_stops", image.auto_exposure ? ParsedJson("auto") : ParsedJson(image.exposure_stops)},
      {"tone_map", image.tone_map == ToneMap::clip ? "clip" : "filmic"},
      {"samples_per_pixel", image.samples_per_pixel}};
  if (ParsedJson gains = gains_json(view); !gains.empty()) json["light_gains"] = std::move(gains);
  return json.dump();
}

}  // namespace

ViewedJob viewed_job(const JobRequest& job) {
  ViewedJob viewed{job.frame_count, job.scene.cameras};
  if (job.lighting.light_groups.empty() || job.lighting.mode == LightingMode::frame_by_frame) return viewed;
  for (const auto& [name, lights] : job.lighting.light_groups) viewed.light_groups.insert(name);
  viewed.light_groups.insert("other");
  return viewed;
}

Result<ViewRequest> parse_view_request(std::string_view bytes, const ViewedJob& job, std::string_view file) {
  JsonLimits limits;
  limits.bytes = kViewBytesMax;
  limits.values = 100'000;
  const auto document = parse_json(bytes, file, limits);
  if (!document) return document.error();
  Findings findings{std::string(file), {}};
  const Node root{&*document, "", &findings};
  ViewRequest view;
  if (is_object_of(root, {"camera", "frames", "width", "height", "formats", "exposure_stops", "tone_map",
                          "samples_per_pixel", "light_gains"})) {
    const auto camera = required(root, "camera");
    if (camera) read_camera_of(*camera, job, view);
    read_image_fields(root, view.image);
    view.frames = frames_of_view(member(root, "frames"), job.frame_count);
    if (const auto gains = member(root, "light_gains")) read_light_gains(*gains, job, view);
    check_size(root, view);
    if (camera && findings.violations.empty()) view.canonical_json = canonical(*camera->json, view);
  }
  add_places(bytes, file, findings.violations);
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return view;
}

}  // namespace api
