// Facets that may stand in a shaft, and the rays in it that they stop: only those are looked at.
#pragma once

#include <vector>

#include "engine/patches/placed_facet.h"
#include "engine/visibility/ray_scene.h"
#include "engine/visibility/shaft.h"

namespace engine {

/// A facet in the slots [first_slot, last_slot] of a window; at rest in none.
struct Occluder {
  std::array<Vec3, 4> corners;  ///< of a triangle the last one twice  [m]
  Vec3 origin, normal;
  Vec3 across_u, across_v;  ///< u = across_u . (p - origin), v likewise  [1/m]
  float sum_max = 2;        ///< of u + v: 1 in a triangle
  std::uint32_t first_slot = 0, last_slot = 0;

  Occluder(const PlacedFacet& placed, bool is_triangle);
};

/// Sixteen rays side by side, each from its origin to origin + direction.
struct RayLanes {
  static constexpr std::size_t kCount = 16;
  std::array<float, kCount> ox, oy, oz, dx, dy, dz;

  void set(std::size_t k, const Ray& ray) {
    ox[k] = ray.origin.x, oy[k] = ray.origin.y, oz[k] = ray.origin.z;
    dx[k] = ray.far * ray.direction.x, dy[k] = ray.far * ray.direction.y, dz[k] = ray.far * ray.direction.z;
  }
};

/// Bit k: ray k crosses the facet. Some 50 operations per ray, all rays at once.
std::uint32_t crossed_by(const Occluder& facet, const RayLanes& rays);

/// What is found in a shaft.
struct ShaftContents {
  std::vector<const Occluder*> at_rest, moving;
  SlotMask crowded;  ///< slots with a moving object of so many facets that they are not listed

  void clear() {
    at_rest.clear();
    moving.clear();
    crowded = {};
  }
  bool moving_empty() const { return moving.empty() && (crowded.bits[0] | crowded.bits[1]) == 0; }
};

/// The facets that never move.
class StaticOccluders {
 public:
  StaticOccluders(const Patches& patches, const Animation& animation);

  /// Adds those that may meet the shaft: no others block a ray in it.
  void collect(const Shaft& shaft, ShaftContents& contents) const;

 private:
  explicit StaticOccluders(const std::vector<Occluder>& facets);

  BoxTree tree_;
  std::vector<Occluder> facets_;   ///< in the order of the tree
  std::vector<FacetLanes> lanes_;  ///< [leaf]
};

/// The facets that move, at every pose they take in the slots of one window.
class MovingOccluders {
 public:
  MovingOccluders(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames);

  /// Adds those that may meet the shaft in some slot of [first_slot, last_slot].
  void collect(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
               ShaftContents& contents) const;

 private:
  /// An object where it is in some slots.
  struct PlacedObject {
    Box box;
    std::uint32_t first_slot = 0, last_slot = 0;
    std::uint32_t first_block = 0, end_block = 0;  ///< of its facets; none where it has too many
  };
  std::vector<Box> place(const Patches& patches, const Animation& animation,
                         std::span<const FrameIndex> frames);
  PlacedObject place(const std::vector<const Facet*>& facets, const PlacedRange& range);
  void collect(const PlacedObject& object, const Shaft& shaft, ShaftContents& contents) const;

  /// Facets of an object beyond which rays go to a tree instead.
  static constexpr std::size_t kFacetsMax = 256;

  std::vector<Occluder> facets_;   ///< sixteen to a block, the last one of an object filled up
  std::vector<FacetLanes> lanes_;  ///< [block]
  std::vector<PlacedObject> objects_;
  std::vector<std::vector<std::uint32_t>> in_slot_;  ///< those that are there
  BoxTree tree_;                                     ///< of objects_
};

}  // namespace engine
