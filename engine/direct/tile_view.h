// The cells of a tile against one light: what arrives if nothing is in the way.
#pragma once

#include <optional>

#include "engine/direct/arrival.h"
#include "engine/direct/placed_tile.h"

namespace engine {

/// How the light of a cell is found.
enum class View : std::uint8_t {
  dark,   ///< none of it can arrive
  apart,  ///< by the rule of the cell (kApartRadii); samples only where something may be in the way
  close,  ///< by samples, whatever is in the way
};

/// So many radii of a cell a light must be away from its middle for the cell's rule to do without samples.
///
/// The factor of a light at distance d varies like 1 / (1 + s^2 / d^2)^2 over a parallelogram of edge 2 a;
/// the first term that the rule of Gauss gets wrong leaves 0.53 (a / d)^4, and with d = 7 sqrt(2) a that is
/// 6e-5. The worst found at that distance: 1.5e-4 of a square cell, 5e-4 of one four times as long as wide,
/// .1 % of one that a small light grazes.
inline constexpr float kApartRadii = 7;

/// What of it is decided here follows from where the cell and the light are, and from nothing else: a cell
/// gets the same in every window and beside any others. Buffers are kept from one light to the next.
class TileView {
 public:
  /// Looks from all cells, or from one; false where none of the light can arrive. What it refers to outlives
  /// its use.
  bool look(const PlacedTile& tile, const LightPose& light, float reach_m);
  bool look_from(const PlacedTile& tile, std::uint32_t k, const LightPose& light, float reach_m);

  View of(std::uint32_t k) const { return views_[k]; }
  /// Mean over the cell of what Arrivals describes; of cells that are `apart`.
  float factor(std::uint32_t k) const { return means_[k]; }
  /// The factor about the corners of a cell that is `apart`, in the order (0, 0), (1, 0), (0, 1), (1, 1) of
  /// what its rule begins from; positive. Triangles: 1.
  std::array<float, 4> at_corners(std::uint32_t k) const;
  /// Can points of the light be drawn by area, and weighed? Else each is drawn for its point of the cell.
  bool is_small(std::uint32_t k) const;

  const LightPose& light() const { return *light_; }
  const Arrivals& arrivals() const { return *arrivals_; }
  /// The part of a light with a surface that is above the plane of the tile.
  const PolygonOverPlane& polygon() const { return *polygon_; }

 private:
  bool begin(const PlacedTile& tile, const LightPose& light, float reach_m);
  void measure(std::uint32_t first, std::uint32_t end);
  View view_of(std::uint32_t k) const;
  View view_of_source(std::uint32_t k) const;

  const PlacedTile* tile_ = nullptr;
  const LightPose* light_ = nullptr;
  std::optional<Arrivals> arrivals_;
  std::optional<PolygonOverPlane> polygon_;
  Vec3 lower_, upper_;          ///< of the light's box
  bool above_horizon_ = false;  ///< all of the light is
  std::vector<View> views_;
  std::vector<float> factors_;  ///< at the points of the tile
  std::vector<float> means_;
};

}  // namespace engine
