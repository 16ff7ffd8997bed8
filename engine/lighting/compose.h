// Radiosity from its parts.
#pragma once

#include <span>

#include "engine/lighting/light_sequence.h"

namespace engine {

/// B = E + rho (H_direct + H_indirect), [patch][position in `frames`]  [W/m^2]; 0 in frames where the patch's
/// object is not there. `direct` may be null: then H_indirect is all that arrives.
PatchSeries compose_radiosity(const LitScene& lit, std::span<const FrameIndex> frames,
                              const PatchSeries* direct, const PatchSeries& indirect);

/// Turns irradiance into what of it is reflected, in place; 0 in frames where the object is not there.
void reflect(const LitScene& lit, std::span<const FrameIndex> frames, PatchSeries& irradiance);

}  // namespace engine
