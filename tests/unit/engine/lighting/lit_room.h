// The moving room, lit, for the tests of the solvers.
#pragma once

#include "engine/lighting/light_at_rest.h"
#include "engine/lighting/solve_difference.h"
#include "tests/unit/engine/moving_room.h"
#include "tests/unit/engine/one_frame.h"

namespace tests {

/// A lamp of 0.8 x 0.6 m under the ceiling (material 1), the walls grey (0), object 1 coloured (2).
inline engine::Scene lit_room_scene(bool both_sides) {
  engine::Scene scene = room_with_things(both_sides);
  scene.materials.push_back({"lamp", {0.1f, 0.1f, 0.1f}, {}, false});
  scene.materials.push_back({"coloured", {0.7f, 0.3f, 0.1f}, {}, both_sides});
  for (engine::Polygon& polygon : scene.polygons)
    if (polygon.object == 1) polygon.material = 2;
  add_polygon(scene, {{-0.4f, -0.3f, 1.9f}, {-0.4f, 0.3f, 1.9f}, {0.4f, 0.3f, 1.9f}, {0.4f, -0.3f, 1.9f}}, 0,
              1);
  return scene;
}

inline engine::Animation lit_room_animation(const engine::Scene& scene, engine::FrameIndex frames) {
  engine::Animation animation = things_move(scene, frames);
  animation.emission.exitance_w_m2 = {{{}}, {{10, 8, 5}}, {{}}};
  return animation;
}

/// About 100 patches at 1 m.
struct LitRoom : World {
  explicit LitRoom(engine::FrameIndex frames, double patch_edge_m = 1.0, bool both_sides = false)
      : World(lit_room_scene(both_sides), lit_room_animation(lit_room_scene(both_sides), frames),
              patch_edge_m) {}
};

inline engine::Columns columns_of(std::vector<std::uint32_t> slots, std::uint32_t slot_count) {
  return {std::move(slots), slot_count};
}

inline engine::TracedLines trace(const World& world, const std::vector<engine::FrameIndex>& frames,
                                 const engine::LineOptions& options) {
  auto traced = engine::trace_lines(world.patches, world.animation, world.static_rays, frames, options, {});
  EXPECT_TRUE(traced);
  return std::move(*traced);
}

/// The scene at rest and all of its frames as one window, each with lines of its own.
struct SolvedRoom {
  const World& world;
  engine::GroupSource source;
  std::vector<engine::FrameIndex> frames;
  engine::TracedLines lines;
  engine::SolveCounts counts;
  engine::RestLight rest;
  engine::RestTransport transport;

  SolvedRoom(const World& room, engine::GroupSource from, const engine::LineOptions& rest_lines,
             const engine::LineOptions& window_lines)
      : world(room),
        source(from),
        frames(room.all_frames()),
        lines(trace(room, frames, window_lines)),
        transport(room.lit(), lines) {
    auto lights = engine::light_at_rest(room.lit(), std::span(&source, 1), rest_lines, counts, {});
    EXPECT_TRUE(lights);
    rest = std::move((*lights)[0]);
  }
  SolvedRoom(const SolvedRoom&) = delete;

  engine::LitScene lit = world.lit();
  engine::WindowScene window() const { return {lit, frames, lines, transport, rest, source}; }
  engine::DifferenceLight solve(const engine::Columns& columns) const {
    auto light = engine::solve_difference(window(), columns, {});
    EXPECT_TRUE(light);
    return std::move(*light);
  }
  engine::DifferenceLight solve() const { return solve(engine::Columns::every(lines.slot_count)); }
  /// X = X_s + D
  engine::Rgb irradiance(const engine::DifferenceLight& light, engine::PatchId patch,
                         std::uint32_t column) const {
    return rest.irradiance_w_m2[patch] + light.irradiance_w_m2.at(patch, column);
  }
};

}  // namespace tests
