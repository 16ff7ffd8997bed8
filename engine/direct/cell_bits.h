// Some cells of a tile as bits.
#pragma once

#include <bit>
#include <cstdint>

namespace engine {

/// Calls use(k) for the bits that are set, in order.
template <class Use>
void each_cell(std::uint64_t bits, Use&& use) {
  for (; bits != 0; bits &= bits - 1) use(static_cast<std::uint32_t>(std::countr_zero(bits)));
}

/// Bits [first, end), of which there is one at least.
inline std::uint64_t run_of(std::uint32_t first, std::uint32_t end) {
  return (~std::uint64_t{0} >> (64 - (end - first))) << first;
}

}  // namespace engine
