// Vertex-colour baking by Blender Cycles of one frame of a job's scene.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/bench/bench_scene.h"

namespace engine {

struct CyclesBake {
  int samples = 0;
  std::vector<double> seconds;  ///< of baking one frame, each with another seed
  double rmse = 0;              ///< noise of one of them, over the mean
};

struct CyclesResult {
  std::string version;
  std::uint64_t points = 0;  ///< vertices that were baked
  std::vector<CyclesBake> bakes;
};

/// In PATH.
std::optional<std::filesystem::path> find_blender();

/// Writes the scene into `folder`, runs tests/peers/cycles_bake.py in `blender`, and reads what it says. The
/// patches of parallelograms only, fronts only. Errors: internal with Blender's last words; invalid_request
/// where the scene has triangles.
api::Result<CyclesResult> bake_with_cycles(const std::filesystem::path& blender, const BenchScene& scene,
                                           FrameIndex frame, const std::vector<int>& samples,
                                           const std::filesystem::path& folder);

}  // namespace engine
