// A row added to another.
#pragma once

#include <cstddef>

namespace engine {

/// to[k] += factor * from[k], k in [0, width).
void add_scaled(float* to, const float* from, float factor, std::size_t width);

}  // namespace engine
