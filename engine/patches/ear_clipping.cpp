#include "engine/patches/ear_clipping.h"

#include <numeric>

namespace engine {
namespace {

/// Twice the signed area of a, b, c seen along `normal`.
float turn(Vec3 a, Vec3 b, Vec3 c, Vec3 normal) {
  return dot(cross(b - a, c - a), normal);
}

bool inside(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 normal) {
  return turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0;
}

/// Is the corner at position k of `ring` convex, with no other corner inside its triangle?
bool is_ear(std::span<const Vec3> corners, const std::vector<std::uint32_t>& ring, std::size_t k,
            Vec3 normal) {
  const std::size_t n = ring.size();
  const Vec3 a = corners[ring[(k + n - 1) % n]], b = corners[ring[k]], c = corners[ring[(k + 1) % n]];
  if (turn(a, b, c, normal) <= 0) return false;
  for (std::size_t other = 0; other < n; ++other) {
    const Vec3 p = corners[ring[other]];
    if (p == a || p == b || p == c) continue;
    if (inside(p, a, b, c, normal)) return false;
  }
  return true;
}

}  // namespace

Vec3 area_vector(std::span<const Vec3> corners) {
  Vec3 sum;
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum = sum + cross(corners[i - 1] - corners[0], corners[i] - corners[0]);
  return 0.5f * sum;
}

std::span<const std::array<std::uint32_t, 3>> EarClipping::clip(std::span<const Vec3> corners) {
  const Vec3 normal = area_vector(corners);
  ring_.resize(corners.size());
  std::iota(ring_.begin(), ring_.end(), 0u);
  triangles_.clear();
  while (ring_.size() > 3) {
    std::size_t ear = 1;
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      const std::size_t tried = (k + 1) % ring_.size();  // corner 1 first: a convex polygon becomes a fan
      if (is_ear(corners, ring_, tried, normal)) {
        ear = tried;
        break;
      }
    }
    const std::size_t n = ring_.size();
    triangles_.push_back({ring_[(ear + n - 1) % n], ring_[ear], ring_[(ear + 1) % n]});
    ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  triangles_.push_back({ring_[0], ring_[1], ring_[2]});
  return triangles_;
}

std::vector<std::array<std::uint32_t, 3>> clip_ears(std::span<const Vec3> corners) {
  EarClipping ears;
  const auto triangles = ears.clip(corners);
  return {triangles.begin(), triangles.end()};
}

}  // namespace engine
