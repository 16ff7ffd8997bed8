// Points of a patch and of a light, sixteen side by side.
#pragma once

#include "engine/base/sobol.h"
#include "engine/visibility/occluders.h"

namespace engine {

using SampleLanes = std::array<float, RayLanes::kCount>;

/// A parallelogram that points are drawn from with a density that is bilinear over it; or a triangle, that is
/// half of it, with equal densities.
struct Spread {
  Vec3 corner, edge_u, edge_v;
  bool is_triangle = false;
  std::array<float, 4> density{1, 1, 1, 1};  ///< in any unit, > 0, at (0, 0), (1, 0), (0, 1), (1, 1)
};

struct SpreadPoints {
  SampleLanes x, y, z, density;
};

/// Points from two uniform numbers each, dimensions `first` and `first` + 1 of numbers[b], on over[b]. Source
/// of the warp: the marginal and conditional inverse of a bilinear function, as in Pharr, Jakob & Humphreys,
/// Physically Based Rendering, 4th edition, section 2.4.
void spread(const Spread* over, const SobolPoints* numbers, std::size_t first, std::size_t count,
            SpreadPoints* points);

/// Where the rays between two plane things begin and end.
struct RayEnds {
  Vec3 normal_here, normal_there;  ///< unit
  Vec3 off_here, off_there;        ///< how far off their surfaces  [m]
};

/// The rays between points, and what each counts by the side of others:
///
///     w = cos cos / r^2 / (density here * density there)
///
/// cos and r: of the line between the two; 0 from or to behind. sum_s w_s b_s / sum_s w_s is the share of the
/// light that something takes away, b_s in {0, 1} telling whether it blocks ray s.
void join(const RayEnds& ends, const SpreadPoints* here, const SpreadPoints* there, std::size_t count,
          RayLanes* rays, SampleLanes* weights);

/// sums[s] = what of the weights of lanes [first, end) is blocked at rest or in moving[s]. Bits outside of
/// `set` do not count.
void sum_blocked(const std::uint32_t* moving, std::uint32_t at_rest, std::uint32_t set,
                 const SampleLanes& weights, std::size_t first, std::size_t end, std::size_t slots,
                 float* sums);

}  // namespace engine
