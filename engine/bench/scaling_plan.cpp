#include "engine/bench/scaling_plan.h"

#include <unistd.h>

#include <cmath>

#include "engine/bench/bench_text.h"

namespace engine {
namespace {

/// Surface of the garage with its plane and lamps  [m^2].
constexpr double kGarageM2 = 1510;

double edge_for(double patches) {
  return std::sqrt(kGarageM2 / patches);
}

class Planner {
 public:
  explicit Planner(const BenchOptions& options) : options_(options) {}

  ScalingPoint point(const std::string& curve, double size, const GarageSize& garage, double patch_edge_m,
                     unsigned threads = 0) const {
    const bool quick = options_.quick;
    BenchJob job{
        curve + "_" + text_of("%g", size), {}, "animation.json", api::lighting_preset(api::Preset::standard)};
    if (garage.frames != GarageSize{}.frames) job.name += text_of("_%u_frames", garage.frames);
    job.example = job.name;
    job.lighting.mode = api::LightingMode::reference;
    job.lighting.patch_edge_m = patch_edge_m;
    job.lighting.samples_per_light = quick ? 2 : 4;
    job.lighting.line_count = quick ? 200'000 : 2'000'000;
    job.lighting.moving_line_count = quick ? 100'000 : 1'000'000;
    job.lighting.standard_errors = false;
    job.lighting.seed = options_.seed;
    job.images = BenchImages::none;
    job.threads = threads;
    constexpr double kSecondsMax = 600, kQuickSecondsMax = 30, kMemoryShare = 0.8;
    job.limits.seconds = quick ? kQuickSecondsMax : kSecondsMax;
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    job.limits.memory_bytes = static_cast<std::uint64_t>(kMemoryShare * memory);
    return {size, garage, std::move(job)};
  }

  /// Edge of the patches where they are not what is varied.
  double usual_edge_m() const { return options_.quick ? 0.75 : std::sqrt(0.035); }
  bool quick() const { return options_.quick; }

 private:
  const BenchOptions& options_;
};

ScalingCurve over_patches(const Planner& plan) {
  ScalingCurve curve{"patches", "Patches", "patches asked for", {}};
  const std::uint32_t frames = plan.quick() ? 10 : 30;  // so that a million patches are within the limits
  for (const double patches : {2e3, 1e4, 5e4, 2e5, 1e6})
    if (!plan.quick() || patches <= 5e4)
      curve.points.push_back(plan.point("patches", patches, {.frames = frames}, edge_for(patches)));
  if (!plan.quick()) curve.points.push_back(plan.point("patches", 1e6, {}, edge_for(1e6)));
  return curve;
}

ScalingCurve over_frames(const Planner& plan) {
  ScalingCurve curve{"frames", "Frames", "frames", {}};
  for (const std::uint32_t frames : {1u, 30u, 120u, 480u, 2000u})
    if (!plan.quick() || frames <= 480)
      curve.points.push_back(plan.point("frames", frames, {.frames = frames}, plan.usual_edge_m()));
  return curve;
}

ScalingCurve over_moving(const Planner& plan) {
  ScalingCurve curve{"moving", "Moving polygons", "moving polygons asked for", {}};
  for (const std::uint32_t polygons : {80u, 500u, 5'000u, 50'000u})
    if (!plan.quick() || polygons <= 500)
      curve.points.push_back(
          plan.point("moving", polygons, {.moving_polygons = polygons}, plan.usual_edge_m()));
  return curve;
}

ScalingCurve over_threads(const Planner& plan) {
  ScalingCurve curve{"threads", "Threads", "threads", {}};
  for (const unsigned threads : {1u, 2u})
    curve.points.push_back(plan.point("threads", threads, {}, plan.usual_edge_m(), threads));
  return curve;
}

ScalingCurve over_lights(const Planner& plan) {
  ScalingCurve curve{"lights", "Lights", "lights", {}};
  for (const std::uint32_t lamps : {1u, 15u, 200u, 1'000u})
    if (!plan.quick() || lamps <= 200)
      curve.points.push_back(plan.point("lights", lamps, {.lamps = lamps}, plan.usual_edge_m()));
  return curve;
}

}  // namespace

std::vector<ScalingCurve> scaling_plan(const BenchOptions& options) {
  const Planner plan(options);
  return {over_patches(plan), over_frames(plan), over_moving(plan), over_threads(plan), over_lights(plan)};
}

}  // namespace engine
