// Key-frames as Table 1 of Besuievsky & Pueyo chooses them.
#pragma once

#include <vector>

#include "api/lighting_options.h"
#include "engine/lighting/lit_scene.h"
#include "engine/lighting/radiosity.h"

namespace engine {

enum class LastKey {
  marked,  ///< every frame that differs from the last key-frame becomes one
  lost,    ///< as printed: SetKeyframe(k) runs for the key-frame before, so the last one found is never set
};

/// Scans the frames in order; a frame becomes the next key-frame when some patch differs from what it was in
/// the last key-frame k by more than `epsilon`:
///
///     power       | A_i B_i(k) - A_i B_i(f) |                                                [W]
///     radiosity   | B_i(k) - B_i(f) |                                                        [W/m^2]
///     relative    | B_i(k) - B_i(f) | / max(B_i(k), B_i(f), half the mean B)                 [-]
///
/// B is the largest channel of an RGB radiosity, A the area in object space (a scaled object's patches count
/// as if they were not scaled). The first and the last frame are always keys. Power, as printed, depends on
/// how finely the estimate is cut: the other two do not. It bounds the deviation from a key-frame, not the
/// error of interpolating: a ramp costs many keys, and a jump between f - 1 and f is smeared over the frames
/// since the last key. Source: Besuievsky & Pueyo, "A Monte Carlo Method for Accelerating the Computation of
/// Animated Radiosity Sequences", 2001, Table 1.
std::vector<api::FrameIndex> table1_key_frames(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                                               api::Table1Metric metric, double epsilon, LastKey last_key);

}  // namespace engine
