// Which jobs `bench scaling` runs: curves, and the points on them.
#pragma once

#include <string>
#include <vector>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_options.h"
#include "engine/bench/generated_scenes.h"

namespace engine {

struct ScalingPoint {
  double size = 0;    ///< what the curve is over: patches asked for, frames, ...
  GarageSize garage;  ///< the scene, generated
  BenchJob job;       ///< its `example` is a folder for that scene
};

struct ScalingCurve {
  std::string name;  ///< one of kScalingParts
  std::string title;
  std::string over;  ///< heading of the sizes
  std::vector<ScalingPoint> points;
};

/// All of them. Mode `reference`, without standard errors and images; time and memory of every job capped.
std::vector<ScalingCurve> scaling_plan(const BenchOptions& options);

}  // namespace engine
