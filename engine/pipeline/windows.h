// Frames that are traced together.
#pragma once

#include <vector>

#include "api/ids.h"
#include "engine/keyframes/check_errors.h"
#include "engine/keyframes/fewest_key_frames.h"

namespace engine {

/// Windows of `traced`, rising. Where they `share_ends` neighbouring windows have a frame in common, which is
/// a key: every frame is traced then, and intervals of key-frames may be split.
std::vector<std::vector<FrameIndex>> windows_of(const std::vector<FrameIndex>& traced, bool share_ends);

/// The key-frames of one window; its ends are keys.
KeyFrames part_in(const KeyFrames& chosen, const std::vector<FrameIndex>& window);

}  // namespace engine
