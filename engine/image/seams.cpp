#include "engine/image/seams.h"

#include <algorithm>
#include <tuple>

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

std::uint32_t parts(const Facet& facet, std::uint8_t edge) {
  return facet.is_triangle || edge % 2 == 0 ? facet.grid_u : facet.grid_v;
}

/// The k-th place along an edge, k = 0 .. parts.
std::uint32_t place_on(const Facet& facet, std::uint8_t edge, std::uint32_t k) {
  if (edge == 0) return grid_place(facet, k, 0);
  if (facet.is_triangle) return edge == 1 ? grid_place(facet, facet.grid_u - k, k) : grid_place(facet, 0, k);
  if (edge == 1) return grid_place(facet, facet.grid_u, k);
  return edge == 2 ? grid_place(facet, k, facet.grid_v) : grid_place(facet, 0, k);
}

/// Nodes along an edge, counted from its low_node.
class EdgeNodes {
 public:
  EdgeNodes(const ShadingMesh& mesh, const Facet& facet, const Edge& edge)
      : mesh_(mesh),
        facet_(facet),
        edge_(edge.number),
        first_(mesh.first_place[edge.facet] + edge.side * grid_place_count(facet)) {
    reversed_ = raw(0) != edge.low_node;
  }
  std::uint32_t count() const { return parts(facet_, edge_); }
  std::uint32_t at(std::uint32_t k) const { return raw(reversed_ ? count() - k : k); }

 private:
  std::uint32_t raw(std::uint32_t k) const { return mesh_.node_of[first_ + place_on(facet_, edge_, k)]; }

  const ShadingMesh& mesh_;
  const Facet& facet_;
  std::uint8_t edge_;
  std::uint32_t first_;
  bool reversed_ = false;
};

std::vector<Edge> sorted_edges(const ShadingMesh& mesh, const Patches& patches) {
  std::vector<Edge> edges;
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    for (std::uint8_t side = 0; side < (facet.both_sides ? 2 : 1); ++side)
      for (std::uint8_t number = 0; number < (facet.is_triangle ? 3 : 4); ++number) {
        const std::uint32_t first = mesh.first_place[f] + side * grid_place_count(facet);
        const std::uint32_t a = mesh.node_of[first + place_on(facet, number, 0)];
        const std::uint32_t b = mesh.node_of[first + place_on(facet, number, parts(facet, number))];
        edges.push_back({std::min(a, b), std::max(a, b), f, side, number});
      }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.order() < b.order(); });
  return edges;
}

/// The nodes of `own` that lie between two nodes of `other`.
void append_hanging(const EdgeNodes& own, const EdgeNodes& other, std::vector<SeamNode>& seams) {
  for (std::uint32_t k = 1; k < own.count(); ++k) {
    const std::uint64_t scaled = std::uint64_t{k} * other.count();
    const auto before = static_cast<std::uint32_t>(scaled / own.count());
    const auto rest = static_cast<std::uint32_t>(scaled % own.count());
    if (rest == 0) continue;  // both have a node here, and it is one
    seams.push_back({own.at(k), other.at(before), other.at(before + 1),
                     static_cast<float>(rest) / static_cast<float>(own.count())});
  }
}

}  // namespace

std::vector<SeamNode> find_seams(const ShadingMesh& mesh, const Patches& patches) {
  std::vector<SeamNode> seams;
  const std::vector<Edge> edges = sorted_edges(mesh, patches);
  for (std::size_t e = 1; e < edges.size(); ++e) {
    if (edges[e - 1].key() != edges[e].key()) continue;
    const EdgeNodes one(mesh, patches.facets[edges[e - 1].facet], edges[e - 1]);
    const EdgeNodes two(mesh, patches.facets[edges[e].facet], edges[e]);
    append_hanging(one, two, seams);
    append_hanging(two, one, seams);
  }
  return seams;
}

void close_seams(const std::vector<SeamNode>& seams, std::vector<Rgb>& node_values) {
  std::vector<Rgb> closed;
  closed.reserve(seams.size());
  for (const SeamNode& seam : seams) {
    const Rgb other = (1 - seam.t) * node_values[seam.before] + seam.t * node_values[seam.after];
    closed.push_back(0.5f * (node_values[seam.node] + other));
  }
  for (std::size_t s = 0; s < seams.size(); ++s) node_values[seams[s].node] = closed[s];
}

}  // namespace engine
