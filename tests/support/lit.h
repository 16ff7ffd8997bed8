// Scenes made ready to be lit, and lit, by the engine's own stages.
#pragma once

#include <string>
#include <vector>

#include "api/job_request.h"
#include "engine/lighting/light_at_rest.h"
#include "tests/support/scenes.h"

namespace tests {

/// A scene cut into patches, with its rays. Neither copied nor moved: `lit` refers to the rest.
struct ReadyScene {
  ReadyScene(engine::Scene a_scene, engine::Animation an_animation, double patch_edge_m);
  ReadyScene(const SceneBuilder& built, double patch_edge_m)
      : ReadyScene(built.scene(), built.animation(), patch_edge_m) {}
  ReadyScene(const ReadyScene&) = delete;
  ReadyScene& operator=(const ReadyScene&) = delete;

  engine::Scene scene;
  engine::Animation animation;
  engine::Patches patches;
  engine::StaticRays static_rays;
  engine::LitScene lit;

  /// Patches of polygon `polygon`, front and back.
  std::vector<engine::PatchId> patches_of_polygon(std::uint32_t polygon) const;
  /// Patches of the materials named `name`.
  std::vector<engine::PatchId> patches_of_material(const std::string& name) const;
  bool moves(engine::PatchId patch) const;
};

/// A job from api/examples: its folder and the JSON in it.
struct Example {
  api::JobRequest request;
  engine::Scene scene;
  engine::Animation animation;
};
Example load_example(const std::string& folder, const std::string& json = "animation.json");

/// All three [patch][position in the frames].
struct LitFrames {
  engine::PatchSeries direct;    ///< irradiance from the lights; empty where lines carry everything  [W/m^2]
  engine::PatchSeries indirect;  ///< what else arrives  [W/m^2]
  engine::PatchSeries radiosity;
  engine::SolveCounts counts;
};

/// Lights `frames` (increasing) without key-frames: direct light (unless `options.direct` is pure), lines,
/// solution. The patches are those of `ready`, whatever `options` says of them.
LitFrames light_frames(const ReadyScene& ready, const std::vector<engine::FrameIndex>& frames,
                       const api::LightingOptions& options);

/// Area-weighted mean over `patches` of one position.
engine::Rgb mean_over(const ReadyScene& ready, const engine::PatchSeries& series,
                      const std::vector<engine::PatchId>& patches, std::uint32_t position);

}  // namespace tests
