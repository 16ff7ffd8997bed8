#include "engine/direct/shadow_samples.h"

#include <algorithm>
#include <cmath>

#include "engine/base/widest.h"

namespace engine {
namespace {

/// Where in [0, 1) a share `x` of a line that goes from `p` to `q` lies below.
inline float below_line(float x, float p, float q) {
  const float at = x * (p + q) / (p + std::sqrt(p * p + x * (q * q - p * p)));
  return std::min(at, 0.99999994f);
}

}  // namespace

KEYLUME_WIDEST
void spread(const Spread* over, const SobolPoints* numbers, std::size_t first, std::size_t count,
            SpreadPoints* points) {
  for (std::size_t block = 0; block < count; ++block) {
    const auto [d00, d10, d01, d11] = over[block].density;
    const Vec3 o = over[block].corner, eu = over[block].edge_u, ev = over[block].edge_v;
    const float folded = over[block].is_triangle ? 1.0f : 2.0f;
    const SampleLanes &a = numbers[block].of[first], &b = numbers[block].of[first + 1];
    SpreadPoints to;
    for (std::size_t k = 0; k < RayLanes::kCount; ++k) {
      float v = below_line(b[k], d00 + d10, d01 + d11);
      const float left = d00 + v * (d01 - d00), right = d10 + v * (d11 - d10);
      float u = below_line(a[k], left, right);
      to.density[k] = left + u * (right - left);
      const bool beyond = u + v > folded;
      u = beyond ? 1.0f - u : u;
      v = beyond ? 1.0f - v : v;
      to.x[k] = o.x + u * eu.x + v * ev.x;
      to.y[k] = o.y + u * eu.y + v * ev.y;
      to.z[k] = o.z + u * eu.z + v * ev.z;
    }
    points[block] = to;
  }
}

KEYLUME_WIDEST
void join(const RayEnds& ends, const SpreadPoints* from, const SpreadPoints* to, std::size_t count,
          RayLanes* blocks, SampleLanes* weights) {
  const Vec3 n = ends.normal_here, m = ends.normal_there, start = ends.off_here;
  const Vec3 off = ends.off_there - ends.off_here;
  for (std::size_t block = 0; block < count; ++block) {
    const SpreadPoints &here = from[block], &there = to[block];
    RayLanes rays;  // not in place: the compiler would have to ask whether they are the points
    SampleLanes weight;
    for (std::size_t k = 0; k < RayLanes::kCount; ++k) {
      const float x = there.x[k] - here.x[k], y = there.y[k] - here.y[k], z = there.z[k] - here.z[k];
      const float squared = x * x + y * y + z * z;
      const float over_here = std::max(0.0f, n.x * x + n.y * y + n.z * z);
      const float over_there = std::max(0.0f, -(m.x * x + m.y * y + m.z * z));
      weight[k] = over_here * over_there / (squared * squared * (here.density[k] * there.density[k]));
      rays.ox[k] = here.x[k] + start.x;
      rays.oy[k] = here.y[k] + start.y;
      rays.oz[k] = here.z[k] + start.z;
      rays.dx[k] = x + off.x;
      rays.dy[k] = y + off.y;
      rays.dz[k] = z + off.z;
    }
    blocks[block] = rays;
    weights[block] = weight;
  }
}

KEYLUME_WIDEST
void sum_blocked(const std::uint32_t* moving, std::uint32_t at_rest, std::uint32_t set,
                 const SampleLanes& weights, std::size_t first, std::size_t end, std::size_t slots,
                 float* sums) {
  constexpr std::size_t kSlots = 16;  // at a time
  for (std::size_t s = 0; s < slots; s += kSlots) {
    std::array<float, kSlots> sum{};
    std::array<std::uint32_t, kSlots> blocked{};
    const std::size_t count = std::min(kSlots, slots - s);
    for (std::size_t k = 0; k < count; ++k) blocked[k] = (moving[s + k] | at_rest) & set;
    for (std::size_t lane = first; lane < end; ++lane)
      for (std::size_t k = 0; k < kSlots; ++k)
        sum[k] += ((blocked[k] >> lane) & 1) != 0 ? weights[lane] : 0.0f;
    for (std::size_t k = 0; k < count; ++k) sums[s + k] += sum[k];
  }
}

}  // namespace engine
