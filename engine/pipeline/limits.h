// What one job may ask of a machine.
#pragma once

#include "api/result.h"
#include "engine/patches/patches.h"

namespace engine {

/// Of the radiosity of all patches in all frames; a run holds about three such series.  [bytes]
inline constexpr std::uint64_t kRadiosityBytesMax = std::uint64_t{3} << 30;

/// Error out_of_resources where `patches` in `frame_count` frames are more than a run can hold.
api::Status check_size(const Patches& patches, std::uint32_t frame_count);

}  // namespace engine
