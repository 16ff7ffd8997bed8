#include "engine/visibility/moving_shape.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace engine {
namespace {

/// The inverse of an affine map, by cofactors; none where it flattens space.
std::optional<Pose> inverse(const Pose& pose) {
  const auto& m = pose.m;
  const auto minor = [&](int r0, int c0, int r1, int c1) {
    return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
  };
  const double determinant =
      m[0][0] * minor(1, 1, 2, 2) - m[0][1] * minor(1, 0, 2, 2) + m[0][2] * minor(1, 0, 2, 1);
  const double scale = 1 / determinant;
  if (!std::isfinite(scale)) return std::nullopt;
  Pose back;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int r0 = (column + 1) % 3, r1 = (column + 2) % 3, c0 = (row + 1) % 3, c1 = (row + 2) % 3;
      back.m[row][column] = scale * minor(r0, c0, r1, c1);
    }
  for (auto& row : back.m) row[3] = -(row[0] * m[0][3] + row[1] * m[1][3] + row[2] * m[2][3]);
  return back;
}

/// Which boxes a ray passes through between its ends; widened by what the divisions round.
class RaySlabs {
 public:
  explicit RaySlabs(const Ray& ray)
      : origin_(ray.origin),
        inverse_{1.0f / ray.direction.x, 1.0f / ray.direction.y, 1.0f / ray.direction.z},
        near_(ray.near),
        far_(ray.far) {}

  bool meet(const Box& box) const {
    constexpr float kWidened = 1.00001f;
    float near = near_, far = far_;
    clip(box.lower.x - origin_.x, box.upper.x - origin_.x, inverse_.x, near, far);
    clip(box.lower.y - origin_.y, box.upper.y - origin_.y, inverse_.y, near, far);
    clip(box.lower.z - origin_.z, box.upper.z - origin_.z, inverse_.z, near, far);
    return near <= far * kWidened;
  }

 private:
  /// A ray along a side, and in it, gives 0 times infinity: comparing with that is false and clips nothing.
  static void clip(float lower, float upper, float inverse, float& near, float& far) {
    const float a = lower * inverse, b = upper * inverse;
    const float first = b < a ? b : a, last = a > b ? a : b;
    if (first > near) near = first;
    if (last < far) far = last;
  }

  Vec3 origin_, inverse_;
  float near_, far_;
};

}  // namespace

std::unique_ptr<MovingShape> MovingShape::of(std::span<const std::uint32_t> facets, const Patches& patches,
                                             const ObjectMotion& motion, std::span<const FrameIndex> frames) {
  const std::vector<PlacedRange> ranges = placed_ranges(motion, frames);
  std::vector<Pose> back;
  for (const PlacedRange& range : ranges) {
    const auto to_object = inverse(*range.pose);
    if (!to_object) return nullptr;
    back.push_back(*to_object);
  }
  std::vector<PlacedFacet> items;
  for (const std::uint32_t facet : facets) {
    items.push_back(place(patches.facets[facet], Pose{}));
    items.back().facet = facet;
  }
  std::unique_ptr<MovingShape> shape(new MovingShape(std::move(items), patches));
  shape->pose_in_slot_.assign(frames.size(), kAway);
  for (std::size_t k = 0; k < ranges.size(); ++k) shape->add_pose(back[k], ranges[k], patches);
  return shape;
}

void MovingShape::add_pose(const Pose& to_object, const PlacedRange& range, const Patches& patches) {
  std::fill(pose_in_slot_.begin() + range.first_slot, pose_in_slot_.begin() + range.last_slot + 1,
            static_cast<std::uint32_t>(poses_.size()));
  PlacedShape placed{to_object, {}, range.first_slot, range.last_slot};
  bool first = true;
  for (const PlacedFacet& item : bvh_.items()) {
    const Box box = box_of(place(patches.facets[item.facet], *range.pose).corners);
    placed.box = first ? box : join(placed.box, box);
    first = false;
  }
  poses_.push_back(placed);
}

Ray MovingShape::PlacedShape::ray_in_object(const Ray& ray) const {
  return {transform_point(to_object, ray.origin), transform_vector(to_object, ray.direction), ray.near,
          ray.far};
}

SurfaceHit MovingShape::surface_hit(const ItemHit& hit, const Ray& in_object) const {
  return {hit.distance, bvh_.items()[hit.item].facet, hit.u, hit.v,
          bvh_.is_front(hit.item, in_object.direction)};
}

void MovingShape::add_hits(const Ray& ray, std::vector<MovingHit>& hits) const {
  thread_local std::vector<ItemHit> found;
  const RaySlabs slabs(ray);
  for (const PlacedShape& placed : poses_) {
    if (!slabs.meet(placed.box)) continue;
    const Ray in_object = placed.ray_in_object(ray);
    bvh_.all_hits(in_object, found);
    for (const ItemHit& hit : found) {
      MovingHit next;
      static_cast<SurfaceHit&>(next) = surface_hit(hit, in_object);
      next.first_slot = placed.first_slot;
      next.last_slot = placed.last_slot;
      hits.push_back(next);
    }
  }
}

void MovingShape::block(const Ray& ray, SlotMask& mask) const {
  const RaySlabs slabs(ray);
  for (const PlacedShape& placed : poses_)
    if (slabs.meet(placed.box) && bvh_.any_hit(placed.ray_in_object(ray)))
      mask.set(placed.first_slot, placed.last_slot);
}

bool MovingShape::occluded(const Ray& ray, std::uint32_t slot) const {
  const PlacedShape* placed = in(slot);
  return placed && RaySlabs(ray).meet(placed->box) && bvh_.any_hit(placed->ray_in_object(ray));
}

bool MovingShape::nearest(const Ray& ray, std::uint32_t slot, SurfaceHit& hit) const {
  const PlacedShape* placed = in(slot);
  if (!placed || !RaySlabs(ray).meet(placed->box)) return false;
  const Ray in_object = placed->ray_in_object(ray);
  ItemHit found;
  if (!bvh_.nearest(in_object, found, [](std::uint32_t) { return true; })) return false;
  hit = surface_hit(found, in_object);
  return true;
}

}  // namespace engine
