#include "engine/pipeline/target_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/pipeline/light_directly.h"

namespace engine {

Noise noise_of(const LitScene& lit, const std::vector<LitGroup>& groups, std::span<const FrameIndex> frames,
               const ReplicateMean& arriving) {
  const auto all = pointers_to(groups);
  PatchSeries radiosity = arriving.mean();
  add_direct_to_radiosity(lit, all, frames, radiosity);
  const double mean = mean_radiosity(lit, radiosity);
  if (!(mean > 0)) return {};
  PatchSeries whole = arriving.variance(), of_lines = whole;
  to_standard_error(lit, all, frames, whole);
  to_standard_error(lit, {}, frames, of_lines);
  return {root_mean_square_error(lit, whole) / mean, root_mean_square_error(lit, of_lines) / mean};
}

std::uint32_t replicates_for(double target, const LinesSpent& before, const LinesSpent& now) {
  const auto square = [](double x) { return x * x; };
  if (now.noise.whole <= target) return now.replicates;
  const double n = now.replicates, n_before = before.replicates, whole = square(now.noise.whole);
  double fixed = whole - square(now.noise.of_lines);
  if (before.replicates > 0)
    fixed = std::max(fixed, (n * whole - n_before * square(before.noise.whole)) / (n - n_before));
  const double left = square(target) - fixed;
  if (left <= 0) return now.replicates;
  const double wanted = std::max(n + 1, std::ceil(1.05 * (whole - fixed) / left * n));
  return static_cast<std::uint32_t>(std::min<double>(wanted, std::numeric_limits<std::int32_t>::max()));
}

}  // namespace engine
