// Rays against facets. The .cpp files of this folder are the only ones that include Embree.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/patches/patches.h"

namespace engine {

struct Ray {
  Vec3 origin;
  Vec3 direction;     ///< any length > 0
  float near = 0;     ///< in lengths of `direction`, as all distances along the ray; >= 0
  float far = 1e30f;  ///< in lengths of `direction`; > near
};

struct SurfaceHit {
  float distance = 0;  ///< in lengths of the ray's direction
  std::uint32_t facet = 0;
  float u = 0, v = 0;  ///< on the facet, see Facet
  bool front = false;  ///< the ray comes from the facet's front
};

/// A window of at most 128 frames that are traced together; `slot` s is its frame frames[s].
inline constexpr std::size_t kWindowMax = 128;

/// One bit per slot of a window.
struct SlotMask {
  std::array<std::uint64_t, 2> bits{0, 0};
  void set(std::uint32_t first, std::uint32_t last) {
    for (std::uint32_t s = first; s <= last; ++s) bits[s >> 6] |= std::uint64_t{1} << (s & 63);
  }
  bool test(std::uint32_t slot) const { return (bits[slot >> 6] >> (slot & 63)) & 1; }
};

/// A hit on a moving facet, in every slot of [first_slot, last_slot].
struct MovingHit : SurfaceHit {
  std::uint32_t first_slot = 0, last_slot = 0;
};

class LineScene;

/// The facets that never move, in one BVH. All calls are const and may run from many threads.
class StaticRays {
 public:
  StaticRays(const Patches& patches, const Animation& animation);
  ~StaticRays();
  StaticRays(const StaticRays&) = delete;
  StaticRays& operator=(const StaticRays&) = delete;

  /// Every hit on [near, far], sorted by distance, without duplicates from shared edges. Replaces `hits`.
  void all_hits(const Ray& ray, std::vector<SurfaceHit>& hits) const;
  bool occluded(const Ray& ray) const;
  /// The first of all hits; of several at one distance one from its front, and of those the lowest facet.
  /// False where nothing is hit.
  bool nearest(const Ray& ray, SurfaceHit& hit) const;

  /// The same facets for packets of lines, with the patches of a mesh of this scene, which outlives the
  /// answer; its tree is built by the first call. `animation`: what this was made of.
  LineScene line_scene(const Patches& patches, const Animation& animation) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The facets that move, at every pose they take in the slots of one window: in one flat world-space BVH, but
/// of large objects each once, in a BVH of its own space.
class MovingRays {
 public:
  /// Facets of an object that is in the flat BVH: in some hundred poses they are 100,000.
  static constexpr std::size_t kFlatFacetsMax = 1024;

  /// `frames`: 1 .. kWindowMax, increasing.
  MovingRays(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
             std::size_t flat_facets_max = kFlatFacetsMax);
  ~MovingRays();
  MovingRays(const MovingRays&) = delete;
  MovingRays& operator=(const MovingRays&) = delete;

  bool empty() const;
  /// Every hit on [near, far] in every slot, sorted by distance, without duplicates. Replaces `hits`.
  void all_hits(const Ray& ray, std::vector<MovingHit>& hits) const;
  /// The slots in which a moving facet blocks the ray.
  SlotMask blocked(const Ray& ray) const;
  bool occluded(const Ray& ray, std::uint32_t slot) const;
  bool nearest(const Ray& ray, std::uint32_t slot, SurfaceHit& hit) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engine
