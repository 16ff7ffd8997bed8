#include "engine/image/weld.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

constexpr float kCosOneDegree = 0.99984770f;

std::vector<float> largest_coordinates(const Patches& patches) {
  std::vector<float> largest;
  for (const Facet& facet : patches.facets) {
    if (facet.object >= largest.size()) largest.resize(facet.object + 1);
    float& of_object = largest[facet.object];
    for (const Vec3 p : {facet.origin, facet.origin + facet.edge_u, facet.origin + facet.edge_v})
      of_object = std::max({of_object, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return largest;
}

bool matches(const WeldPoint& a, const WeldPoint& b, float tolerance_m) {
  return a.object == b.object && a.material == b.material && dot(a.normal, b.normal) >= kCosOneDegree &&
         length(a.position - b.position) <= tolerance_m;
}

}  // namespace

// 8 units in the last place: a point computed from two facets differs by 2 or 3.
Welder::Welder(const Patches& patches) : tolerance_m_(largest_coordinates(patches)) {
  for (float& tolerance_m : tolerance_m_) tolerance_m = std::max(8 * 1.2e-7f * tolerance_m, 1e-30f);
}

std::size_t Welder::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = (std::uint64_t{cell.object} << 32 | cell.material) * 0x9e3779b97f4a7c15u;
  for (const std::int64_t c : cell.at) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u;
  return hash ^ hash >> 32;
}

Welder::Cell Welder::cell_at(const WeldPoint& point, Vec3 p) const {
  const float size_m = 4 * tolerance_m_[point.object];
  const auto index = [&](float x) { return static_cast<std::int64_t>(std::floor(x / size_m)); };
  return {{index(p.x), index(p.y), index(p.z)}, point.object, point.material};
}

std::uint32_t Welder::find(const Cell& cell, const WeldPoint& point) const {
  const auto first = first_in_cell_.find(cell);
  if (first == first_in_cell_.end()) return kNone;
  for (std::uint32_t k = first->second; k != kNone; k = seen_[k].next)
    if (matches(seen_[k].point, point, tolerance_m_[point.object])) return seen_[k].node;
  return kNone;
}

std::uint32_t Welder::node_at(const WeldPoint& point, std::uint32_t new_node) {
  const float tolerance_m = tolerance_m_[point.object];
  const Vec3 reach{tolerance_m, tolerance_m, tolerance_m};
  const Cell low = cell_at(point, point.position - reach), high = cell_at(point, point.position + reach);
  Cell cell = low;
  for (cell.at[2] = low.at[2]; cell.at[2] <= high.at[2]; ++cell.at[2])
    for (cell.at[1] = low.at[1]; cell.at[1] <= high.at[1]; ++cell.at[1])
      for (cell.at[0] = low.at[0]; cell.at[0] <= high.at[0]; ++cell.at[0])
        if (const std::uint32_t node = find(cell, point); node != kNone) return node;
  const auto [entry, is_new] = first_in_cell_.try_emplace(cell_at(point, point.position), kNone);
  seen_.push_back({point, new_node, entry->second});
  entry->second = static_cast<std::uint32_t>(seen_.size() - 1);
  return new_node;
}

}  // namespace engine
