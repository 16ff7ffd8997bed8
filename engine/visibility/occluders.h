// Facets that may stand in a shaft, and the rays in it that they stop: only those are looked at.
#pragma once

#include <vector>

#include "engine/patches/placed_facet.h"
#include "engine/visibility/convex_solids.h"
#include "engine/visibility/ray_scene.h"
#include "engine/visibility/shaft.h"

namespace engine {

/// A facet in the slots [first_slot, last_slot] of a window; at rest in none.
struct Occluder {
  Vec3 origin, normal;
  Vec3 across_u, across_v;  ///< u = across_u . (p - origin), v likewise  [1/m]
  float sum_max = 2;        ///< of u + v: 1 in a triangle
  std::uint32_t first_slot = 0, last_slot = 0;
  std::uint32_t solid = kNoSolid;  ///< that it bounds, into the boxes of whoever lists it
  std::array<Vec3, 4> corners;     ///< of a triangle the last one twice  [m]

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
/// The same of several blocks of rays: crossed[b].
void crossed_by(const Occluder& facet, const RayLanes* rays, std::size_t blocks, std::uint32_t* crossed);

/// Facets packed for the shafts within a shaft: sixteen to a block, the last one filled up with none.
struct OccluderList {
  std::vector<FacetLanes> lanes;
  std::vector<const Occluder*> facets;

  void clear() {
    lanes.clear();
    facets.clear();
  }
  /// Adds lane `k` of `from`, which is `facet`. `of_solid`: of a convex solid that no ray ends in.
  void add(const FacetLanes& from, std::size_t k, const Occluder* facet, bool of_solid);
};

/// What may stand in a shaft, to be sifted by the shafts of its parts.
struct Candidates {
  OccluderList at_rest, moving;
  bool many_at_rest = false;  ///< too many to be listed: they are found anew for every part
  SlotMask many_moving;       ///< the slots in which something moves that is never listed

  void clear();
  bool some_slots_many() const { return (many_moving.bits[0] | many_moving.bits[1]) != 0; }
  bool none() const {
    return at_rest.facets.empty() && moving.facets.empty() && !many_at_rest && !some_slots_many();
  }
};

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
  void collect(const Shaft& shaft, std::size_t most, Candidates& candidates) const;

 private:
  explicit StaticOccluders(std::vector<Occluder> facets);

  template <class Use, class GoOn>
  void each_block(const Shaft& shaft, Use&& use, GoOn&& go_on) const;

  BoxTree tree_;
  std::vector<Occluder> facets_;   ///< in the order of the tree
  std::vector<FacetLanes> lanes_;  ///< [leaf]
  std::vector<Box> solids_;        ///< around convex solids
};

/// The facets that move, at every pose they take in the slots of one window.
class MovingOccluders {
 public:
  /// Facets of an object: beyond these its tree wins. Of all that moves: bounds the memory, some 200 bytes
  /// per facet and pose.
  static constexpr std::size_t kOfObjectMax = 1024, kOfAllMax = 8192;

  MovingOccluders(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames);

  /// Lists those that may meet the shaft in some slot of [first_slot, last_slot], or says in which slots
  /// something may that is never listed: whether an object is does not depend on the window.
  void collect(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
               ShaftContents& contents) const;
  void collect(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot,
               Candidates& candidates) const;
  /// The slots of the range in which something that is never listed may meet the shaft.
  SlotMask unlisted(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot) const;

 private:
  /// Of an object, and the solids that they bound.
  struct ListedFacets {
    std::vector<const Facet*> facets;
    std::vector<std::uint32_t> solids;
  };
  /// An object where it is in some slots.
  struct PlacedObject {
    Box box;
    std::uint32_t first_slot = 0, last_slot = 0;
    std::uint32_t first_block = 0, end_block = 0;  ///< of its facets; none where it has too many
  };
  std::vector<Box> place(const Patches& patches, const Animation& animation,
                         std::span<const FrameIndex> frames);
  PlacedObject place(const ListedFacets& facets, const PlacedRange& range, bool listed);
  template <class Use>
  void each_object(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot, Use&& use) const;
  template <class Use>
  void each_block(const PlacedObject& object, const Shaft& shaft, Use&& use) const;
  template <class Use>
  void collect_by(const Shaft& shaft, std::uint32_t first_slot, std::uint32_t last_slot, SlotMask& many,
                  Use&& use) const;

  std::size_t moving_facets_ = 0;  ///< of all objects, each once
  std::vector<Occluder> facets_;   ///< sixteen to a block, the last one of an object filled up
  std::vector<FacetLanes> lanes_;  ///< [block]
  std::vector<Box> boxes_;         ///< [block]
  std::vector<Box> solids_;        ///< around convex solids, each at every pose
  std::vector<PlacedObject> objects_;
  std::vector<std::vector<std::uint32_t>> in_slot_;  ///< those that are there
  BoxTree tree_;                                     ///< of objects_
};

/// Where candidates come from.
struct OccluderSource {
  const StaticOccluders& at_rest;
  const MovingOccluders& moving;
  std::size_t most;  ///< of those at rest to be listed
  std::uint32_t first_slot = 0, end_slot = 0;
};

/// Finds what may meet the shaft in some slot. Replaces `found`.
void collect(const OccluderSource& source, const Shaft& shaft, Candidates& found);
void collect(const OccluderSource& source, const Shaft& shaft, ShaftContents& found);

/// The same of a shaft within that of `candidates`, which come from the same source but perhaps for another
/// `most`.
void sift(const OccluderSource& source, const Candidates& candidates, const Shaft& shaft, Candidates& found);
void sift(const OccluderSource& source, const Candidates& candidates, const Shaft& shaft,
          ShaftContents& found);

}  // namespace engine
