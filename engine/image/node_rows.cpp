#include "engine/image/node_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace engine {
namespace {

/// Sorted by patch, each of them once.
void merge(std::vector<PatchWeight>& row) {
  std::sort(row.begin(), row.end(),
            [](const PatchWeight& a, const PatchWeight& b) { return a.patch < b.patch; });
  std::size_t end = 0;
  for (const PatchWeight part : row)
    if (end > 0 && row[end - 1].patch == part.patch)
      row[end - 1].weight += part.weight;
    else
      row[end++] = part;
  row.resize(end);
}

/// Where a corner of a facet's cell, as cell_corners() has it, is among the facet's places.
std::uint32_t place_of(const Facet& facet, std::uint32_t cell, const CellCorners& corners, std::uint32_t c) {
  if (!facet.trees.empty()) return cell * corner_count(facet) + c;
  const auto index = [](float x, std::uint32_t n) {
    return static_cast<std::uint32_t>(std::lround(x * static_cast<float>(n)));
  };
  return grid_place(facet, index(corners.u[c], facet.grid_u), index(corners.v[c], facet.grid_v));
}

}  // namespace

NodeRows::NodeRows(const ShadingMesh& mesh, const Patches& patches, const Uncovered& uncovered)
    : mesh_(mesh), patches_(patches) {
  close_seams();
  hang();
  show_uncovered(uncovered);
}

std::uint32_t NodeRows::size_of(std::uint32_t node) const {
  const auto special = special_.find(node);
  if (special != special_.end()) return static_cast<std::uint32_t>(special->second.size());
  return mesh_.first_patch[node + 1] - mesh_.first_patch[node];
}

void NodeRows::append(std::uint32_t node, std::vector<PatchWeight>& row) const {
  const auto special = special_.find(node);
  if (special == special_.end()) return append_mean(node, row);
  row.insert(row.end(), special->second.begin(), special->second.end());
}

void NodeRows::append_mean(std::uint32_t node, Row& row) const {
  const std::size_t first = row.size();
  float sum = 0;
  for (std::uint32_t k = mesh_.first_patch[node]; k < mesh_.first_patch[node + 1]; ++k) {
    const PatchId patch = mesh_.patches_around[k];
    row.push_back({patch, node_weight(mesh_, patches_, patch)});
    sum += row.back().weight;
  }
  for (std::size_t k = first; k < row.size(); ++k) row[k].weight /= sum;
}

void NodeRows::add(std::uint32_t node, float share, Row& sum) const {
  if (share == 0) return;
  const std::size_t first = sum.size();
  append(node, sum);
  for (std::size_t k = first; k < sum.size(); ++k) sum[k].weight *= share;
}

/// As engine::close_seams: all from the rows as they were.
void NodeRows::close_seams() {
  std::vector<Row> closed;
  closed.reserve(mesh_.seams.size());
  for (const SeamNode& seam : mesh_.seams) {
    Row& sum = closed.emplace_back();
    add(seam.node, seam.own_share, sum);
    add(seam.before, (1 - seam.own_share) * (1 - seam.t), sum);
    add(seam.after, (1 - seam.own_share) * seam.t, sum);
    merge(sum);
  }
  for (std::size_t s = 0; s < closed.size(); ++s) special_[mesh_.seams[s].node] = std::move(closed[s]);
}

/// As engine::hang: one after the other.
void NodeRows::hang() {
  for (const HangingNode& hanging : mesh_.hanging) {
    Row sum;
    add(hanging.before, 1 - hanging.t, sum);
    add(hanging.after, hanging.t, sum);
    merge(sum);
    special_[hanging.node] = std::move(sum);
  }
}

/// As engine::show_uncovered, where every patch counts the same.
void NodeRows::show_uncovered(const Uncovered& uncovered) {
  for (const std::uint32_t node : uncovered.nodes) {
    Row row;
    float below = 0;
    for (std::uint32_t k = mesh_.first_patch[node]; k < mesh_.first_patch[node + 1]; ++k) {
      const PatchId patch = mesh_.patches_around[k];
      if (uncovered.share[patch] == 0) continue;
      const float weight = node_weight(mesh_, patches_, patch);
      below += weight * uncovered.share[patch];
      row.push_back({patch, weight});
    }
    for (PatchWeight& part : row) part.weight /= below;
    special_[node] = std::move(row);
  }
}

PatchNodes nodes_of_patch(const ShadingMesh& mesh, const Patches& patches, PatchId patch) {
  const std::uint32_t f = patches.facet_of[patch], cell = patches.cell_of(patch);
  const Facet& facet = patches.facets[f];
  const CellCorners corners = cell_corners(facet, cell);
  const bool back = patches.is_back(patch);
  const std::uint32_t first = mesh.first_place[f] + (back ? place_count(facet) : 0);
  PatchNodes nodes{corners.count, {}};
  for (std::uint32_t c = 0; c < corners.count; ++c)
    nodes.node[back ? corners.count - 1 - c : c] = mesh.node_of[first + place_of(facet, cell, corners, c)];
  return nodes;
}

Vec3 position_of_node(const ShadingMesh& mesh, const Patches& patches, std::uint32_t node) {
  const PatchId patch = mesh.patches_around[mesh.first_patch[node]];
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  const CellCorners corners = cell_corners(facet, patches.cell_of(patch));
  const PatchNodes nodes = nodes_of_patch(mesh, patches, patch);
  for (std::uint32_t k = 0; k < nodes.count; ++k) {
    const std::uint32_t c = patches.is_back(patch) ? nodes.count - 1 - k : k;
    if (nodes.node[k] == node)
      return facet.origin + corners.u[c] * facet.edge_u + corners.v[c] * facet.edge_v;
  }
  return facet.origin;  // not reached: a node is a corner of the patches around it
}

}  // namespace engine
