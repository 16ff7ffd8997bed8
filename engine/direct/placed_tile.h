// A tile where its facet is in some slots, and the points on it at which light is measured.
#pragma once

#include "engine/direct/form_factor.h"
#include "engine/direct/receiver.h"
#include "engine/direct/tile.h"
#include "engine/visibility/shaft.h"

namespace engine {

/// A rule for the mean over a cell: exact for polynomials of degree 3 on parallelograms (2 x 2 points of
/// Gauss), of degree 4 on triangles (6 points). Source: Strang & Fix, An Analysis of the Finite Element
/// Method, 1973.
struct CellRule {
  std::uint32_t points = 0;
  float a[6], b[6];  ///< from the first corner to its two neighbours
  float weight[6];   ///< add up to 1
};
const CellRule& cell_rule(bool is_triangle);

/// The parts of a tile that have a place. Buffers are kept from one tile to the next.
class PlacedTile {
 public:
  /// Puts the tile where `pose` has it. `layout` outlives its use.
  void place(const Patches& patches, const Tile& tile, const TileLayout& layout, const Pose& pose,
             Slots slots, bool is_static);

  const TileLayout& layout() const { return *layout_; }
  std::uint32_t count() const { return static_cast<std::uint32_t>(layout_->patches.size()); }
  /// The facet; of no cell in particular.
  const Receiver& facet() const { return facet_; }
  /// Cell `k` of the tile.
  Receiver receiver(std::uint32_t k) const;
  Vec3 middle(std::uint32_t k) const { return middles_[k]; }
  float radius_m(std::uint32_t k) const { return radii_m_[k]; }

  const CellRule& rule() const { return *rule_; }
  /// The points of the rule, cell after cell.
  PointArrays points() const { return {x_.data(), y_.data(), z_.data(), x_.size()}; }
  PointArrays points(std::uint32_t k) const {
    const std::size_t first = std::size_t{k} * rule_->points;
    return {x_.data() + first, y_.data() + first, z_.data() + first, rule_->points};
  }

  /// The rectangle of a node, or the cell of a leaf, as an end of a shaft.
  ShaftEnd end_at(const TileNode& node, float slack_m) const;
  ShaftEnd end_at(std::uint32_t k, float slack_m) const;

 private:
  const TileLayout* layout_ = nullptr;
  const CellRule* rule_ = nullptr;
  Receiver facet_;
  std::vector<Vec3> middles_;
  std::vector<float> radii_m_;
  std::vector<float> x_, y_, z_;
};

}  // namespace engine
