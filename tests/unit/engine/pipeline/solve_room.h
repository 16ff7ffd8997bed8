// Whole sequences of a small room, for the tests of the stages that light them.
#pragma once

#include <string>

#include "engine/pipeline/solve_sequence.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace tests {

/// Few lines and samples: each solution takes milliseconds.
inline api::LightingOptions quick_options(api::LightingMode mode = api::LightingMode::standard) {
  api::LightingOptions options;
  options.mode = mode;
  options.line_count = 16'000;
  options.moving_line_count = 8'000;
  options.samples_per_light = 8;
  options.estimate_patch_edge_m = 1.5;
  options.estimate_line_count = 8'000;
  return options;
}

/// A solution with its report.
struct Solution {
  engine::SolvedSequence sequence;
  api::JobReport report;

  double count(const std::string& name) const {
    for (const auto& [key, value] : report.counts)
      if (key == name) return value;
    return -1;
  }
  const engine::PatchSeries* series(const std::string& file) const {
    for (const engine::NamedSeries& other : sequence.others)
      if (other.file == file) return &other.values_w_m2;
    return nullptr;
  }
};

inline api::Result<Solution> try_to_solve(const engine::LitScene& lit, const api::LightingOptions& options,
                                          engine::Checkpoints& checkpoints, const engine::RunHooks& hooks) {
  Solution solution;
  engine::StageClock clock(hooks, solution.report);
  auto solved = engine::solve_sequence(lit, options, clock, solution.report, checkpoints);
  if (!solved) return solved.error();
  solution.sequence = std::move(*solved);
  return solution;
}

inline Solution solve(const engine::LitScene& lit, const api::LightingOptions& options) {
  engine::Checkpoints none;
  const engine::RunHooks hooks;
  auto solution = try_to_solve(lit, options, none, hooks);
  EXPECT_TRUE(solution);
  return std::move(*solution);
}

/// The lit room; the lamp goes on in frame 3, so that frames 2 and 3 are a jump that lines see in no group.
struct BlinkingRoom : World {
  static engine::Animation blinking(engine::FrameIndex frames) {
    engine::Animation animation = lit_room_animation(lit_room_scene(false), frames);
    animation.emission.exitance_w_m2 = {{{}}, {}, {{0.5f, 0.2f, 0.4f}}};
    for (engine::FrameIndex f = 0; f < frames; ++f)
      animation.emission.exitance_w_m2[1].push_back(f < 3 ? engine::Rgb{1, 1, 1} : engine::Rgb{10, 8, 5});
    return animation;
  }
  explicit BlinkingRoom(engine::FrameIndex frames) : World(lit_room_scene(false), blinking(frames), 1.0) {}
};

/// The lit room at half a metre, 40 frames in which object 1 goes straight past and nothing else moves.
struct PassingRoom : World {
  static engine::Animation passing() {
    engine::Animation animation = lit_room_animation(lit_room_scene(false), 40);
    animation.objects[1].spans.clear();
    for (engine::FrameIndex f = 0; f < 40; ++f)
      animation.objects[1].spans.push_back({f, f, moved_to(-0.9 + 0.045 * f, -0.6, 1.0)});
    animation.objects[2].spans = {{0, 39, {}}};
    return animation;
  }
  PassingRoom() : World(lit_room_scene(false), passing(), 0.5) {}
};

}  // namespace tests
