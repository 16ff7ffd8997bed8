#include "engine/pipeline/openness.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/direct/clearance.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// A direction about `normal` with density cos / pi; a, b uniform in [0, 1).
Vec3 cosine_direction(Vec3 normal, float a, float b) {
  const Vec3 aside = std::abs(normal.x) < 0.5f ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 s = normalized(cross(normal, aside)), t = cross(normal, s);
  const float radius = std::sqrt(a), angle = 2 * std::numbers::pi_v<float> * b;
  return radius * std::cos(angle) * s + radius * std::sin(angle) * t + std::sqrt(1 - a) * normal;
}

float openness_of(const Patches& patches, PatchId patch, const Pose& pose, const StaticRays& static_rays,
                  float reach_m, std::uint64_t seed) {
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  const PlacedFacet placed = place(facet, pose);
  const Vec3 normal = patches.is_back(patch) ? -placed.normal : placed.normal;
  if (normal == Vec3{}) return 1;
  const Roughness roughness = roughness_of(placed, facet.is_triangle);
  const Vec3 off = clearance_m(roughness, roughness) * normal;
  const CellCorners cell = cell_corners(facet, patches.cell_of(patch));
  std::uint32_t open = 0;
  for (std::uint32_t k = 0; k < kOpennessRays; ++k) {
    const auto [a, b, c, d] = owen_sobol(k, stream_seed(seed, patch));
    const Ray ray{point_in(placed, cell, a, b) + off, cosine_direction(normal, c, d), 0.0f, reach_m};
    open += static_rays.occluded(ray) ? 0 : 1;
  }
  return static_cast<float>(open) / kOpennessRays;
}

}  // namespace

api::Result<std::vector<float>> openness(const Patches& patches, const Animation& animation,
                                         const StaticRays& static_rays, float reach_m, std::uint64_t seed,
                                         const Progress& progress) {
  std::vector<float> open(patches.count(), 1.0f);
  constexpr std::uint32_t kChunk = 256;
  std::atomic<bool> stopped = false;
  parallel_for((patches.count() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    const auto first = static_cast<PatchId>(chunk * kChunk);
    for (PatchId patch = first; patch < std::min(first + kChunk, patches.count()); ++patch) {
      const ObjectMotion& motion = animation.objects[patches.facets[patches.facet_of[patch]].object];
      if (motion.is_static(animation.frame_count))
        open[patch] = openness_of(patches, patch, motion.spans[0].pose, static_rays, reach_m, seed);
    }
  });
  if (stopped) return api::Error{api::Fault::stopped, "stopped while looking at what is close to patches"};
  return open;
}

}  // namespace engine
