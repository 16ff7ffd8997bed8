// The inner loops of the gather: sums of rows of frames. Internal to engine/lighting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/patches/patches.h"

namespace engine {

/// sum[k] += rows[sender * width + k] for every sender, k in [0, width).
/// Layout: a row is the slots of one patch side by side, three channels each. Cost: one read of `width`
/// floats per sender, from memory that is rarely in cache.
void add_rows(float* sum, const float* rows, std::size_t width, std::span<const PatchId> senders);

/// to[k] += factor * from[k], k in [0, width).
void add_scaled(float* to, const float* from, float factor, std::size_t width);

}  // namespace engine
