#include "engine/visibility/convex_solids.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace engine {
namespace {

constexpr std::size_t kFacetsMax = 64;

std::uint32_t corner_count(const Facet& facet) {
  return facet.is_triangle ? 3 : 4;
}

/// Facets that hang together by their corners, as a forest: parent[f] is another of the same, or itself.
class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t of(std::uint32_t f) {
    while (parent_[f] != f) f = parent_[f] = parent_[parent_[f]];
    return f;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

using Corner = std::tuple<std::uint32_t, float, float, float>;  // with the object

/// Numbers for corners; equal ones have one.
std::vector<std::array<std::uint32_t, 4>> number_corners(std::span<const Facet> facets) {
  std::vector<std::pair<Corner, std::uint32_t>> corners;
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    for (std::uint32_t c = 0; c < corner_count(facets[f]); ++c) {
      const Vec3 p = facets[f].corners[c];
      corners.push_back({{facets[f].object, p.x, p.y, p.z}, 4 * f + c});
    }
  std::sort(corners.begin(), corners.end());
  std::vector<std::array<std::uint32_t, 4>> numbers(facets.size());
  std::uint32_t number = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (k > 0 && corners[k].first != corners[k - 1].first) ++number;
    numbers[corners[k].second / 4][corners[k].second % 4] = number;
  }
  return numbers;
}

/// Is every edge met once in each direction?
bool is_closed(std::span<const Facet> facets, std::span<const std::uint32_t> part,
               const std::vector<std::array<std::uint32_t, 4>>& corners) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const std::uint32_t f : part) {
    const std::uint32_t count = corner_count(facets[f]);
    for (std::uint32_t c = 0; c < count; ++c) {
      const std::uint32_t a = corners[f][c], b = corners[f][(c + 1) % count];
      if (a == b || ++edges[{a, b}] > 1) return false;
    }
  }
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return edges.contains({edge.first.second, edge.first.first});
  });
}

bool is_convex(std::span<const Facet> facets, std::span<const std::uint32_t> part) {
  Vec3 lower = facets[part[0]].corners[0], upper = lower;
  for (const std::uint32_t f : part)
    for (std::uint32_t c = 0; c < corner_count(facets[f]); ++c) {
      lower = min(lower, facets[f].corners[c]);
      upper = max(upper, facets[f].corners[c]);
    }
  constexpr float kFlat = 1e-5f;  // of its size: what rounding makes of a plane
  const float flat_m = kFlat * length(upper - lower);
  for (const std::uint32_t f : part)
    for (const std::uint32_t other : part)
      for (std::uint32_t c = 0; c < corner_count(facets[other]); ++c)
        if (dot(facets[f].normal, facets[other].corners[c] - facets[f].corners[0]) > flat_m) return false;
  return true;
}

}  // namespace

std::vector<std::uint32_t> find_convex_solids(std::span<const Facet> facets) {
  const auto corners = number_corners(facets);
  Parts parts(facets.size());
  std::vector<std::uint32_t> first_of_corner(4 * facets.size(), kNoSolid);
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    for (std::uint32_t c = 0; c < corner_count(facets[f]); ++c) {
      std::uint32_t& first = first_of_corner[corners[f][c]];
      if (first == kNoSolid) first = f;
      parts.join(f, first);
    }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> by_part;
  for (std::uint32_t f = 0; f < facets.size(); ++f) by_part.emplace_back(parts.of(f), f);
  std::sort(by_part.begin(), by_part.end());

  std::vector<std::uint32_t> solids(facets.size(), kNoSolid);
  std::uint32_t number = 0;
  for (std::size_t k = 0; k < by_part.size();) {
    std::vector<std::uint32_t> part;
    const std::uint32_t root = by_part[k].first;
    for (; k < by_part.size() && by_part[k].first == root; ++k) part.push_back(by_part[k].second);
    if (part.size() < 4 || part.size() > kFacetsMax) continue;
    if (!is_convex(facets, part) || !is_closed(facets, part, corners)) continue;
    for (const std::uint32_t f : part) solids[f] = number;
    ++number;
  }
  return solids;
}

}  // namespace engine
