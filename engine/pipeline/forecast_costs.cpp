// The table that forecasts of time are made from. tests/bench/forecast_costs.py compares it with what jobs
// took, and prints by which factor each stage is off: to be run, and the numbers here to be changed, whenever
// a stage does its work another way.
#include <algorithm>
#include <array>

#include "engine/pipeline/forecast.h"

namespace engine {
namespace {

using api::Stage;

/// Seconds of one core, of which all cores take a part each.
struct Cost {
  Stage stage;
  bool parallel;
  double (*seconds)(const JobSize&, const MachinePace&);
};

/// Of the estimate and the solution alike: rows that are gathered, per bounce and frame.
double updates(const JobSize& size, double lines, double frames) {
  return lines * size.crossings_per_line * size.bounces * frames;
}

/// Coarse direct light.
double estimate_direct_s(const JobSize& n, const MachinePace& m) {
  if (n.coarse_patches == 0 || n.frames == 1) return 1e-3;
  return 0.02 + 8 * n.coarse_patches * n.lights * n.light_samples * m.ray_s;
}

/// Its lines, and the gathering of every frame. Once: where noise leaves open which frames are keys, lines
/// are added, up to eight times as many in all; the scenes where that is so cannot be told beforehand.
double estimate_lines_s(const JobSize& n, const MachinePace& m) {
  if (n.coarse_patches == 0 || n.frames == 1) return 1e-3;
  return 5 * n.estimate_lines * m.line_s + 1.6 * updates(n, n.estimate_lines, n.frames) * m.update_s;
}

/// Lines through each patch that moves, in every frame: global ones meet it too rarely.
double local_lines(const JobSize& n, double frames) {
  return 8 * std::max(n.moving_share * n.patches, n.moving_facets) * frames;
}

/// What moves is traced in every frame and solved as a difference in those that are solved, by some eight
/// iterations for each replicate.
double difference_s(const JobSize& n, const MachinePace& m) {
  if (n.moving_share == 0) return 0;
  const double rows = 0.8 * n.moving_lines * n.crossings_per_line + 4 * n.replicates * n.patches;
  return 8 * rows * n.solved_frames * m.update_s + 12 * n.replicates * n.patches * n.frames * m.update_s +
         1.6 * n.moving_lines * m.line_s + n.replicates * local_lines(n, n.frames) * m.line_s;
}

constexpr std::array kCosts{
    Cost{Stage::patches, true, [](auto& n, auto& m) { return (20 * n.facets + 2 * n.patches) * m.update_s; }},
    Cost{Stage::estimate, true, [](auto& n, auto& m) { return estimate_direct_s(n, m); }},
    Cost{Stage::keyframes, true, [](auto& n, auto& m) { return estimate_lines_s(n, m); }},
    Cost{Stage::direct, true,
         [](auto& n, auto& m) {
           const double rays = 0.5 * n.patches * n.lights * n.light_samples;
           return rays * (1 + 0.06 * n.frames) * m.ray_s + 0.6 * n.patches * n.lights * n.frames * m.update_s;
         }},
    // The scene at rest is solved once, whatever the frames.
    Cost{Stage::solve, true,
         [](auto& n, auto& m) {
           // Groups, lines of their own, rows too short for vectors.
           const double of_patches = (1500 + 250 * std::min(n.frames, 24.0)) * n.replicates * n.patches;
           return 0.02 * n.replicates + 0.35 * n.lines * m.line_s + of_patches * m.update_s +
                  27 * n.lines * n.crossings_per_line * m.update_s + difference_s(n, m);
         }},
    Cost{Stage::interpolate, false, [](auto& n, auto& m) { return 12 * n.patches * n.frames * m.update_s; }},
    Cost{Stage::images, true,
         [](auto& n, auto& m) {
           if (n.pixels == 0) return 1e-3;
           return 0.05 + 2 * n.image_samples * m.ray_s + 60 * n.pixels * m.update_s;
         }},
    Cost{Stage::publish, false,
         [](auto& n, auto& m) {
           return 0.015 + (10 * n.patches * n.frames * n.series + 1 * n.pixels) * m.update_s;
         }},
};

}  // namespace

StageSeconds forecast_seconds(const JobSize& size, const MachinePace& pace) {
  StageSeconds seconds{};
  for (const Cost& cost : kCosts)
    seconds[static_cast<std::size_t>(cost.stage)] +=
        cost.seconds(size, pace) / (cost.parallel ? pace.cores : 1);
  return seconds;
}

}  // namespace engine
