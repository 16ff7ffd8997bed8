// Radiosity from its parts.
#pragma once

#include <span>
#include <vector>

#include "engine/animation/light_groups.h"
#include "engine/direct/direct_light.h"
#include "engine/lighting/lit_scene.h"
#include "engine/lighting/radiosity.h"

namespace engine {

/// A group of lights and the direct light it gives by itself.
struct LitGroup {
  LightGroup group;
  DirectLight direct;  ///< of the frames that are lit; empty where lines carry everything
};

std::vector<const LitGroup*> pointers_to(const std::vector<LitGroup>& groups);

/// Adds the irradiance from all of `groups`, sum_g scale_g(f) H_g  [W/m^2], [patch][position in `frames`].
/// Their direct light is that of `frames`, or of every frame of the animation; none where lines carry
/// everything.
void add_direct_irradiance(std::span<const LitGroup* const> groups, std::span<const FrameIndex> frames,
                           PatchSeries& sum);

/// B = E + rho max(0, H), in place: H, all the irradiance that arrives, becomes B  [W/m^2]. 0 in frames where
/// the patch's object is not there. Of a patch that something moving covers, H is the difference of two
/// estimates and may come out below 0.
void to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                  std::span<const FrameIndex> frames, PatchSeries& irradiance);

/// The same of the indirect irradiance alone: direct light is added first, where lines do not carry it.
void add_direct_to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                             std::span<const FrameIndex> frames, PatchSeries& indirect);

/// Standard error of B, in place of the variance of the indirect irradiance, per channel:
///
///     s_B = rho sqrt(var X + sum_g scale_g^2 var H_g)                        [W/m^2]
///
/// Direct light as above.
void to_standard_error(const LitScene& lit, std::span<const LitGroup* const> groups,
                       std::span<const FrameIndex> frames, PatchSeries& variance);

/// Adds scale(f) * part to `sum`, [patch][position in `frames`].
void add_scaled(const LightGroup& group, const PatchSeries& part, std::span<const FrameIndex> frames,
                PatchSeries& sum);

/// Area-weighted mean of the largest channel of B over `frames` positions and the patches that never emit:
/// what errors are relative to  [W/m^2].
double mean_radiosity(const LitScene& lit, const PatchSeries& radiosity_w_m2);

/// Is it the front of a material that emits in some frame?
bool ever_emits(const LitScene& lit, PatchId patch);

}  // namespace engine
