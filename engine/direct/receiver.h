// A patch that receives light.
#pragma once

#include "engine/direct/window_lights.h"

namespace engine {

/// A patch where its object is in some slots of the window.
struct Receiver {
  PatchId patch = kNoPatch;
  std::uint32_t facet = 0;
  Slots slots;
  bool is_static = false;  ///< never moves: this is its one pose
  PlacedFacet placed;      ///< its facet; the normal is that of the patch's side
  Roughness roughness;
  CellCorners cell;
  Vec3 middle;         ///< of the patch  [m]
  float radius_m = 0;  ///< of a ball about the middle that holds it

  /// a, b uniform in [0, 1) give points uniform by area.
  Vec3 at(float a, float b) const { return point_in(placed, cell, a, b); }
  /// Also where its middle is, and how large it is.
  void set_cell(const CellCorners& corners);
};

/// A side of a facet at a pose; of no patch of it yet.
Receiver receiver_facet(const Facet& facet, std::uint32_t number, bool back, const Pose& pose, Slots slots);

/// A cell, or half of one: corner + a edge_u + b edge_v.  [m]
struct CellEdges {
  Vec3 corner, edge_u, edge_v;
};
CellEdges cell_edges(const PlacedFacet& placed, const CellCorners& cell);

}  // namespace engine
