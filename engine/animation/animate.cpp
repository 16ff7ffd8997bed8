#include <algorithm>

#include "engine/animation/animation.h"
#include "engine/animation/camera_poses.h"
#include "engine/animation/object_motion.h"
#include "engine/animation/tracks.h"

namespace engine {
namespace {

/// [frame], or one value where it never changes.
std::vector<Rgb> exitance_of(const Material& material, const api::SceneDescription& description,
                             FrameIndex frame_count) {
  const auto settings = description.materials.find(material.name);
  if (settings == description.materials.end() || !settings->second.exitance_w_m2.given())
    return {material.exitance_w_m2};
  const auto& track = settings->second.exitance_w_m2;
  std::vector<Rgb> series;
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    const api::Vec3 value = value_at(track, frame, api::Vec3{0, 0, 0});
    const auto positive = [&](int i) { return static_cast<float>(std::max(0.0, value[i])); };
    series.push_back({positive(0), positive(1), positive(2)});
  }
  const bool constant = std::all_of(series.begin(), series.end(), [&](Rgb e) { return e == series[0]; });
  if (constant) series.resize(1);
  return series;
}

}  // namespace

Animation animate(const Scene& scene, const api::JobRequest& request) {
  const api::SceneDescription& description = request.scene;
  Animation animation;
  animation.frame_count = request.frame_count;
  for (const SceneObject& object : scene.objects) {
    const auto moved = description.objects.find(object.name);
    static const api::ObjectAnimation kStill;
    animation.objects.push_back(motion_of(moved != description.objects.end() ? moved->second : kStill,
                                          description.metres_per_unit, request.frame_count));
  }
  for (const Material& material : scene.materials)
    animation.emission.exitance_w_m2.push_back(exitance_of(material, description, request.frame_count));
  for (const auto& [name, camera] : description.cameras)
    animation.cameras.emplace(
        name, poses_of(camera, description.up, description.metres_per_unit, request.frame_count));
  return animation;
}

}  // namespace engine
