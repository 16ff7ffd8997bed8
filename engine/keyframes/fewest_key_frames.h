// The fewest key-frames that keep the interpolation error under a tolerance.
#pragma once

#include <vector>

#include "api/result.h"
#include "engine/base/progress.h"
#include "engine/keyframes/interpolation_error.h"

namespace engine {

/// No interval between two keys is longer: bounds the search, and what one bad estimate can spoil.
inline constexpr std::uint32_t kIntervalMax = 128;

/// Keys 0 = k_0 < ... < k_n = last with the fewest intervals such that every frame between two keys is
/// interpolated within `tolerance`, by dynamic programming over all intervals up to kIntervalMax frames. Of
/// equally few the one with the earliest keys at the end is taken. A sequence that the first and the last
/// frame alone interpolate needs just these.
/// `forced`: frames that are keys in any case (increasing).
/// Error: stopped.
api::Result<std::vector<api::FrameIndex>> fewest_key_frames(InterpolationError& error, double tolerance,
                                                            const std::vector<api::FrameIndex>& forced,
                                                            const Progress& progress);

}  // namespace engine
