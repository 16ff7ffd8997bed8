// The fewest key-frames that keep the interpolation error under a tolerance.
#pragma once

#include <functional>
#include <vector>

#include "api/ids.h"
#include "api/result.h"
#include "engine/base/progress.h"

namespace engine {

/// No interval between two keys is longer: bounds the search, what one bad estimate can spoil, and the frames
/// that are traced together.
inline constexpr std::uint32_t kIntervalMax = 127;

/// Every kIntervalMax-th frame between the first and the last: windows of frames that are traced together
/// meet there and have it in common, so it is a key.
std::vector<api::FrameIndex> shared_frames(std::uint32_t frame_count);

/// May the frames between `a` and `b` be interpolated from these two?
using MaySkip = std::function<bool(api::FrameIndex a, api::FrameIndex b)>;

/// Keys 0 = k_0 < ... < k_n = frame_count - 1 with the fewest intervals that may all be skipped, by dynamic
/// programming over all intervals up to kIntervalMax frames. Of equally few the one with the earliest keys at
/// the end is taken. A sequence that the first and the last frame alone interpolate needs just these.
/// `forced`: frames that are keys in any case (increasing).
/// Error: stopped.
api::Result<std::vector<api::FrameIndex>> fewest_key_frames(std::uint32_t frame_count,
                                                            const MaySkip& may_skip,
                                                            const std::vector<api::FrameIndex>& forced,
                                                            const Progress& progress);

/// The same keys where `may_skip` takes long: it is asked only about intervals between keys that were found
/// by `seems_to`, which is quick and true wherever `may_skip` is; until it refuses none of them. `seems_to`
/// may learn from what `may_skip` refused.
api::Result<std::vector<api::FrameIndex>> fewest_key_frames(std::uint32_t frame_count,
                                                            const MaySkip& seems_to, const MaySkip& may_skip,
                                                            const std::vector<api::FrameIndex>& forced,
                                                            const Progress& progress);

}  // namespace engine
