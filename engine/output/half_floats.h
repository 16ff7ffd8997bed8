// Half floats (IEEE 754 binary16), for those to whom radiosity is sent.
#pragma once

#include <cstddef>
#include <cstdint>

namespace engine {

inline constexpr float kHalfMax = 65504;

/// out[k] = factor x values[k], rounded to the nearest half float, of two equally near to the even one; what
/// is larger than kHalfMax becomes that. `values` are finite. The same bits on every machine: integers and
/// sums, which compilers make vectors of; that is as fast as memory, so the processor's own instruction
/// (F16C) is not asked for.
void to_half_floats(const float* values, std::size_t count, float factor, std::uint16_t* out);

}  // namespace engine
