// Radiosity without chance: all form factors by integration, the equations by elimination. Shares no code
// with the engine's own solution but the patches themselves, so that nothing is left between the two but the
// engine's chance.
#pragma once

#include <array>
#include <vector>

#include "tests/support/lit.h"

namespace tests {

/// Between all patches of a scene in one frame; rows and columns of patches that are not there are zero.
struct FormFactors {
  std::uint32_t patch_count = 0;
  std::vector<double>
      values;  ///< [receiver][sender]: the share of what leaves the receiver that arrives there

  double at(engine::PatchId from, engine::PatchId to) const {
    return values[std::size_t{from} * patch_count + to];
  }
};

/// F_ij = 1 / A_i  int_{A_i} F_{x -> j} dA(x).  From each point x the visible part of patch j is found by
/// clipping (visible_polygon.h), exactly; its form factor is Lambert's. The integral over the receiver is
/// Gauss-Legendre's of 3 x 3 points in each of `parts` x `parts` parts, the only approximation.
/// Facets must be parallelograms.
FormFactors dense_form_factors(const ReadyScene& ready, engine::FrameIndex frame, unsigned parts);

struct DenseRadiosity {
  std::vector<std::array<double, 3>> radiosity_w_m2;  ///< [patch][channel]
  std::vector<std::array<double, 3>> error_w_m2;      ///< bound on what the quadrature leaves open, the same
};

/// B of B = E + rho F B by Gaussian elimination. Its form factors are those above, but parts of a receiver
/// are quartered until that changes what arrives there (from a first solution) by less than `tolerance` times
/// the mean of it: shadow boundaries get fine parts. What the last quartering changed, taken without signs,
/// is the error of each receiver; solved for as if patches emitted it, it bounds that of B.
DenseRadiosity dense_radiosity(const ReadyScene& ready, engine::FrameIndex frame, double tolerance);

}  // namespace tests
