#include "engine/image/weld.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

constexpr float kCosOneDegree = 0.99984770f;

float largest_coordinate(const Patches& patches) {
  float largest = 0;
  for (const Facet& facet : patches.facets)
    for (const Vec3 p : {facet.origin, facet.origin + facet.edge_u, facet.origin + facet.edge_v})
      largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

bool matches(const WeldPoint& a, const WeldPoint& b, float tolerance_m) {
  return a.object == b.object && a.material == b.material && dot(a.normal, b.normal) >= kCosOneDegree &&
         length(a.position - b.position) <= tolerance_m;
}

}  // namespace

// 8 units in the last place: a point computed from two facets differs by 2 or 3.
Welder::Welder(const Patches& patches)
    : tolerance_m_(std::max(8 * 1.2e-7f * largest_coordinate(patches), 1e-30f)) {}

std::size_t Welder::CellHash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t c : cell) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u;
  return hash ^ hash >> 32;
}

Welder::Cell Welder::cell_at(Vec3 p) const {
  const float size_m = 4 * tolerance_m_;
  const auto index = [&](float x) { return static_cast<std::int64_t>(std::floor(x / size_m)); };
  return {index(p.x), index(p.y), index(p.z)};
}

std::uint32_t Welder::find(const Cell& cell, const WeldPoint& point) const {
  const auto first = first_in_cell_.find(cell);
  if (first == first_in_cell_.end()) return kNone;
  for (std::uint32_t k = first->second; k != kNone; k = seen_[k].next)
    if (matches(seen_[k].point, point, tolerance_m_)) return seen_[k].node;
  return kNone;
}

std::uint32_t Welder::node_at(const WeldPoint& point, std::uint32_t new_node) {
  const Vec3 reach{tolerance_m_, tolerance_m_, tolerance_m_};
  const Cell low = cell_at(point.position - reach), high = cell_at(point.position + reach);
  for (std::int64_t z = low[2]; z <= high[2]; ++z)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t x = low[0]; x <= high[0]; ++x)
        if (const std::uint32_t node = find({x, y, z}, point); node != kNone) return node;
  const auto [entry, is_new] = first_in_cell_.try_emplace(cell_at(point.position), kNone);
  seen_.push_back({point, new_node, entry->second});
  entry->second = static_cast<std::uint32_t>(seen_.size() - 1);
  return new_node;
}

}  // namespace engine
