// A coarse and quick look at the lighting of every frame, to choose the key-frames by.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/animation/light_groups.h"
#include "engine/base/progress.h"
#include "engine/lighting/compose.h"
#include "engine/lighting/light_at_rest.h"

namespace engine {

/// Independent sets of lines, to tell light from noise.
inline constexpr std::uint32_t kEstimateReplicates = 8;

/// Lighting of every frame on large patches.
struct Estimate {
  Patches patches;
  std::vector<LitGroup> groups;  ///< as handed in, with their direct light
  PatchSeries radiosity_w_m2;  ///< B, [patch][frame]; 0 where the object is not there; mean of the replicates
  /// What interpolation would be applied to: Y of solve_difference, of each group before its scale,
  /// [group][replicate], [patch][frame]; or, where all light is interpolated, B itself in one group.
  std::vector<std::vector<PatchSeries>> interpolated;
  std::uint64_t line_count = 0;  ///< all replicates together
};

/// Keeps what it needs to sharpen an estimate. Source: Besuievsky & Pueyo, 2001, section 5.
class Estimator {
 public:
  /// Cuts the scene into patches of `options.estimate_patch_edge_m`, and lights them directly. `static_rays`
  /// may be those of finer patches of the same scene: the facets are the same. All arguments outlive it.
  /// Errors: stopped; out_of_resources and invalid_request as mesh_into_patches says.
  static api::Result<Estimator> begin(const Scene& scene, const Animation& animation,
                                      const StaticRays& static_rays, std::span<const LightGroup> groups,
                                      const api::LightingOptions& options, const Progress& progress);

  /// Adds `line_count` lines, an equal part to every replicate, to those it has. Error: stopped.
  api::Status add_lines(std::uint64_t line_count, const Progress& progress);

  const Estimate& estimate() const { return *estimate_; }
  LitScene lit() const { return {*scene_, *animation_, estimate_->patches, *static_rays_}; }

 private:
  Estimator(const Scene& scene, const Animation& animation, const StaticRays& static_rays,
            const api::LightingOptions& options)
      : scene_(&scene), animation_(&animation), static_rays_(&static_rays), options_(&options) {}

  api::Status light_directly(std::span<const LightGroup> groups, const Progress& progress);
  api::Status add_replicate(std::uint32_t replicate, std::uint64_t lines, const Progress& progress);

  const Scene* scene_;
  const Animation* animation_;
  const StaticRays* static_rays_;
  const api::LightingOptions* options_;
  std::unique_ptr<Estimate> estimate_;
  std::vector<PatchSeries> irradiance_;  ///< [replicate]: indirect, all groups with their scale
  PatchSeries direct_;                   ///< all groups with their scale; empty where lines carry everything
  std::uint32_t batches_ = 0;
};

}  // namespace engine
