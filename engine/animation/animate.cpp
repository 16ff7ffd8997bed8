#include <algorithm>
#include <limits>

#include "engine/animation/animation.h"
#include "engine/animation/camera_poses.h"
#include "engine/animation/object_motion.h"
#include "engine/animation/series.h"
#include "engine/animation/source_motion.h"
#include "engine/animation/tracks.h"

namespace engine {
namespace {

/// Linear and step tracks stay between their keys; a cubic one can leave the range.
std::vector<Rgb> colours_of(const api::Track<api::Vec3>& track, double most, FrameIndex frame_count) {
  std::vector<Rgb> series;
  series.reserve(frame_count);
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    const api::Vec3 value = value_at(track, frame, api::Vec3{0, 0, 0});
    const auto held = [&](int i) { return static_cast<float>(std::clamp(value[i], 0.0, most)); };
    series.push_back({held(0), held(1), held(2)});
  }
  return once_if_constant(std::move(series));
}

void add_material(const Material& material, const api::SceneDescription& description, Animation& animation) {
  static const api::MaterialSettings kNone;
  const auto entry = description.materials.find(material.name);
  const api::MaterialSettings& settings = entry == description.materials.end() ? kNone : entry->second;
  const api::Track<api::Vec3>& exitance = settings.exitance_w_m2;
  const api::Track<api::Vec3>& reflectance = settings.reflectance;
  constexpr double kAny = std::numeric_limits<float>::max();
  animation.emission.exitance_w_m2.push_back(exitance.given()
                                                 ? colours_of(exitance, kAny, animation.frame_count)
                                                 : std::vector<Rgb>{material.exitance_w_m2});
  animation.reflectance.push_back(
      reflectance.given() ? colours_of(reflectance, double{kReflectanceMax}, animation.frame_count)
                          : std::vector<Rgb>{});
}

}  // namespace

Animation animate(const Scene& scene, const api::JobRequest& request) {
  const api::SceneDescription& description = request.scene;
  Animation animation;
  animation.frame_count = request.frame_count;
  for (const SceneObject& object : scene.objects)
    animation.objects.push_back(motion_of(Placement(description, object.name), request.frame_count));
  for (const Material& material : scene.materials) add_material(material, description, animation);
  for (const auto& [name, light] : description.lights)
    animation.emission.sources.push_back(source_motion_of(name, description, request.frame_count));
  for (const auto& [name, camera] : description.cameras)
    animation.cameras.emplace(
        name, poses_of(camera, description.up, description.metres_per_unit, request.frame_count));
  return animation;
}

}  // namespace engine
