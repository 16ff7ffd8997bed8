#include "engine/visibility/facet_bvh.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>

namespace engine {
namespace {

constexpr unsigned kQuads = 0, kTriangles = 1;

/// One device for the process: it holds no scene data, and making one costs milliseconds.
RTCDevice device() {
  static const RTCDevice the_device = [] {
    const RTCDevice made = rtcNewDevice(nullptr);
    if (!made) {
      std::cerr << "keylume: Embree has no device: error " << rtcGetDeviceError(nullptr) << '\n';
      std::abort();
    }
    return made;
  }();
  return the_device;
}

void store(float* to, Vec3 p) {
  to[0] = p.x;
  to[1] = p.y;
  to[2] = p.z;
}

/// Their order makes Embree's (u, v) ours: quads are split into (0, 1, 3) and (2, 3, 1).
void store_corners(float* to, const PlacedFacet& item, unsigned count) {
  for (unsigned c = 0; c < count; ++c) store(to + 3 * c, item.corners[c]);
}

struct Collector {
  const FacetBvh* bvh;
  std::vector<ItemHit>* hits;
};

}  // namespace

RTCRay to_embree(const Ray& ray) {
  RTCRay shot;
  shot.org_x = ray.origin.x;
  shot.org_y = ray.origin.y;
  shot.org_z = ray.origin.z;
  shot.dir_x = ray.direction.x;
  shot.dir_y = ray.direction.y;
  shot.dir_z = ray.direction.z;
  shot.tnear = ray.near;
  shot.tfar = ray.far;
  shot.time = 0;
  shot.mask = ~0u;
  shot.id = 0;
  shot.flags = 0;
  return shot;
}

FacetBvh::FacetBvh(std::vector<PlacedFacet> items, const Patches& patches, RTCSceneFlags flags)
    : items_(std::move(items)) {
  for (std::uint32_t i = 0; i < items_.size(); ++i)
    item_of_[patches.facets[items_[i].facet].is_triangle ? kTriangles : kQuads].push_back(i);
  scene_ = rtcNewScene(device());
  rtcSetSceneFlags(scene_, flags);
  attach(kQuads, item_of_[kQuads]);
  attach(kTriangles, item_of_[kTriangles]);
  rtcCommitScene(scene_);
}

FacetBvh::~FacetBvh() {
  rtcReleaseScene(scene_);
}

void FacetBvh::attach(unsigned geometry, std::span<const std::uint32_t> members) {
  if (members.empty()) return;
  const bool triangles = geometry == kTriangles;
  const unsigned corners = triangles ? 3 : 4;
  const RTCGeometry made =
      rtcNewGeometry(device(), triangles ? RTC_GEOMETRY_TYPE_TRIANGLE : RTC_GEOMETRY_TYPE_QUAD);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      made, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), members.size() * corners));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(made, RTC_BUFFER_TYPE_INDEX, 0, triangles ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT4,
                              corners * sizeof(unsigned), members.size()));
  for (std::size_t k = 0; k < members.size(); ++k) {
    store_corners(points + 3 * corners * k, items_[members[k]], corners);
    for (unsigned c = 0; c < corners; ++c) indices[corners * k + c] = static_cast<unsigned>(corners * k + c);
  }
  rtcSetGeometryMask(made, ~0u);  // Embree 4 starts with 1
  rtcCommitGeometry(made);
  rtcAttachGeometryByID(scene_, made, geometry);
  rtcReleaseGeometry(made);
}

void FacetBvh::all_hits(const Ray& ray, std::vector<ItemHit>& hits) const {
  hits.clear();
  Collector collector{this, &hits};
  RTCRay shot = to_embree(ray);
  const auto record = [](const RTCFilterFunctionNArguments* arguments) {
    const auto* to = static_cast<Collector*>(embree::user_of(arguments));
    RTCHitN* hit = arguments->hit;
    const unsigned n = arguments->N;
    const std::uint32_t item = to->bvh->item_of(RTCHitN_geomID(hit, n, 0), RTCHitN_primID(hit, n, 0));
    to->hits->push_back(
        {RTCRayN_tfar(arguments->ray, n, 0), item, RTCHitN_u(hit, n, 0), RTCHitN_v(hit, n, 0)});
    arguments->valid[0] = 0;  // go on: every hit is wanted
  };
  embree::occluded(scene_, shot, record, &collector);
  std::sort(hits.begin(), hits.end(), [](const ItemHit& a, const ItemHit& b) {
    return a.item != b.item ? a.item < b.item : is_before(a, b);
  });
  const auto same_item = [](const ItemHit& a, const ItemHit& b) { return a.item == b.item; };
  hits.erase(std::unique(hits.begin(), hits.end(), same_item), hits.end());
  std::sort(hits.begin(), hits.end(), is_before);
}

bool FacetBvh::any_hit(const Ray& ray) const {
  RTCRay shot = to_embree(ray);
  embree::occluded(scene_, shot, nullptr, nullptr);
  return shot.tfar < 0;
}

bool FacetBvh::hits_anything_first(const Ray& ray) const {
  RTCRayHit shot;
  shot.ray = to_embree(ray);
  shot.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  embree::intersect(scene_, shot, nullptr, nullptr);
  return shot.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

}  // namespace engine
