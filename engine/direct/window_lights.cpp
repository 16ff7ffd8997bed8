#include "engine/direct/window_lights.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// Facets have the lower half of the stream numbers.
constexpr std::uint32_t kSourceStreams = 0x80000000u;

LightBall ball_of(const PlacedLight& light) {
  const auto polygon = light.polygon();
  LightBall ball;
  for (const Vec3 corner : polygon)
    ball.middle = ball.middle + (1.0f / static_cast<float>(polygon.size())) * corner;
  for (const Vec3 corner : polygon) ball.radius_m = std::max(ball.radius_m, length(corner - ball.middle));
  ball.normal = light.placed.normal;
  ball.area_m2 = length(cross(light.placed.edge_u, light.placed.edge_v)) * (light.is_triangle ? 0.5f : 1.0f);
  return ball;
}

LightPose facet_pose(const Facet& facet, const Pose& pose, Slots slots) {
  const PlacedFacet placed = place(facet, pose);
  LightPose at;
  at.slots = slots;
  at.roughness = roughness_of(placed, facet.is_triangle);
  at.facet = place_light(facet, placed);
  at.ball = ball_of(at.facet);
  return at;
}

LightPose source_pose(const SourceMotion& source, FrameIndex frame, Slots slots) {
  LightPose at;
  at.slots = slots;
  at.source = &source;
  at.position = source.type == api::LightType::directional ? Vec3{} : in_frame(source.position, frame);
  at.direction = source.type == api::LightType::point ? Vec3{} : in_frame(source.direction, frame);
  at.ball.middle = at.position;
  const Vec3 p = at.position;
  at.roughness.largest_coordinate_m = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return at;
}

bool is_same_place(const LightPose& a, const LightPose& b) {
  return a.position == b.position && a.direction == b.direction;
}

class Placing {
 public:
  Placing(const Patches& patches, const Animation& animation, const Emission& emission,
          std::span<const FrameIndex> frames)
      : patches_(patches), animation_(animation), emission_(emission), frames_(frames) {
    placed_.brightness = brightness_table(patches, emission, frames);
  }

  WindowLights place_all() && {
    const std::vector<Light> facets = find_lights(patches_, emission_);
    for (const bool rest : {true, false}) {
      for (const Light& light : facets)
        if (rest == motion_of(light).is_static(animation_.frame_count)) add_facet(light.facet, rest);
      for (std::uint32_t s = 0; s < emission_.sources.size(); ++s)
        if (rest == emission_.sources[s].is_static()) add_source(s, rest);
      if (rest) placed_.static_count = placed_.lights.size();
    }
    group_all();
    return std::move(placed_);
  }

 private:
  void group_all() {
    for (std::uint32_t b = 0; b < placed_.brightness.of.size(); ++b) {
      LightGroup group{{}, true};
      for (std::uint32_t l = 0; l < placed_.static_count; ++l)
        if (placed_.lights[l].brightness == b) group.members.push_back({l, 0});
      if (!group.members.empty()) placed_.groups.push_back(std::move(group));
    }
    for (auto l = static_cast<std::uint32_t>(placed_.static_count); l < placed_.lights.size(); ++l)
      for (std::uint32_t p = 0; p < placed_.lights[l].poses.size(); ++p)
        placed_.groups.push_back({{{l, p}}, false});
  }

  const ObjectMotion& motion_of(const Light& light) const {
    return animation_.objects[patches_.facets[light.facet].object];
  }
  Slots all_slots() const { return {0, static_cast<std::uint32_t>(frames_.size())}; }

  void add_facet(std::uint32_t number, bool rests) {
    const Facet& facet = patches_.facets[number];
    WindowLight light{number, number, facet.material, rests, {}};
    const ObjectMotion& motion = animation_.objects[facet.object];
    if (rests) {
      light.poses.push_back(facet_pose(facet, motion.spans[0].pose, all_slots()));
    } else {
      const SlotMask& lit = placed_.brightness.of[facet.material].lit;
      for (const PlacedRange& range : placed_ranges(motion, frames_)) {
        const Slots slots = narrow_to_lit(lit, {range.first_slot, range.last_slot + 1});
        if (!slots.empty()) light.poses.push_back(facet_pose(facet, *range.pose, slots));
      }
    }
    if (!light.poses.empty()) placed_.lights.push_back(std::move(light));
  }

  void add_source(std::uint32_t number, bool rests) {
    const SourceMotion& source = emission_.sources[number];
    const auto brightness = static_cast<std::uint32_t>(emission_.exitance_w_m2.size() + number);
    if (!(placed_.brightness.of[brightness].peak > 0)) return;
    WindowLight light{kNoFacet, kSourceStreams | number, brightness, rests, {}};
    if (rests)
      light.poses.push_back(source_pose(source, 0, all_slots()));
    else
      add_moving_poses(source, placed_.brightness.of[brightness].lit, light.poses);
    if (!light.poses.empty()) placed_.lights.push_back(std::move(light));
  }

  void add_moving_poses(const SourceMotion& source, const SlotMask& lit, std::vector<LightPose>& poses) {
    for (std::uint32_t slot = 0; slot < frames_.size(); ++slot) {
      if (!lit.test(slot)) continue;
      const LightPose at = source_pose(source, frames_[slot], {slot, slot + 1});
      if (!poses.empty() && poses.back().slots.end == slot && is_same_place(poses.back(), at))
        poses.back().slots.end = slot + 1;
      else
        poses.push_back(at);
    }
  }

  const Patches& patches_;
  const Animation& animation_;
  const Emission& emission_;
  const std::span<const FrameIndex> frames_;
  WindowLights placed_;
};

}  // namespace

Slots narrow_to_lit(const SlotMask& lit, Slots slots) {
  while (!slots.empty() && !lit.test(slots.begin)) ++slots.begin;
  while (!slots.empty() && !lit.test(slots.end - 1)) --slots.end;
  return slots;
}

WindowLights place_window_lights(const Patches& patches, const Animation& animation, const Emission& emission,
                                 std::span<const FrameIndex> frames) {
  return Placing(patches, animation, emission, frames).place_all();
}

}  // namespace engine
