// The tables that forecasts are made from. tests/bench/forecast_costs.py compares them with what jobs took,
// and prints by which factor each stage is off: to be run, and the numbers here to be changed, whenever a
// stage does its work another way.
#include <algorithm>
#include <array>

#include "engine/pipeline/forecast.h"
#include "engine/visibility/ray_scene.h"

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

/// Frames that are traced together at most.
double window(const JobSize& n) {
  return std::min(n.frames, static_cast<double>(kWindowMax));
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

constexpr double kRgbBytes = 12;

/// The program itself, its libraries and thread stacks; 100 MB more where EXR or textures are asked for.
constexpr double kProgramBytes = 20e6;

double series_bytes(double patches, double frames) {
  return kRgbBytes * patches * frames;
}

/// What a traced line keeps: its crossings, and the rows that are made of them.
double traced_bytes(const JobSize& size, double lines) {
  return 20 * lines * size.crossings_per_line;
}

/// Held at once while the estimate is made, the sequence solved, or put together and shown.
double estimate_bytes(const JobSize& n) {
  return 17 * series_bytes(n.coarse_patches, n.frames) + traced_bytes(n, n.estimate_lines / 4);
}
/// What moves, at every pose of a window: boxes and tests of facets for lines and, unless there are too many,
/// for shadow rays; and what the lines through it keep.
double moving_bytes(const JobSize& n) {
  constexpr double kListedMax = 8192;
  const double per_facet = n.moving_facets <= kListedMax ? 400 : 200;
  return per_facet * n.moving_facets * window(n) + 24 * local_lines(n, window(n));
}
double solve_bytes(const JobSize& n) {
  return (1 + n.error_series) * series_bytes(n.patches, n.frames) +
         3 * series_bytes(n.patches, n.solved_frames) + traced_bytes(n, n.lines / n.replicates) +
         moving_bytes(n);
}
/// Measured: two more than are counted by name, and of the errors all but what solving them took.
double compose_bytes(const JobSize& n) {
  const double of_errors = std::max(0.0, n.error_series - 2);
  return (4 + n.series + of_errors) * series_bytes(n.patches, n.frames) +
         series_bytes(n.patches, n.solved_frames);
}

}  // namespace

StageSeconds forecast_seconds(const JobSize& size, const MachinePace& pace) {
  StageSeconds seconds{};
  for (const Cost& cost : kCosts)
    seconds[static_cast<std::size_t>(cost.stage)] +=
        cost.seconds(size, pace) / (cost.parallel ? pace.cores : 1);
  return seconds;
}

std::uint64_t forecast_memory_bytes(const JobSize& size) {
  const double always = kProgramBytes + 400 * size.polygons + 1200 * size.facets + 16 * size.patches;
  const double images = size.pixels > 0 ? 8e6 : 0;
  const double most = std::max({estimate_bytes(size), solve_bytes(size), compose_bytes(size) + images});
  return static_cast<std::uint64_t>(always + most);
}

}  // namespace engine
