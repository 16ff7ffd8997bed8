#include "engine/visibility/packet_kernel.h"

#include <cmath>

#include "engine/base/widest.h"

namespace engine {
namespace {

void keep(float (&to)[3], Vec3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

/// A packet about the centre of a scene, and what all its tests need.
struct alignas(64) PacketState {
  float o[3][kLanes], d[3][kLanes], m[3][kLanes];  ///< m = o x d
  float inverse[3][kLanes];                        ///< 1 / d, finite
  float shift[3][kLanes];                          ///< o / d
  float near[kLanes], far[kLanes];
  float common_d[3], common_inverse[3];  ///< of lane 0
};

/// Slabs are left a little late, and boxes are a little larger than what they hold: rounding loses nothing.
constexpr float kWider = 1.0f + 1e-6f;

[[gnu::always_inline]] inline void prepare(const LinePacket& packet, Vec3 centre, PacketState& s) {
  const float about[3] = {centre.x, centre.y, centre.z};
  for (int axis = 0; axis < 3; ++axis) {
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const float d = packet.direction[axis][k];
      s.o[axis][k] = packet.origin[axis][k] - about[axis];
      s.d[axis][k] = d;
      s.inverse[axis][k] = 1.0f / (std::abs(d) > 1e-18f ? d : 1e-18f);
      s.shift[axis][k] = s.o[axis][k] * s.inverse[axis][k];
    }
    s.common_d[axis] = s.d[axis][0];
    s.common_inverse[axis] = s.inverse[axis][0];
  }
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    s.m[0][k] = s.o[1][k] * s.d[2][k] - s.o[2][k] * s.d[1][k];
    s.m[1][k] = s.o[2][k] * s.d[0][k] - s.o[0][k] * s.d[2][k];
    s.m[2][k] = s.o[0][k] * s.d[1][k] - s.o[1][k] * s.d[0][k];
    s.near[k] = packet.near[k];
    s.far[k] = packet.far[k];
  }
}

// What follows comes in two kinds: for any lines, and for parallel ones (kParallel), of which half the
// arithmetic is that of one line. Both give the same bytes, but for boxes, which decide nothing by
// themselves.

template <bool kParallel>
[[gnu::always_inline]] inline bool meets_box(const BoxNode& node, const PacketState& s) {
  const float lower[3] = {node.lower.x, node.lower.y, node.lower.z};
  const float upper[3] = {node.upper.x, node.upper.y, node.upper.z};
  std::uint32_t any = 0;
  if constexpr (kParallel) {
    float first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float a = lower[axis] * s.common_inverse[axis], b = upper[axis] * s.common_inverse[axis];
      first[axis] = a < b ? a : b;
      last[axis] = a < b ? b : a;
    }
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      const float in_x = first[0] - s.shift[0][k], out_x = last[0] - s.shift[0][k];
      const float in_y = first[1] - s.shift[1][k], out_y = last[1] - s.shift[1][k];
      const float in_z = first[2] - s.shift[2][k], out_z = last[2] - s.shift[2][k];
      float in = in_x > in_y ? in_x : in_y, out = out_x < out_y ? out_x : out_y;
      in = in > in_z ? in : in_z;
      out = out < out_z ? out : out_z;
      in = in > s.near[k] ? in : s.near[k];
      out = (out < s.far[k] ? out : s.far[k]) * kWider;
      any |= in <= out ? 1u : 0u;
    }
  } else {
    for (std::uint32_t k = 0; k < kLanes; ++k) {
      float in = s.near[k], out = s.far[k];
      for (int axis = 0; axis < 3; ++axis) {
        const float a = (lower[axis] - s.o[axis][k]) * s.inverse[axis][k];
        const float b = (upper[axis] - s.o[axis][k]) * s.inverse[axis][k];
        const float first = a < b ? a : b, last = a < b ? b : a;
        in = in > first ? in : first;
        out = out < last ? out : last;
      }
      any |= in <= out * kWider ? 1u : 0u;
    }
  }
  return any != 0;
}

/// One bit per lane that passes inside all edges, from either side.
template <bool kParallel>
[[gnu::always_inline]] inline std::uint32_t lanes_inside(const FacetTest& f, const PacketState& s) {
  float common[4];
  for (int e = 0; e < 4; ++e)
    common[e] = (f.edge[e][3] * s.common_d[0] + f.edge[e][4] * s.common_d[1]) + f.edge[e][5] * s.common_d[2];
  std::uint32_t inside = 0;
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    float side[4];
    for (int e = 0; e < 4; ++e)
      side[e] =
          ((f.edge[e][0] * s.m[0][k] + f.edge[e][1] * s.m[1][k]) + f.edge[e][2] * s.m[2][k]) +
          (kParallel ? common[e]
                     : ((f.edge[e][3] * s.d[0][k] + f.edge[e][4] * s.d[1][k]) + f.edge[e][5] * s.d[2][k]));
    const float low01 = side[0] < side[1] ? side[0] : side[1], low23 = side[2] < side[3] ? side[2] : side[3];
    const float high01 = side[0] < side[1] ? side[1] : side[0],
                high23 = side[2] < side[3] ? side[3] : side[2];
    const float low = low01 < low23 ? low01 : low23, high = high01 < high23 ? high23 : high01;
    const std::uint32_t in = (low >= 0 ? 1u : 0u) | (high <= 0 ? 1u : 0u);
    inside |= in << k;
  }
  return inside;
}

struct alignas(64) Meeting {
  float distance[kLanes], u[kLanes], v[kLanes];
  std::uint32_t front[kLanes], valid[kLanes];
};

[[gnu::always_inline]] inline void meet_plane(const FacetTest& f, const PacketState& s, Meeting& at) {
  for (std::uint32_t k = 0; k < kLanes; ++k) {
    const float facing = f.normal[0] * s.d[0][k] + f.normal[1] * s.d[1][k] + f.normal[2] * s.d[2][k];
    const float x = f.origin[0] - s.o[0][k], y = f.origin[1] - s.o[1][k], z = f.origin[2] - s.o[2][k];
    const float t = (f.normal[0] * x + f.normal[1] * y + f.normal[2] * z) / facing;
    const float px = t * s.d[0][k] - x, py = t * s.d[1][k] - y, pz = t * s.d[2][k] - z;
    at.distance[k] = t;
    at.u[k] = f.dual_u[0] * px + f.dual_u[1] * py + f.dual_u[2] * pz;
    at.v[k] = f.dual_v[0] * px + f.dual_v[1] * py + f.dual_v[2] * pz;
    at.front[k] = facing < 0 ? 1u : 0u;
    at.valid[k] = (facing != 0 ? 1u : 0u) & (t >= s.near[k] ? 1u : 0u) & (t <= s.far[k] ? 1u : 0u);
  }
}

/// What is fetched while others are tested: a window's facets are more than a cache holds.
constexpr std::size_t kAhead = 6, kLeafBytes = 4 * sizeof(FacetTest);

inline void fetch(const FacetTree& tree, std::uint32_t leaf) {
  const char* first = reinterpret_cast<const char*>(&tree.tests[tree.nodes[leaf].first]);
  const std::size_t bytes = tree.nodes[leaf].count * sizeof(FacetTest);
  for (std::size_t b = 0; b < bytes && b < kLeafBytes; b += 64) __builtin_prefetch(first + b);
}

/// Replaces lists.leaves by those whose boxes a line meets. Entries are written always and kept by moving on.
template <bool kParallel>
[[gnu::always_inline]] inline void find_leaves(const FacetTree& tree, std::span<const std::uint32_t> roots,
                                               const PacketState& s, TraceLists& lists) {
  lists.open.assign(roots.begin(), roots.end());
  std::size_t leaves = 0;
  while (!lists.open.empty()) {
    const std::size_t count = lists.open.size();
    if (lists.next.size() < 2 * count) lists.next.resize(2 * count);
    if (lists.leaves.size() < leaves + count) lists.leaves.resize(2 * (leaves + count));
    std::uint32_t *const next = lists.next.data(), *const leaf = lists.leaves.data();
    std::size_t children = 0;
    for (std::size_t k = 0; k < count; ++k) {
      if (k + kAhead < count) __builtin_prefetch(&tree.nodes[lists.open[k + kAhead]]);
      const std::uint32_t at = lists.open[k];
      const BoxNode& node = tree.nodes[at];
      const std::size_t met = meets_box<kParallel>(node, s) ? 1 : 0, is_leaf = node.count > 0 ? 1 : 0;
      next[children] = node.first;
      next[children + 1] = node.first + 1;
      children += 2 * (met & (1 - is_leaf));
      leaf[leaves] = at;
      leaves += met & is_leaf;
    }
    lists.open.assign(next, next + children);
  }
  lists.leaves.resize(leaves);
}

template <bool kParallel>
[[gnu::always_inline]] inline void trace(const FacetTree& tree, std::span<const std::uint32_t> roots,
                                         const PacketState& s, TraceLists& lists,
                                         std::vector<PacketHit>& hits) {
  find_leaves<kParallel>(tree, roots, s, lists);
  std::size_t tests = 0, found = 0;
  for (const std::uint32_t leaf : lists.leaves) tests += tree.nodes[leaf].count;
  if (lists.candidates.size() < tests + 1) lists.candidates.resize(2 * tests + 1);
  Candidate* const candidates = lists.candidates.data();
  for (std::size_t k = 0; k < lists.leaves.size(); ++k) {
    if (k + kAhead < lists.leaves.size()) fetch(tree, lists.leaves[k + kAhead]);
    const BoxNode& node = tree.nodes[lists.leaves[k]];
    for (std::uint32_t item = node.first; item < node.first + node.count; ++item) {
      const std::uint32_t inside = lanes_inside<kParallel>(tree.tests[item], s);
      candidates[found] = {item, inside};
      found += inside != 0 ? 1 : 0;
    }
  }
  for (std::size_t c = 0; c < found; ++c) {
    Meeting at;
    meet_plane(tree.tests[candidates[c].item], s, at);
    for (std::uint32_t inside = candidates[c].lanes; inside != 0; inside &= inside - 1) {
      const auto lane = static_cast<std::uint32_t>(__builtin_ctz(inside));
      if (at.valid[lane] == 0) continue;
      hits.push_back({at.distance[lane], at.u[lane], at.v[lane], candidates[c].item,
                      static_cast<std::uint16_t>(lane), static_cast<std::uint16_t>(at.front[lane])});
    }
  }
}

bool are_parallel(const LinePacket& packet) {
  std::uint32_t differ = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (std::uint32_t k = 0; k < kLanes; ++k)
      differ |= packet.direction[axis][k] != packet.direction[axis][0] ? 1u : 0u;
  return differ == 0;
}

}  // namespace

FacetTest facet_test(const PlacedFacet& facet, bool is_triangle, Vec3 centre) {
  FacetTest test;
  const int corners = is_triangle ? 3 : 4;
  for (int e = 0; e < 4; ++e) {
    const int from = std::min(e, corners - 1);
    const Vec3 a = facet.corners[from] - centre, b = facet.corners[(from + 1) % corners] - centre;
    const Vec3 along = b - a, about = cross(a, b);
    const float values[6] = {along.x, along.y, along.z, about.x, about.y, about.z};
    for (int k = 0; k < 6; ++k) test.edge[e][k] = values[k];
  }
  keep(test.normal, facet.normal);
  keep(test.origin, facet.origin - centre);
  const auto dual = [&](Vec3 edge,
                        Vec3 other) {  // the vector in the plane across `other`, as long as 1 / edge
    const Vec3 n = cross(edge, other), out = cross(other, n);
    const float size = dot(edge, out);
    return size > 0 ? out * (1.0f / size) : Vec3{};
  };
  keep(test.dual_u, dual(facet.edge_u, facet.edge_v));
  keep(test.dual_v, dual(facet.edge_v, facet.edge_u));
  return test;
}

KEYLUME_WIDEST
void trace_packet(const FacetTree& tree, std::span<const std::uint32_t> roots, const LinePacket& packet,
                  TraceLists& lists, std::vector<PacketHit>& hits) {
  PacketState state;
  prepare(packet, tree.centre, state);
  if (are_parallel(packet))
    trace<true>(tree, roots, state, lists, hits);
  else
    trace<false>(tree, roots, state, lists, hits);
}

}  // namespace engine
