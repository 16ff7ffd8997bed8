// A large object that moves: one tree in its own space, into which rays are taken. Internal to
// engine/visibility.
#pragma once

#include <memory>
#include <vector>

#include "engine/base/pose.h"
#include "engine/visibility/box.h"
#include "engine/visibility/facet_bvh.h"

namespace engine {

/// Its facets once, whatever the number of its poses, and per slot just the pose it has there: a tree of all
/// poses together would hold each facet as often, and a ray that asks about one slot would meet all of them.
/// Distances along a ray are in lengths of its direction, which is taken along: they stay what they are.
class MovingShape {
 public:
  /// facets: all of one object. Null where a pose of the window flattens the object: then there is no way
  /// back.
  static std::unique_ptr<MovingShape> of(std::span<const std::uint32_t> facets, const Patches& patches,
                                         const ObjectMotion& motion, std::span<const FrameIndex> frames);

  /// Appends every hit at every pose, unsorted.
  void add_hits(const Ray& ray, std::vector<MovingHit>& hits) const;
  /// Sets the slots in which it blocks the ray.
  void block(const Ray& ray, SlotMask& mask) const;
  bool occluded(const Ray& ray, std::uint32_t slot) const;
  /// As MovingRays::nearest.
  bool nearest(const Ray& ray, std::uint32_t slot, SurfaceHit& hit) const;

 private:
  struct PlacedShape {
    Pose to_object;
    Box box;  ///< of its facets, in world space
    std::uint32_t first_slot = 0, last_slot = 0;
    Ray ray_in_object(const Ray& ray) const;
  };
  static constexpr std::uint32_t kAway = ~0u;

  MovingShape(std::vector<PlacedFacet> facets, const Patches& patches) : bvh_(std::move(facets), patches) {}
  void add_pose(const Pose& to_object, const PlacedRange& range, const Patches& patches);
  SurfaceHit surface_hit(const ItemHit& hit, const Ray& in_object) const;
  const PlacedShape* in(std::uint32_t slot) const {
    return pose_in_slot_[slot] == kAway ? nullptr : &poses_[pose_in_slot_[slot]];
  }

  FacetBvh bvh_;  ///< in object space
  std::vector<PlacedShape> poses_;
  std::vector<std::uint32_t> pose_in_slot_;  ///< kAway where it is not there
};

}  // namespace engine
