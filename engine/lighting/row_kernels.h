// The inner loops of the gather: sums of rows of frames. Internal to engine/lighting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/lines/trace_lines.h"

namespace engine {

/// sum[k] += count * rows[sender * width + k] for every exchange, k in [0, width).
/// Layout: a row is the slots of one patch side by side, three channels each. Cost: one read of `width`
/// floats per exchange, from memory that is rarely in cache.
void add_rows(float* sum, const float* rows, std::size_t width, std::span<const Exchange> exchanges);

/// to[k] += factor * from[k], k in [0, width).
void add_scaled(float* to, const float* from, float factor, std::size_t width);

}  // namespace engine
