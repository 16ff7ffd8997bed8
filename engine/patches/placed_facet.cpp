#include "engine/patches/placed_facet.h"

#include <algorithm>

namespace engine {
namespace {

double determinant(const Pose& pose) {
  const auto& m = pose.m;
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace

PlacedFacet place(const Facet& facet, const Pose& pose) {
  PlacedFacet placed;
  placed.origin = transform_point(pose, facet.origin);
  for (std::size_t c = 0; c < placed.corners.size(); ++c)
    placed.corners[c] = transform_point(pose, facet.corners[c]);
  placed.edge_u = transform_vector(pose, facet.edge_u);
  placed.edge_v = transform_vector(pose, facet.edge_v);
  const Vec3 area = cross(placed.edge_u, placed.edge_v);
  const float size = length(area);
  const float sign = determinant(pose) < 0 ? -1.0f : 1.0f;
  if (size > 0) placed.normal = area * (sign / size);  // a pose that flattens its object leaves no normal
  return placed;
}

std::pair<float, float> uv_in(const CellCorners& cell, float a, float b) {
  if (cell.count == 3 && a + b > 1.0f) {
    a = 1.0f - a;
    b = 1.0f - b;
  }
  const std::uint32_t last = cell.count - 1;
  return {cell.u[0] + a * (cell.u[1] - cell.u[0]) + b * (cell.u[last] - cell.u[0]),
          cell.v[0] + a * (cell.v[1] - cell.v[0]) + b * (cell.v[last] - cell.v[0])};
}

Vec3 point_in(const PlacedFacet& placed, const CellCorners& cell, float a, float b) {
  const auto [u, v] = uv_in(cell, a, b);
  return point_at(placed, u, v);
}

std::vector<PlacedRange> placed_ranges(const ObjectMotion& motion, std::span<const FrameIndex> frames) {
  std::vector<PlacedRange> ranges;
  for (const PoseSpan& span : motion.spans) {
    const auto begin = std::lower_bound(frames.begin(), frames.end(), span.first);
    const auto end = std::upper_bound(begin, frames.end(), span.last);
    if (begin == end) continue;
    ranges.push_back({&span.pose, static_cast<std::uint32_t>(begin - frames.begin()),
                      static_cast<std::uint32_t>(end - frames.begin() - 1)});
  }
  return ranges;
}

}  // namespace engine
