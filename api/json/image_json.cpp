// Images.
#include <algorithm>
#include <array>

#include "api/json/job_sections.h"
#include "api/json/names.h"
#include "api/json/take_fields.h"
#include "api/nearest_name.h"

namespace api {
namespace {

constexpr std::array kToneMaps{Named<ToneMap>{"filmic", ToneMap::filmic},
                               Named<ToneMap>{"clip", ToneMap::clip}};
constexpr std::array<std::string_view, 3> kFormats{"png", "exr", "jpg"};

constexpr Range kStops{-32, 32};

void read_formats(const Node& node, ImageOptions& image) {
  if (!is_array_of(node, 1, kFormats.size())) return;
  std::array<bool, kFormats.size()> wanted{};
  for (std::size_t i = 0; i < node.json->size(); ++i) {
    const auto format = one_of(element(node, i), kFormats);
    if (!format) continue;
    if (wanted[*format]) add_violation(element(node, i), "duplicate_value", "is given more than once");
    wanted[*format] = true;
  }
  image.png = wanted[0];
  image.exr = wanted[1];
  image.jpg = wanted[2];
}

void read_exposure(const Node& node, ImageOptions& image) {
  constexpr std::array<std::string_view, 1> kAuto{"auto"};
  if (node.json->is_string()) {
    one_of(node, kAuto);
    return;
  }
  const auto stops = number(node, kStops);
  if (!stops) return;
  image.auto_exposure = false;
  image.exposure_stops = *stops;
}

ImageOptions read_image(const Node& node, const std::map<std::string, Camera>& cameras) {
  ImageOptions image;
  if (!is_object_of(
          node, {"camera", "width", "height", "formats", "exposure_stops", "tone_map", "samples_per_pixel"}))
    return image;
  if (const auto camera = required(node, "camera")) read_camera_name(*camera, cameras, image);
  read_image_fields(node, image);
  return image;
}

}  // namespace

void read_image_fields(const Node& node, ImageOptions& image) {
  take_whole(node, "width", 1, 8192, image.width);
  take_whole(node, "height", 1, 8192, image.height);
  if (const auto formats = member(node, "formats")) read_formats(*formats, image);
  if (const auto exposure = member(node, "exposure_stops")) read_exposure(*exposure, image);
  take_named(node, "tone_map", kToneMaps, image.tone_map);
  take_whole(node, "samples_per_pixel", 1, 64, image.samples_per_pixel);
}

void read_camera_name(const Node& node, const std::map<std::string, Camera>& cameras, ImageOptions& image) {
  const auto name = text(node, kAnyNameBytes);
  if (!name) return;
  image.camera = *name;
  if (cameras.contains(*name)) return;
  std::vector<std::string_view> names;
  for (const auto& [known, camera] : cameras) names.push_back(known);
  add_violation(node, "unknown_camera",
                cameras.empty() ? "names a camera, but the job has none"
                                : "is not a camera of this job" + suggestion(*name, names));
}

std::vector<ImageOptions> read_images(const Node& node, const std::map<std::string, Camera>& cameras) {
  std::vector<ImageOptions> images;
  if (!is_array_of(node, 0, kImagesMax)) return images;
  for (std::size_t i = 0; i < node.json->size(); ++i) {
    ImageOptions image = read_image(element(node, i), cameras);
    // Their files would have the same names.
    const bool again = std::any_of(images.begin(), images.end(), [&](const ImageOptions& before) {
      return !image.camera.empty() && before.camera == image.camera;
    });
    if (again)
      add_violation(element(node, i), "camera", "duplicate_value",
                    "has its images already, in an entry before");
    images.push_back(std::move(image));
  }
  return images;
}

}  // namespace api
