// Closed convex things among facets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/patches/patches.h"

namespace engine {

inline constexpr std::uint32_t kNoSolid = 0xffffffffu;

/// For every facet the number of the convex solid that it bounds, from 0 on, or kNoSolid. A solid is made of
/// facets of one object that share their corners, bit for bit; every edge of it is met by two of them that
/// turn opposite ways, no corner is in front of any, and they are at most 64. A ray that ends outside of it
/// and enters it also leaves it: who asks only whether it is blocked need not look where it enters.
std::vector<std::uint32_t> find_convex_solids(std::span<const Facet> facets);

}  // namespace engine
