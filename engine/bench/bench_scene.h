// What the bench must know of a job's scene to judge its radiosity: areas, emitters, probes.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "api/result.h"
#include "engine/animation/animation.h"
#include "engine/bench/sequence_error.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace engine {

struct BenchScene {
  Scene scene;
  Animation animation;
  Patches patches;  ///< as the job cuts them: layout `uniform`
};

/// From the `input_folder` of a job. Errors: those of reading it.
api::Result<BenchScene> load_bench_scene(const std::filesystem::path& input_folder);

PatchWeights patch_weights(const BenchScene& scene);

/// Of the numbers in equation (2) those that are the scene's.
struct SceneNumbers {
  std::size_t static_polygons = 0, moving_polygons = 0;  ///< n_s, n_d
  double box_m2 = 0;     ///< A: surface of the box around everything in all frames
  double motion_m2 = 0;  ///< A_d: surface of the box around all that moves, in all frames
};
SceneNumbers scene_numbers(const BenchScene& scene);

/// The patches that figure 4 follows, in the room: a corner of the top of the red cube, which the plane's
/// shadow crosses, the middle of the front (+y) of the green cube, where it never falls, and the top of the
/// wing.
inline constexpr std::array<const char*, 3> kProbeNames{"top of the red cube", "front of the green cube",
                                                        "top of the wing"};
/// Error invalid_request where the scene is not the room.
api::Result<std::array<PatchId, 3>> find_probes(const BenchScene& scene);

}  // namespace engine
