#include "engine/direct/receiver.h"

#include <algorithm>

namespace engine {

void Receiver::set_cell(const CellCorners& corners) {
  cell = corners;
  middle = {};
  for (std::uint32_t c = 0; c < cell.count; ++c)
    middle = middle + (1.0f / static_cast<float>(cell.count)) * point_at(placed, cell.u[c], cell.v[c]);
  float squared = 0;
  for (std::uint32_t c = 0; c < cell.count; ++c) {
    const Vec3 apart = point_at(placed, cell.u[c], cell.v[c]) - middle;
    squared = std::max(squared, dot(apart, apart));
  }
  radius_m = std::sqrt(squared);
}

Receiver receiver_facet(const Facet& facet, std::uint32_t number, bool back, const Pose& pose, Slots slots) {
  Receiver receiver;
  receiver.facet = number;
  receiver.slots = slots;
  receiver.placed = place(facet, pose);
  receiver.roughness = roughness_of(receiver.placed, facet.is_triangle);
  if (back) receiver.placed.normal = -receiver.placed.normal;
  return receiver;
}

CellEdges cell_edges(const PlacedFacet& placed, const CellCorners& cell) {
  const std::uint32_t last = cell.count - 1;
  const auto edge = [&](std::uint32_t to) {
    return (cell.u[to] - cell.u[0]) * placed.edge_u + (cell.v[to] - cell.v[0]) * placed.edge_v;
  };
  return {point_at(placed, cell.u[0], cell.v[0]), edge(1), edge(last)};
}

}  // namespace engine
