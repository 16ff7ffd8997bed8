#include "engine/bench/bench_plan.h"

#include <cmath>

namespace engine {
namespace {

/// Patches of at most .035 m^2, lines and shadow rays of some 2 % noise in the garage.
api::LightingOptions full_resolution(const BenchOptions& options) {
  api::LightingOptions lighting = api::lighting_preset(api::Preset::standard);
  lighting.patch_edge_m = std::sqrt(0.035);
  lighting.line_count = 4'000'000;
  lighting.moving_line_count = 2'000'000;
  lighting.samples_per_light = 4;
  lighting.estimate_patch_edge_m = 2;
  lighting.standard_errors = false;  // [P] has none, and its times none for them
  lighting.seed = options.seed;
  if (options.quick) {
    lighting.patch_edge_m = 0.75;
    lighting.line_count = 200'000;
    lighting.moving_line_count = 100'000;
    lighting.samples_per_light = 2;
    lighting.estimate_line_count = 40'000;
  }
  return lighting;
}

/// The first, the last and two between.
std::vector<api::FrameIndex> frames_of_plan(bool quick) {
  constexpr api::FrameIndex kLast = kBenchFrames - 1;
  return quick ? std::vector<api::FrameIndex>{0, kLast}
               : std::vector<api::FrameIndex>{0, kLast / 3, 2 * kLast / 3, kLast};
}

BenchJob job_of(const BenchGroup& group, const std::string& what, api::LightingMode mode,
                double epsilon = 0) {
  BenchJob job = group.full;
  job.name = group.name + "_" + what;
  job.lighting.mode = mode;
  if (epsilon > 0) job.lighting.epsilon = epsilon;
  return job;
}

BenchGroup group_of(const std::string& name, const std::string& example, const std::string& animation,
                    const api::LightingOptions& lighting, bool quick) {
  BenchGroup group{name, {name, example, animation, lighting}, {}, {}};
  group.full = job_of(group, "full", api::LightingMode::reference);
  group.alone = job_of(group, "alone", api::LightingMode::frame_by_frame);
  group.alone.frames = frames_of_plan(quick);
  return group;
}

void add_run(BenchGroup& group, const std::string& what, api::LightingMode mode, double epsilon = 0) {
  group.runs.push_back(job_of(group, what, mode, epsilon));
}

}  // namespace

std::vector<BenchGroup> bench_plan(const BenchOptions& options) {
  using api::LightingMode;
  const api::LightingOptions lighting = full_resolution(options);
  BenchGroup garage = group_of("garage", "garage", "animation.json", lighting, options.quick);
  add_run(garage, "eps_0.1", LightingMode::paper, 0.1);
  add_run(garage, "eps_0.2", LightingMode::paper, 0.2);
  add_run(garage, "eps_0.4", LightingMode::paper, 0.4);  // one more point for the cost
  add_run(garage, "default", LightingMode::standard);

  BenchGroup off = group_of("garage_off", "garage", "animation_light_off.json", lighting, options.quick);
  add_run(off, "eps_0.1", LightingMode::paper, 0.1);
  add_run(off, "default", LightingMode::standard);

  api::LightingOptions about_50000_patches = lighting;
  if (!options.quick) about_50000_patches.patch_edge_m = 0.144;
  BenchGroup office = group_of("office", "office", "animation.json", about_50000_patches, options.quick);
  add_run(office, "eps_0.05", LightingMode::paper, 0.05);
  add_run(office, "default", LightingMode::standard);

  api::LightingOptions one_lamp = lighting;  // so its penumbras want more shadow rays
  if (!options.quick) one_lamp.samples_per_light = 64;
  BenchGroup room = group_of("room", "room", "animation.json", one_lamp, options.quick);
  add_run(room, "eps_0.1", LightingMode::paper, 0.1);
  add_run(room, "default", LightingMode::standard);
  return {garage, off, room, office};
}

}  // namespace engine
