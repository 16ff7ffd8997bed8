#include "engine/image/shading_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/base/parallel.h"
#include "engine/image/lattice_nodes.h"
#include "engine/image/weld.h"

namespace engine {
namespace {

struct CellPlaces {
  std::uint32_t count = 0;
  std::uint32_t place[4];
};

/// Calls visit(cell, places) for every cell of the facet, in cell order.
template <class Visit>
void for_each_cell(const Facet& facet, Visit visit) {
  std::uint32_t cell = 0;
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return grid_place(facet, i, j); };
  for (std::uint32_t j = 0; j < facet.grid_v; ++j) {
    const std::uint32_t columns = facet.is_triangle ? facet.grid_u - j : facet.grid_u;
    for (std::uint32_t i = 0; i < columns; ++i) {
      if (!facet.is_triangle) {
        visit(cell++, CellPlaces{4, {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}});
        continue;
      }
      visit(cell++, CellPlaces{3, {at(i, j), at(i + 1, j), at(i, j + 1), 0}});
      if (i + 1 < columns) visit(cell++, CellPlaces{3, {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1), 0}});
    }
  }
}

/// Calls visit(patch, node) for every patch and node that touch.
template <class Visit>
void for_each_touch(const ShadingMesh& mesh, const Patches& patches, Visit visit) {
  for (std::size_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    const std::uint32_t corners = corner_count(facet);
    for (std::uint32_t side = 0; side < (facet.both_sides ? 2u : 1u); ++side) {
      const PatchId patch = facet.first_patch + side * facet.cell_count();
      const std::uint32_t first = mesh.first_place[f] + side * place_count(facet);
      if (!facet.trees.empty()) {
        for (std::uint32_t place = 0; place < place_count(facet); ++place)
          visit(patch + place / corners, mesh.node_of[first + place]);
        continue;
      }
      for_each_cell(facet, [&](std::uint32_t cell, const CellPlaces& places) {
        for (std::uint32_t c = 0; c < places.count; ++c)
          visit(patch + cell, mesh.node_of[first + places.place[c]]);
      });
    }
  }
}

/// Welds the points on the rim of one side of a facet.
class Rim {
 public:
  Rim(const Patches& patches, std::span<const CornerNormals> normals, std::uint32_t facet, bool front,
      Welder& welder)
      : patches_(patches), normals_(normals), facet_(facet), front_(front), welder_(welder) {}

  std::uint32_t node_at(float u, float v, std::uint32_t new_node) {
    const Facet& facet = patches_.facets[facet_];
    const Vec3 point = facet.origin + u * facet.edge_u + v * facet.edge_v;
    const Vec3 normal = shading_normal(patches_, normals_, facet_, u, v);
    return welder_.node_at({point, front_ ? normal : -normal, facet.object, facet.material}, new_node);
  }

 private:
  const Patches& patches_;
  std::span<const CornerNormals> normals_;
  std::uint32_t facet_;
  bool front_;
  Welder& welder_;
};

/// Numbers the places of one side: inner ones are nodes of their own, those on the rim are welded.
void number_grid(const Facet& facet, Rim rim, ShadingMesh& mesh) {
  for (std::uint32_t j = 0; j <= facet.grid_v; ++j) {
    const std::uint32_t last = facet.is_triangle ? facet.grid_u - j : facet.grid_u;
    for (std::uint32_t i = 0; i <= last; ++i) {
      const bool on_rim = i == 0 || j == 0 || i == last || (!facet.is_triangle && j == facet.grid_v);
      std::uint32_t node = mesh.node_count;
      if (on_rim)
        node = rim.node_at(static_cast<float>(i) / static_cast<float>(facet.grid_u),
                           static_cast<float>(j) / static_cast<float>(facet.grid_v), mesh.node_count);
      if (node == mesh.node_count) ++mesh.node_count;
      mesh.node_of.push_back(node);
    }
  }
}

/// The same for the leaves of a facet with trees.
void number_leaves(const Facet& facet, Rim rim, ShadingMesh& mesh, std::vector<HangingNode>& hanging) {
  LatticeNodes nodes(facet);
  for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
    const LeafCorners leaf = leaf_corners(facet, cell);
    for (std::uint32_t c = 0; c < leaf.count; ++c) {
      std::uint32_t& node = nodes.at(leaf.at[c]);
      if (node == LatticeNodes::kNone)
        node = nodes.is_on_rim(leaf.at[c])
                   ? rim.node_at(nodes.u_of(leaf.at[c]), nodes.v_of(leaf.at[c]), mesh.node_count)
                   : mesh.node_count;
      if (node == mesh.node_count) ++mesh.node_count;
      mesh.node_of.push_back(node);
    }
  }
  append_hanging(nodes, hanging);
}

/// Sets the lists of patches around each node, each in patch order.
void collect_patches(const Patches& patches, ShadingMesh& mesh) {
  mesh.first_patch.assign(std::size_t{mesh.node_count} + 1, 0);
  for_each_touch(mesh, patches, [&](PatchId, std::uint32_t node) { ++mesh.first_patch[node + 1]; });
  for (std::uint32_t n = 0; n < mesh.node_count; ++n) mesh.first_patch[n + 1] += mesh.first_patch[n];
  mesh.patches_around.resize(mesh.first_patch.back());
  std::vector<std::uint32_t> next(mesh.first_patch.begin(), mesh.first_patch.end() - 1);
  for_each_touch(mesh, patches,
                 [&](PatchId patch, std::uint32_t node) { mesh.patches_around[next[node]++] = patch; });
}

NodeBlend blend_in_parallelogram(const Facet& facet, float u, float v) {
  const float x = std::clamp(u, 0.0f, 1.0f) * static_cast<float>(facet.grid_u);
  const float y = std::clamp(v, 0.0f, 1.0f) * static_cast<float>(facet.grid_v);
  const std::uint32_t i = std::min(static_cast<std::uint32_t>(x), facet.grid_u - 1);
  const std::uint32_t j = std::min(static_cast<std::uint32_t>(y), facet.grid_v - 1);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
  return {4,
          {{grid_place(facet, i, j), (1 - fx) * (1 - fy)},
           {grid_place(facet, i + 1, j), fx * (1 - fy)},
           {grid_place(facet, i + 1, j + 1), fx * fy},
           {grid_place(facet, i, j + 1), (1 - fx) * fy}}};
}

NodeBlend blend_in_triangle(const Facet& facet, float u, float v) {
  const std::uint32_t n = facet.grid_u;
  const float x = std::clamp(u, 0.0f, 1.0f) * static_cast<float>(n);
  const float y = std::clamp(v, 0.0f, 1.0f) * static_cast<float>(n);
  const std::uint32_t j = std::min(static_cast<std::uint32_t>(y), n - 1);
  const std::uint32_t i = std::min(static_cast<std::uint32_t>(x), n - 1 - j);
  const float fx = std::min(x - static_cast<float>(i), 1.0f), fy = std::min(y - static_cast<float>(j), 1.0f);
  if (fx + fy > 1 && i + j + 1 < n)
    return {3,
            {{grid_place(facet, i + 1, j + 1), fx + fy - 1},
             {grid_place(facet, i, j + 1), 1 - fx},
             {grid_place(facet, i + 1, j), 1 - fy}}};
  const float beyond = std::max(fx + fy, 1.0f);  // rounding may leave the triangle by a hair
  return {3,
          {{grid_place(facet, i, j), std::max(1 - fx - fy, 0.0f)},
           {grid_place(facet, i + 1, j), fx / beyond},
           {grid_place(facet, i, j + 1), fy / beyond}}};
}

/// In the leaf that holds (u, v).
NodeBlend blend_in_leaf(const Facet& facet, float u, float v) {
  const std::uint32_t cell = cell_at(facet, u, v), corners = corner_count(facet);
  const LeafCorners leaf = leaf_corners(facet, cell);
  const auto lattice = [](std::uint32_t n) { return static_cast<float>(n * kLatticeParts); };
  const LatticePoint from = leaf.at[0];
  const float size = static_cast<float>(leaf.at[1].i) - static_cast<float>(from.i);  // < 0: upside down
  const float x = (u * lattice(facet.grid_u) - static_cast<float>(from.i)) / size;
  const float y = (v * lattice(facet.grid_v) - static_cast<float>(from.j)) / size;
  const float fx = std::clamp(x, 0.0f, 1.0f), fy = std::clamp(y, 0.0f, 1.0f);
  const std::uint32_t first = cell * corners;
  if (!facet.is_triangle)
    return {4,
            {{first, (1 - fx) * (1 - fy)},
             {first + 1, fx * (1 - fy)},
             {first + 2, fx * fy},
             {first + 3, (1 - fx) * fy}}};
  const float beyond = std::max(fx + fy, 1.0f);
  return {3, {{first, std::max(1 - fx - fy, 0.0f)}, {first + 1, fx / beyond}, {first + 2, fy / beyond}}};
}

}  // namespace

std::uint32_t place_count(const Facet& facet) {
  if (!facet.trees.empty()) return facet.cell_count() * corner_count(facet);
  if (facet.is_triangle) return (facet.grid_u + 1) * (facet.grid_u + 2) / 2;
  return (facet.grid_u + 1) * (facet.grid_v + 1);
}

std::uint32_t grid_place(const Facet& facet, std::uint32_t i, std::uint32_t j) {
  if (facet.is_triangle) return j * (2 * facet.grid_u + 3 - j) / 2 + i;
  return j * (facet.grid_u + 1) + i;
}

ShadingMesh build_shading_mesh(const Patches& patches, std::span<const CornerNormals> normals) {
  ShadingMesh mesh;
  Welder welder(patches);
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) {
    const Facet& facet = patches.facets[f];
    mesh.first_place.push_back(static_cast<std::uint32_t>(mesh.node_of.size()));
    mesh.has_trees = mesh.has_trees || !facet.trees.empty();
    for (const bool front : {true, false}) {
      if (!front && !facet.both_sides) continue;
      const Rim rim(patches, normals, f, front, welder);
      if (facet.trees.empty())
        number_grid(facet, rim, mesh);
      else
        number_leaves(facet, rim, mesh, mesh.hanging);
    }
  }
  std::stable_sort(mesh.hanging.begin(), mesh.hanging.end(),
                   [](const HangingNode& a, const HangingNode& b) { return a.edge > b.edge; });
  collect_patches(patches, mesh);
  mesh.seams = find_seams(mesh, patches);
  return mesh;
}

bool node_radiosity(const ShadingMesh& mesh, const Patches& patches, const PatchSeries& radiosity_w_m2,
                    std::uint32_t first_frame, const std::function<bool()>& stop_requested,
                    std::span<std::vector<Rgb>> values_w_m2) {
  for (auto& values : values_w_m2) values.resize(mesh.node_count);
  constexpr std::uint32_t kChunk = 1024;
  std::atomic<bool> stopped = false;
  parallel_for((mesh.node_count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    if (stopped || stop_requested()) {
      stopped = true;
      return;
    }
    const auto first = static_cast<std::uint32_t>(chunk * kChunk);
    const std::uint32_t end = std::min(first + kChunk, mesh.node_count);
    std::vector<Rgb> sum(values_w_m2.size());
    for (std::uint32_t node = first; node < end; ++node) {
      std::fill(sum.begin(), sum.end(), Rgb{});
      float weights = 0;
      for (std::uint32_t k = mesh.first_patch[node]; k < mesh.first_patch[node + 1]; ++k) {
        const PatchId patch = mesh.patches_around[k];
        const Rgb* row = radiosity_w_m2.row(patch) + first_frame;
        const float weight = node_weight(mesh, patches, patch);
        for (std::size_t f = 0; f < sum.size(); ++f) sum[f] += weight * row[f];
        weights += weight;
      }
      for (std::size_t f = 0; f < sum.size(); ++f) values_w_m2[f][node] = sum[f] * (1 / weights);
    }
  });
  parallel_for(values_w_m2.size(), [&](std::size_t f) {
    close_seams(mesh.seams, values_w_m2[f]);
    hang(mesh.hanging, values_w_m2[f]);
  });
  return !stopped;
}

NodeBlend blend_at(const ShadingMesh& mesh, const Patches& patches, std::uint32_t facet_index, float u,
                   float v, bool front) {
  const Facet& facet = patches.facets[facet_index];
  if (!front && !facet.both_sides) return {};
  NodeBlend blend = !facet.trees.empty() ? blend_in_leaf(facet, u, v)
                    : facet.is_triangle  ? blend_in_triangle(facet, u, v)
                                         : blend_in_parallelogram(facet, u, v);
  const std::uint32_t first = mesh.first_place[facet_index] + (front ? 0 : place_count(facet));
  for (std::uint32_t c = 0; c < blend.count; ++c)
    blend.nodes[c].node = mesh.node_of[first + blend.nodes[c].node];
  return blend;
}

}  // namespace engine
