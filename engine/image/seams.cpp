#include "engine/image/seams.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "engine/image/shading_mesh.h"

namespace engine {
namespace {

/// One edge of one side of a facet. Equal end nodes mean: the same points, and sides that may be mixed.
struct Edge {
  std::uint32_t low_node = 0, high_node = 0;
  std::uint32_t facet = 0;
  std::uint8_t side = 0, number = 0;

  auto key() const { return std::tie(low_node, high_node); }
  auto order() const { return std::tie(low_node, high_node, facet, side, number); }
};

std::uint32_t grid_parts(const Facet& facet, std::uint8_t edge) {
  return facet.is_triangle || edge % 2 == 0 ? facet.grid_u : facet.grid_v;
}

/// The k-th place along an edge, k = 0 .. parts.
std::uint32_t place_on(const Facet& facet, std::uint8_t edge, std::uint32_t k) {
  if (edge == 0) return grid_place(facet, k, 0);
  if (facet.is_triangle) return edge == 1 ? grid_place(facet, facet.grid_u - k, k) : grid_place(facet, 0, k);
  if (edge == 1) return grid_place(facet, facet.grid_u, k);
  return edge == 2 ? grid_place(facet, k, facet.grid_v) : grid_place(facet, 0, k);
}

/// How far along its edge a point of the lattice is, from the edge's beginning; none off the edge.
std::optional<std::uint32_t> distance_on(const Facet& facet, std::uint8_t edge, LatticePoint at) {
  const std::uint32_t n = facet.grid_u * kLatticeParts, m = facet.grid_v * kLatticeParts;
  const bool on_edge = edge == 0                         ? at.j == 0
                       : edge == 1                       ? at.i + (facet.is_triangle ? at.j : 0) == n
                       : edge == 2 && !facet.is_triangle ? at.j == m
                                                         : at.i == 0;
  if (!on_edge) return std::nullopt;
  return edge == 0 || (edge == 2 && !facet.is_triangle) ? at.i : at.j;
}

/// Nodes along an edge, in order, and how far along it they are: in `parts` of its length.
struct EdgeNodes {
  std::uint64_t parts = 1;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> nodes;  ///< distance, node

  std::uint64_t distance(std::size_t k) const { return nodes[k].first; }
  std::uint32_t node(std::size_t k) const { return nodes[k].second; }
};

void add_leaves(const Facet& facet, const Edge& edge, const std::uint32_t* node_of, EdgeNodes& along) {
  for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
    const LeafCorners leaf = leaf_corners(facet, cell);
    for (std::uint32_t c = 0; c < leaf.count; ++c)
      if (const auto distance = distance_on(facet, edge.number, leaf.at[c]))
        along.nodes.emplace_back(*distance, node_of[cell * leaf.count + c]);
  }
  std::sort(along.nodes.begin(), along.nodes.end());
  along.nodes.erase(std::unique(along.nodes.begin(), along.nodes.end()), along.nodes.end());
}

/// From the edge's beginning to its end.
EdgeNodes nodes_along(const ShadingMesh& mesh, const Facet& facet, const Edge& edge) {
  const std::uint32_t* node_of = &mesh.node_of[mesh.first_place[edge.facet] + edge.side * place_count(facet)];
  const std::uint32_t parts = grid_parts(facet, edge.number);
  if (!facet.trees.empty()) {
    EdgeNodes along{std::uint64_t{parts} * kLatticeParts, {}};
    add_leaves(facet, edge, node_of, along);
    return along;
  }
  EdgeNodes along{parts, {}};
  for (std::uint32_t k = 0; k <= parts; ++k)
    along.nodes.emplace_back(k, node_of[place_on(facet, edge.number, k)]);
  return along;
}

/// From its low_node on.
EdgeNodes nodes_from_low(const ShadingMesh& mesh, const Facet& facet, const Edge& edge) {
  EdgeNodes along = nodes_along(mesh, facet, edge);
  if (along.node(0) == edge.low_node) return along;
  std::reverse(along.nodes.begin(), along.nodes.end());
  for (auto& [distance, node] : along.nodes) distance = along.parts - distance;
  return along;
}

/// The nodes at an edge's beginning and end.
std::pair<std::uint32_t, std::uint32_t> ends_of(const ShadingMesh& mesh, const Facet& facet,
                                                const Edge& edge) {
  if (!facet.trees.empty()) {
    const EdgeNodes along = nodes_along(mesh, facet, edge);
    return {along.node(0), along.nodes.back().second};
  }
  const std::uint32_t* node_of = &mesh.node_of[mesh.first_place[edge.facet] + edge.side * place_count(facet)];
  return {node_of[place_on(facet, edge.number, 0)],
          node_of[place_on(facet, edge.number, grid_parts(facet, edge.number))]};
}

std::vector<Edge> sorted_edges(const ShadingMesh& mesh, const Patches& patches) {
  std::vector<Edge> edges;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    for (std::uint8_t side = 0; side < (facet.both_sides ? 2 : 1); ++side)
      for (std::uint8_t number = 0; number < (facet.is_triangle ? 3 : 4); ++number) {
        Edge edge{0, 0, f, side, number};
        std::tie(edge.low_node, edge.high_node) = ends_of(mesh, facet, edge);
        if (edge.low_node > edge.high_node) std::swap(edge.low_node, edge.high_node);
        edges.push_back(edge);
      }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.order() < b.order(); });
  return edges;
}

/// The nodes of `own` that lie between two nodes of `other`. `graded`: either side is quartered.
void append_between(const EdgeNodes& own, const EdgeNodes& other, bool graded, std::vector<SeamNode>& seams) {
  std::size_t before = 0;
  for (std::size_t k = 1; k + 1 < own.nodes.size(); ++k) {
    const std::uint64_t scaled = own.distance(k) * other.parts;  // distances in parts of both edges
    while (other.distance(before + 1) * own.parts <= scaled) ++before;
    const std::uint64_t from = other.distance(before) * own.parts;
    if (from == scaled) continue;  // both have a node here, and it is one
    const std::uint64_t step = (other.distance(before + 1) - other.distance(before)) * own.parts;
    const std::uint64_t own_step =
        std::max(own.distance(k) - own.distance(k - 1), own.distance(k + 1) - own.distance(k)) * other.parts;
    seams.push_back({own.node(k), other.node(before), other.node(before + 1),
                     static_cast<float>(scaled - from) / static_cast<float>(step),
                     graded && step > own_step ? 0.0f : 0.5f});
  }
}

}  // namespace

std::vector<SeamNode> find_seams(const ShadingMesh& mesh, const Patches& patches) {
  std::vector<SeamNode> seams;
  const std::vector<Edge> edges = sorted_edges(mesh, patches);
  for (std::size_t e = 1; e < edges.size(); ++e) {
    if (edges[e - 1].key() != edges[e].key()) continue;
    const Facet &first = patches.facets[edges[e - 1].facet], &second = patches.facets[edges[e].facet];
    const EdgeNodes one = nodes_from_low(mesh, first, edges[e - 1]);
    const EdgeNodes two = nodes_from_low(mesh, second, edges[e]);
    const bool graded = !first.trees.empty() || !second.trees.empty();
    append_between(one, two, graded, seams);
    append_between(two, one, graded, seams);
  }
  return seams;
}

void close_seams(const std::vector<SeamNode>& seams, std::vector<Rgb>& node_values) {
  std::vector<Rgb> closed;
  closed.reserve(seams.size());
  for (const SeamNode& seam : seams) {
    const Rgb other = (1 - seam.t) * node_values[seam.before] + seam.t * node_values[seam.after];
    closed.push_back(seam.own_share * node_values[seam.node] + (1 - seam.own_share) * other);
  }
  for (std::size_t s = 0; s < seams.size(); ++s) node_values[seams[s].node] = closed[s];
}

void hang(const std::vector<HangingNode>& hanging, std::vector<Rgb>& node_values) {
  for (const HangingNode& node : hanging)
    node_values[node.node] = (1 - node.t) * node_values[node.before] + node.t * node_values[node.after];
}

}  // namespace engine
