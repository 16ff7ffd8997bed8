#include "engine/direct/placed_tile.h"

#include <algorithm>

namespace engine {
namespace {

constexpr float kLow = 0.211324865f, kHigh = 0.788675135f;  // (1 -+ 1 / sqrt 3) / 2
constexpr CellRule kSquareRule{
    4, {kLow, kHigh, kLow, kHigh}, {kLow, kLow, kHigh, kHigh}, {0.25f, 0.25f, 0.25f, 0.25f}};

constexpr float kNear = 0.0915762135f, kFar = 0.816847573f, kNearWeight = 0.109951744f;
constexpr float kBeside = 0.445948491f, kAcross = 0.108103018f, kSideWeight = 0.223381590f;
constexpr CellRule kTriangleRule{
    6,
    {kNear, kFar, kNear, kBeside, kAcross, kBeside},
    {kNear, kNear, kFar, kBeside, kBeside, kAcross},
    {kNearWeight, kNearWeight, kNearWeight, kSideWeight, kSideWeight, kSideWeight}};

}  // namespace

const CellRule& cell_rule(bool is_triangle) {
  return is_triangle ? kTriangleRule : kSquareRule;
}

void PlacedTile::place(const Patches& patches, const Tile& tile, const TileLayout& layout, const Pose& pose,
                       Slots slots, bool is_static) {
  const Facet& facet = patches.facets[tile.facet];
  layout_ = &layout;
  rule_ = &cell_rule(facet.is_triangle);
  facet_ = receiver_facet(facet, tile.facet, tile.back, pose, slots);
  facet_.is_static = is_static;
  middles_.clear();
  radii_m_.clear();
  const std::size_t count = layout.cells.size();
  for (auto* of : {&x_, &y_, &z_}) of->resize(count * rule_->points);
  std::size_t to = 0;
  for (const CellCorners& cell : layout.cells) {
    facet_.set_cell(cell);
    middles_.push_back(facet_.middle);
    radii_m_.push_back(facet_.radius_m);
    const CellEdges edges = cell_edges(facet_.placed, cell);
    for (std::uint32_t p = 0; p < rule_->points; ++p, ++to) {
      const Vec3 at = edges.corner + rule_->a[p] * edges.edge_u + rule_->b[p] * edges.edge_v;
      x_[to] = at.x;
      y_[to] = at.y;
      z_[to] = at.z;
    }
  }
}

Receiver PlacedTile::receiver(std::uint32_t k) const {
  Receiver receiver = facet_;
  receiver.patch = layout_->patches[k];
  receiver.cell = layout_->cells[k];
  receiver.middle = middles_[k];
  receiver.radius_m = radii_m_[k];
  return receiver;
}

ShaftEnd PlacedTile::end_at(const TileNode& node, float slack_m) const {
  if (node.end - node.first == 1) return end_at(node.first, slack_m);
  const PlacedFacet& at = facet_.placed;
  return {{point_at(at, node.u0, node.v0), point_at(at, node.u1, node.v0), point_at(at, node.u1, node.v1),
           point_at(at, node.u0, node.v1)},
          4,
          at.normal,
          slack_m};
}

ShaftEnd PlacedTile::end_at(std::uint32_t k, float slack_m) const {
  const CellCorners& cell = layout_->cells[k];
  ShaftEnd end{{}, cell.count, facet_.placed.normal, slack_m};
  for (std::uint32_t c = 0; c < cell.count; ++c)
    end.corners[c] = point_at(facet_.placed, cell.u[c], cell.v[c]);
  return end;
}

}  // namespace engine
