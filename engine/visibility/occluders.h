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

/// Bit k: ray k crosses the facet. Some 50 operations per ray, all rays at once. Unlike the trees it makes no
/// promise about rays through an edge that two facets share: one in some million slips through (rounding).
std::uint32_t crossed_by(const Occluder& facet, const RayLanes& rays);

/// What is found in a shaft.
struct ShaftContents {
  std::vector<const Occluder*> at_rest, moving;
  bool many_at_rest = false;  ///< too many to be listed: a tree is asked for every ray instead
  SlotMask many_moving;       ///< the slots in which it is so of what moves

  void clear() {
    at_rest.clear();
    moving.clear();
    many_at_rest = false;
    many_moving = {};
  }
  bool none_at_rest() const { return at_rest.empty() && !many_at_rest; }
  bool some_slots_many() const { return (many_moving.bits[0] | many_moving.bits[1]) != 0; }
  bool none_moving() const { return moving.empty() && !some_slots_many(); }
};

/// The facets that never move.
class StaticOccluders {
 public:
  StaticOccluders(const Patches& patches, const Animation& animation);

  /// Lists those that may meet the shaft: no others block a ray in it; or says that they are more than
  /// `most`.
  void collect(const Shaft& shaft, std::size_t most, ShaftContents& contents) const;

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

  /// Lists those that may meet the shaft in some slot of [first_slot, last_slot], or says that there are
  /// many. A shaft of all frames from `one_place` lists them only where few facets move; one that follows
  /// what moves meets few poses. Whether they are listed does not depend on the window.
  void collect(const Shaft& shaft, bool one_place, std::uint32_t first_slot, std::uint32_t last_slot,
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
  PlacedObject place(const std::vector<const Facet*>& facets, const PlacedRange& range, bool listed);
  void list_facets(const PlacedObject& object, const Shaft& shaft, ShaftContents& contents) const;

  /// Facets of an object, and of all that moves in the way of shafts from one place: beyond these trees win.
  /// Of all that moves, for shafts that follow it: bounds the memory, some 200 bytes per facet and pose.
  static constexpr std::size_t kOfObjectMax = 256, kOfAllMax = 64, kFollowedMax = 8192;

  std::size_t moving_facets_ = 0;  ///< of all objects, each once
  std::vector<Occluder> facets_;   ///< sixteen to a block, the last one of an object filled up
  std::vector<FacetLanes> lanes_;  ///< [block]
  std::vector<PlacedObject> objects_;
  std::vector<std::vector<std::uint32_t>> in_slot_;  ///< those that are there
  BoxTree tree_;                                     ///< of objects_
};

}  // namespace engine
