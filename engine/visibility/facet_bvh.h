// One Embree scene over placed facets. Internal to engine/visibility.
#pragma once

#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "engine/patches/placed_facet.h"
#include "engine/visibility/embree.h"
#include "engine/visibility/ray_scene.h"

namespace engine {

/// A hit on item `item` of a FacetBvh.
struct ItemHit {
  float distance = 0;
  std::uint32_t item = 0;
  float u = 0, v = 0;
};

/// By distance; ties by item, so that their order does not depend on the tree, and on the diagonal of a quad,
/// where both its halves are hit, by (u, v).
inline bool is_before(const ItemHit& a, const ItemHit& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  return std::tie(a.item, a.u, a.v) < std::tie(b.item, b.u, b.v);
}

class FacetBvh {
 public:
  static constexpr auto kFlags =
      static_cast<RTCSceneFlags>(unsigned{RTC_SCENE_FLAG_ROBUST} | unsigned{embree::kFilterFlag});

  /// With RTC_SCENE_FLAG_ROBUST and filters unless it is asked for other scene flags.
  FacetBvh(std::vector<PlacedFacet> items, const Patches& patches, RTCSceneFlags flags = kFlags);
  ~FacetBvh();
  FacetBvh(const FacetBvh&) = delete;
  FacetBvh& operator=(const FacetBvh&) = delete;

  const std::vector<PlacedFacet>& items() const { return items_; }

  /// Every hit, by (distance, item); an item is hit once at most. Replaces `hits`.
  void all_hits(const Ray& ray, std::vector<ItemHit>& hits) const;

  /// Calls `accept(item)` for items along the ray, in no order and perhaps twice for one item, until one
  /// answers true; says whether one did.
  template <class Accept>
  bool any_hit(const Ray& ray, Accept&& accept) const;

  bool any_hit(const Ray& ray) const;

  /// Embree's own nearest hit, of which nothing is kept.
  bool hits_anything_first(const Ray& ray) const;

  /// The nearest item of those that `accept` takes; of several at exactly that distance one met from its
  /// front, and of those the lowest: at the silhouette of a closed thing its dark inside is not seen. Which
  /// of them Embree meets first depends on its tree, and that on how its threads shared the work of building
  /// it.
  template <class Accept>
  bool nearest(const Ray& ray, ItemHit& hit, Accept&& accept) const;

  bool is_front(std::uint32_t item, Vec3 direction) const { return dot(items_[item].normal, direction) < 0; }

 private:
  /// What a filter needs: the tree, to turn Embree's numbers into items, and the caller's function.
  template <class Accept>
  struct Query {
    const FacetBvh* bvh;
    Accept* accept;
  };
  template <class Accept>
  struct NearestQuery {
    const FacetBvh* bvh;
    Accept* accept;
    Vec3 direction;
    ItemHit best;

    bool is_nearer(const ItemHit& next) const {
      if (next.distance != best.distance) return next.distance < best.distance;
      const bool front = bvh->is_front(next.item, direction);
      return front != bvh->is_front(best.item, direction) ? front : is_before(next, best);
    }
  };
  template <class Accept>
  static void filter_by(const RTCFilterFunctionNArguments* arguments);
  template <class Accept>
  static void filter_nearest(const RTCFilterFunctionNArguments* arguments);

  std::uint32_t item_of(unsigned geometry, unsigned primitive) const { return item_of_[geometry][primitive]; }
  void attach(unsigned geometry, std::span<const std::uint32_t> members);

  std::vector<PlacedFacet> items_;
  std::vector<std::uint32_t> item_of_[2];  ///< [0: quads, 1: triangles][primitive]
  RTCScene scene_ = nullptr;
};

RTCRay to_embree(const Ray& ray);

template <class Accept>
void FacetBvh::filter_by(const RTCFilterFunctionNArguments* arguments) {
  auto* query = static_cast<Query<Accept>*>(embree::user_of(arguments));
  const unsigned geometry = RTCHitN_geomID(arguments->hit, arguments->N, 0);
  const unsigned primitive = RTCHitN_primID(arguments->hit, arguments->N, 0);
  if (!(*query->accept)(query->bvh->item_of(geometry, primitive))) arguments->valid[0] = 0;
}

/// Embree calls it for hits up to and including the nearest taken so far: equal ones come here as well.
template <class Accept>
void FacetBvh::filter_nearest(const RTCFilterFunctionNArguments* arguments) {
  auto* query = static_cast<NearestQuery<Accept>*>(embree::user_of(arguments));
  RTCHitN* hit = arguments->hit;
  const unsigned n = arguments->N;
  const ItemHit next{RTCRayN_tfar(arguments->ray, n, 0),
                     query->bvh->item_of(RTCHitN_geomID(hit, n, 0), RTCHitN_primID(hit, n, 0)),
                     RTCHitN_u(hit, n, 0), RTCHitN_v(hit, n, 0)};
  if (query->is_nearer(next) && (*query->accept)(next.item))
    query->best = next;
  else
    arguments->valid[0] = 0;
}

template <class Accept>
bool FacetBvh::any_hit(const Ray& ray, Accept&& accept) const {
  using Function = std::remove_reference_t<Accept>;
  Query<Function> query{this, &accept};
  RTCRay shot = to_embree(ray);
  embree::occluded(scene_, shot, &filter_by<Function>, &query);
  return shot.tfar < 0;
}

template <class Accept>
bool FacetBvh::nearest(const Ray& ray, ItemHit& hit, Accept&& accept) const {
  using Function = std::remove_reference_t<Accept>;
  NearestQuery<Function> query{this, &accept, ray.direction, {std::numeric_limits<float>::infinity()}};
  RTCRayHit shot;
  shot.ray = to_embree(ray);
  shot.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree::intersect(scene_, shot, &filter_nearest<Function>, &query);
  if (shot.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = query.best;
  return true;
}

}  // namespace engine
