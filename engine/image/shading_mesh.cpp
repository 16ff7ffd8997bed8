#include "engine/image/shading_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/base/parallel.h"
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
    for (std::uint32_t side = 0; side < (facet.both_sides ? 2u : 1u); ++side)
      for_each_cell(facet, [&](std::uint32_t cell, const CellPlaces& places) {
        const PatchId patch = facet.first_patch + side * facet.cell_count() + cell;
        const std::uint32_t first = mesh.first_place[f] + side * grid_place_count(facet);
        for (std::uint32_t c = 0; c < places.count; ++c) visit(patch, mesh.node_of[first + places.place[c]]);
      });
  }
}

/// Numbers the grid places of one side: inner ones are nodes of their own, those on the rim are welded.
void number_places(const Patches& patches, std::span<const CornerNormals> normals, std::uint32_t facet_index,
                   bool front, Welder& welder, ShadingMesh& mesh) {
  const Facet& facet = patches.facets[facet_index];
  for (std::uint32_t j = 0; j <= facet.grid_v; ++j) {
    const std::uint32_t last = facet.is_triangle ? facet.grid_u - j : facet.grid_u;
    for (std::uint32_t i = 0; i <= last; ++i) {
      const bool on_rim = i == 0 || j == 0 || i == last || (!facet.is_triangle && j == facet.grid_v);
      std::uint32_t node = mesh.node_count;
      if (on_rim) {
        const float u = static_cast<float>(i) / static_cast<float>(facet.grid_u);
        const float v = static_cast<float>(j) / static_cast<float>(facet.grid_v);
        const Vec3 point = facet.origin + u * facet.edge_u + v * facet.edge_v;
        const Vec3 normal = shading_normal(patches, normals, facet_index, u, v);
        node =
            welder.node_at({point, front ? normal : -normal, facet.object, facet.material}, mesh.node_count);
      }
      if (node == mesh.node_count) ++mesh.node_count;
      mesh.node_of.push_back(node);
    }
  }
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

}  // namespace

std::uint32_t grid_place_count(const Facet& facet) {
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
    mesh.first_place.push_back(static_cast<std::uint32_t>(mesh.node_of.size()));
    number_places(patches, normals, f, true, welder, mesh);
    if (patches.facets[f].both_sides) number_places(patches, normals, f, false, welder, mesh);
  }
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
      float area_m2 = 0;
      for (std::uint32_t k = mesh.first_patch[node]; k < mesh.first_patch[node + 1]; ++k) {
        const PatchId patch = mesh.patches_around[k];
        const Rgb* row = radiosity_w_m2.row(patch) + first_frame;
        const float weight = patches.area_m2[patch];
        for (std::size_t f = 0; f < sum.size(); ++f) sum[f] += weight * row[f];
        area_m2 += weight;
      }
      for (std::size_t f = 0; f < sum.size(); ++f) values_w_m2[f][node] = sum[f] * (1 / area_m2);
    }
  });
  parallel_for(values_w_m2.size(), [&](std::size_t f) { close_seams(mesh.seams, values_w_m2[f]); });
  return !stopped;
}

NodeBlend blend_at(const ShadingMesh& mesh, const Patches& patches, std::uint32_t facet_index, float u,
                   float v, bool front) {
  const Facet& facet = patches.facets[facet_index];
  if (!front && !facet.both_sides) return {};
  NodeBlend blend = facet.is_triangle ? blend_in_triangle(facet, u, v) : blend_in_parallelogram(facet, u, v);
  const std::uint32_t first = mesh.first_place[facet_index] + (front ? 0 : grid_place_count(facet));
  for (std::uint32_t c = 0; c < blend.count; ++c)
    blend.nodes[c].node = mesh.node_of[first + blend.nodes[c].node];
  return blend;
}

}  // namespace engine
