// Views.
#include "api/json/job_sections.h"
#include "api/json/json_text.h"
#include "api/view_request.h"

namespace api {
namespace {

/// None given: all of them.
std::vector<FrameIndex> read_frames(const std::optional<Node>& node, std::uint32_t frame_count) {
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
  return json.dump();
}

}  // namespace

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
                          "samples_per_pixel"})) {
    const auto camera = required(root, "camera");
    if (camera) read_camera_of(*camera, job, view);
    read_image_fields(root, view.image);
    view.frames = read_frames(member(root, "frames"), job.frame_count);
    check_size(root, view);
    if (camera && findings.violations.empty()) view.canonical_json = canonical(*camera->json, view);
  }
  if (!findings.violations.empty()) return refusal(file, std::move(findings.violations));
  return view;
}

}  // namespace api
