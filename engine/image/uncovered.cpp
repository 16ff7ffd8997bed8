#include "engine/image/uncovered.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/base/parallel.h"
#include "engine/patches/placed_facet.h"
#include "engine/visibility/box_tree.h"

namespace engine {
namespace {

/// The facets that rest, by their boxes: most patches have nothing near, and need no rays to know it.
class RestingBoxes {
 public:
  RestingBoxes(const Patches& patches, const Animation& animation) {
    for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
      const Facet& facet = patches.facets[f];
      const ObjectMotion& motion = animation.objects[facet.object];
      if (!motion.is_static(animation.frame_count)) continue;
      const PlacedFacet placed = place(facet, motion.spans[0].pose);
      boxes_.push_back(box_of(std::span(placed.corners).first(facet.is_triangle ? 3 : 4)));
      facets_.push_back(f);
    }
    tree_.emplace(boxes_);
    for (const Box& box : boxes_)
      for (const float x : {box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z})
        slack_m_ = std::max(slack_m_, kSlack * std::abs(x));
  }

  /// Can a ray within `box` meet a facet other than `own`?
  bool may_meet(Box box, std::uint32_t own) const {
    const Vec3 slack{slack_m_, slack_m_, slack_m_};
    box = {box.lower - slack, box.upper + slack};
    bool meets = false;
    tree_->each_leaf([&](const Box& other) { return overlap(box, other); },
                     [&](const BoxTree::Leaf& leaf) {
                       meets = facets_[tree_->order()[leaf.first]] != own;
                       return !meets;
                     });
    return meets;
  }

 private:
  /// Rays meet facets beyond their edges by rounding; far less than this share of the largest coordinate.
  static constexpr float kSlack = 1e-5f;

  static bool overlap(const Box& a, const Box& b) {
    return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
           b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> facets_;  ///< [box]
  std::optional<BoxTree> tree_;
  float slack_m_ = 0;
};

/// One side of a facet that rests.
struct Side {
  const Facet& facet;
  std::uint32_t facet_index = 0;
  PlacedFacet placed;
  Vec3 outward;
};

/// Point (i, j) of n x n on a cell: the middles of its parts, of a triangle those of n^2 equal ones.
Vec3 point_on(const Side& side, const CellCorners& cell, int i, int j, int n) {
  const bool triangle = cell.count == 3;
  const float offset = triangle ? 1.0f / 3 : 0.5f;
  float a = (static_cast<float>(i) + offset) / static_cast<float>(n);
  float b = (static_cast<float>(j) + offset) / static_cast<float>(n);
  if (triangle && a + b > 1) a = 1 - a, b = 1 - b;
  const int last = triangle ? 2 : 3;
  const float u = cell.u[0] + a * (cell.u[1] - cell.u[0]) + b * (cell.u[last] - cell.u[0]);
  const float v = cell.v[0] + a * (cell.v[1] - cell.v[0]) + b * (cell.v[last] - cell.v[0]);
  return side.placed.origin + u * side.placed.edge_u + v * side.placed.edge_v;
}

/// Rays begin as far behind their point as its rounding may be off: a thing that stands on it touches it.
float rounding_m(Vec3 p, float reach_m) {
  return std::min(1e-6f * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), reach_m);
}

float bare_share(const Side& side, const CellCorners& cell, float reach_m, const StaticRays& rays, int points,
                 std::vector<SurfaceHit>& hits) {
  int bare = 0;
  for (int j = 0; j < points; ++j)
    for (int i = 0; i < points; ++i) {
      const Vec3 p = point_on(side, cell, i, j, points);
      const float behind_m = rounding_m(p, reach_m);
      rays.all_hits({p - behind_m * side.outward, side.outward, 0, reach_m + behind_m}, hits);
      bare += std::all_of(hits.begin(), hits.end(),
                          [&](const SurfaceHit& hit) { return hit.facet == side.facet_index; });
    }
  return static_cast<float>(bare) / static_cast<float>(points * points);
}

/// Around a cell and what is up to `reach_m` in front of it.
Box box_before(const Side& side, const CellCorners& cell, float reach_m) {
  std::array<Vec3, 8> points;
  for (std::uint32_t c = 0; c < cell.count; ++c) {
    const Vec3 p = side.placed.origin + cell.u[c] * side.placed.edge_u + cell.v[c] * side.placed.edge_v;
    points[2 * c] = p - rounding_m(p, reach_m) * side.outward;
    points[2 * c + 1] = p + reach_m * side.outward;
  }
  return box_of(std::span(points).first(2 * cell.count));
}

void set_side(const Side& side, PatchId first_patch, const StaticRays& rays, const RestingBoxes& resting,
              std::vector<float>& shares) {
  const float scale = length(cross(side.placed.edge_u, side.placed.edge_v));
  std::vector<SurfaceHit> hits;
  for (std::uint32_t c = 0; c < side.facet.cell_count(); ++c) {
    const CellCorners cell = cell_corners(side.facet, c);
    const int last = cell.count == 3 ? 2 : 3;
    const float in_uv = std::abs((cell.u[1] - cell.u[0]) * (cell.v[last] - cell.v[0]) -
                                 (cell.v[1] - cell.v[0]) * (cell.u[last] - cell.u[0]));
    const float reach_m = kCoverReach * std::sqrt(scale * in_uv);
    if (!resting.may_meet(box_before(side, cell, reach_m), side.facet_index)) continue;  // it is bare
    float share = bare_share(side, cell, reach_m, rays, 4, hits);
    if (share > 0 && share < 1) share = bare_share(side, cell, reach_m, rays, 16, hits);
    shares[first_patch + c] = share;
  }
}

std::vector<float> uncovered_shares(const Patches& patches, const Animation& animation,
                                    const StaticRays& static_rays) {
  std::vector<float> shares(patches.count(), 1.0f);
  const RestingBoxes resting(patches, animation);
  parallel_for(patches.facets.size(), [&](std::size_t f) {
    const Facet& facet = patches.facets[f];
    const ObjectMotion& motion = animation.objects[facet.object];
    if (!motion.is_static(animation.frame_count) || animation.emission.ever_emits(facet.material)) return;
    const PlacedFacet placed = place(facet, motion.spans[0].pose);
    const auto index = static_cast<std::uint32_t>(f);
    set_side({facet, index, placed, placed.normal}, facet.first_patch, static_rays, resting, shares);
    if (facet.both_sides)
      set_side({facet, index, placed, -placed.normal}, facet.first_patch + facet.cell_count(), static_rays,
               resting, shares);
  });
  return shares;
}

bool is_partly_covered(const ShadingMesh& mesh, const std::vector<float>& share, std::uint32_t node) {
  bool bare = true, covered = true;
  for (std::uint32_t k = mesh.first_patch[node]; k < mesh.first_patch[node + 1]; ++k) {
    bare = bare && share[mesh.patches_around[k]] == 1;
    covered = covered && share[mesh.patches_around[k]] == 0;
  }
  return !bare && !covered;
}

}  // namespace

Uncovered find_uncovered(const Patches& patches, const Animation& animation, const StaticRays& static_rays,
                         const ShadingMesh& mesh) {
  Uncovered uncovered{uncovered_shares(patches, animation, static_rays), {}};
  for (std::uint32_t node = 0; node < mesh.node_count; ++node)
    if (is_partly_covered(mesh, uncovered.share, node)) uncovered.nodes.push_back(node);
  if (uncovered.nodes.empty()) uncovered.share.clear();
  return uncovered;
}

void show_uncovered(const Uncovered& uncovered, const ShadingMesh& mesh, const Patches& patches,
                    const PatchSeries& series, std::uint32_t first_frame,
                    const std::function<Rgb(PatchId)>& weight, std::span<std::vector<Rgb>> values) {
  for (const std::uint32_t node : uncovered.nodes) {
    std::vector<Rgb> sum(values.size());
    Rgb below;
    for (std::uint32_t k = mesh.first_patch[node]; k < mesh.first_patch[node + 1]; ++k) {
      const PatchId patch = mesh.patches_around[k];
      if (uncovered.share[patch] == 0) continue;
      const float area = node_weight(mesh, patches, patch);
      below += (area * uncovered.share[patch]) * weight(patch);
      for (std::size_t f = 0; f < sum.size(); ++f)
        sum[f] += area * series.at(patch, first_frame + static_cast<std::uint32_t>(f));
    }
    const auto over = [](float a, float b) { return b > 0 ? a / b : 0; };
    for (std::size_t f = 0; f < sum.size(); ++f)
      values[f][node] = {over(sum[f].r, below.r), over(sum[f].g, below.g), over(sum[f].b, below.b)};
  }
}

}  // namespace engine
