// Sixteen lines against boxes and facets. Internal to engine/visibility.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/patches/placed_facet.h"
#include "engine/visibility/box_hierarchy.h"
#include "engine/visibility/line_packet.h"

namespace engine {

/// What the test of one facet needs, relative to the centre of its scene. 144 bytes, read once per packet.
struct FacetTest {
  /// Edge a -> b as b - a and a x b (Plücker coordinates); a triangle's third one twice. The neighbour's edge
  /// b -> a is the same with other signs, bit for bit, so that a line passes one of the two.
  float edge[4][6];
  float normal[3], origin[3];
  float dual_u[3], dual_v[3];  ///< u = dual_u . (p - origin), v likewise
};

FacetTest facet_test(const PlacedFacet& facet, bool is_triangle, Vec3 centre);

/// A line meets a facet.
struct PacketHit {
  float distance, u, v;
  std::uint32_t item;  ///< place in `tests`
  std::uint16_t lane;
  std::uint16_t front;  ///< 1: it comes from the facet's front
};

struct FacetTree {
  std::vector<BoxNode> nodes;
  std::vector<FacetTest> tests;
  Vec3 centre;
};

/// A facet that some lanes pass inside of, one bit each.
struct Candidate {
  std::uint32_t item, lanes;
};

/// What trace_packet works with; reused, it allocates nothing.
struct TraceLists {
  std::vector<std::uint32_t> open, next, leaves;  ///< nodes
  std::vector<Candidate> candidates;
};

/// Appends what the lines of `packet` meet below the nodes `roots`, in no order; no facet twice for a line.
/// Loops over lanes only: 44 multiplications and additions decide whether a line passes inside a facet's
/// edges (24 where the packet's are parallel), 26 whether it meets a box. Level by level and
/// without branches, so that one test begins before the last one has ended. The same bytes for every
/// kind of registers.
void trace_packet(const FacetTree& tree, std::span<const std::uint32_t> roots, const LinePacket& packet,
                  TraceLists& lists, std::vector<PacketHit>& hits);

}  // namespace engine
