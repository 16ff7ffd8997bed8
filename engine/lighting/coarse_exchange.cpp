#include "engine/lighting/coarse_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/parallel.h"

namespace engine {
namespace {

/// Where a patch is and where it looks: what is near in it exchanges light with much the same patches.
using Place = std::array<float, 6>;

/// Turning round counts as much as this part of the scene's size.
constexpr float kTurnOfSize = 0.5f;

std::vector<Place> places_of(const Patches& patches, std::span<const PatchId> order) {
  std::vector<Place> places(patches.count());
  Vec3 lower{1e30f, 1e30f, 1e30f}, upper = -lower;
  for (const PatchId patch : order) {
    const Facet& facet = patches.facets[patches.facet_of[patch]];
    const CellCorners cell = cell_corners(facet, patches.cell_of(patch));
    const Vec3 at = facet.origin + cell.u[0] * facet.edge_u + cell.v[0] * facet.edge_v;
    const Vec3 normal = patches.is_back(patch) ? -facet.normal : facet.normal;
    places[patch] = {at.x, at.y, at.z, normal.x, normal.y, normal.z};
    lower = min(lower, at);
    upper = max(upper, at);
  }
  const float turn = order.empty() ? 0 : 0.5f * kTurnOfSize * length(upper - lower);
  for (const PatchId patch : order)
    for (std::size_t k = 3; k < 6; ++k) places[patch][k] *= turn;
  return places;
}

std::size_t widest_axis(const std::vector<Place>& places, std::span<const PatchId> part) {
  Place lower = places[part[0]], upper = lower;
  for (const PatchId patch : part)
    for (std::size_t k = 0; k < lower.size(); ++k) {
      lower[k] = std::min(lower[k], places[patch][k]);
      upper[k] = std::max(upper[k], places[patch][k]);
    }
  std::size_t widest = 0;
  for (std::size_t k = 1; k < lower.size(); ++k)
    if (upper[k] - lower[k] > upper[widest] - lower[widest]) widest = k;
  return widest;
}

/// Halves `part` across its widest axis until there are `groups`; appends where each ends.
void halve(const std::vector<Place>& places, std::span<PatchId> part, std::uint32_t groups,
           std::vector<std::uint32_t>& ends) {
  if (groups == 1) {
    ends.push_back(ends.back() + static_cast<std::uint32_t>(part.size()));
    return;
  }
  const std::size_t axis = widest_axis(places, part);
  const std::uint32_t below = groups / 2;
  const std::size_t middle = part.size() * below / groups;
  std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                   [&](PatchId a, PatchId b) {
                     return places[a][axis] != places[b][axis] ? places[a][axis] < places[b][axis] : a < b;
                   });
  halve(places, part.first(middle), below, ends);
  halve(places, part.subspan(middle), groups - below, ends);
}

/// One channel of a square matrix K becomes (1 - K)^-1 K. Rows of K sum to rho < 1, so that 1 - K is
/// diagonally dominant and needs no pivots.
void invert(std::vector<double>& k, std::size_t size) {
  std::vector<double>& a = k;  // 1 - K, inverted in place
  for (double& value : a) value = -value;
  for (std::size_t g = 0; g < size; ++g) a[g * size + g] += 1;
  for (std::size_t pivot = 0; pivot < size; ++pivot) {
    double* of_pivot = &a[pivot * size];
    const double scale = 1 / of_pivot[pivot];
    of_pivot[pivot] = 1;
    for (std::size_t c = 0; c < size; ++c) of_pivot[c] *= scale;
    for (std::size_t row = 0; row < size; ++row) {
      if (row == pivot) continue;
      double* to = &a[row * size];
      const double factor = to[pivot];
      to[pivot] = 0;
      for (std::size_t c = 0; c < size; ++c) to[c] -= factor * of_pivot[c];
    }
  }
  for (std::size_t g = 0; g < size; ++g) a[g * size + g] -= 1;  // (1 - K)^-1 K = (1 - K)^-1 - 1
}

}  // namespace

CoarseExchange::CoarseExchange(const Patches& patches, const TracedLines& lines,
                               std::span<const Rgb> reflectance)
    : share_(patches.count()) {
  make_groups(patches, lines);
  find_exchange(lines, reflectance);
}

void CoarseExchange::make_groups(const Patches& patches, const TracedLines& lines) {
  for (PatchId patch = 0; patch < patches.count(); ++patch)
    (lines.crossings.static_count[patch] > 0 ? order_ : others_).push_back(patch);
  begin_ = {0};
  if (order_.empty()) return;
  const auto patches_at_rest = static_cast<std::uint32_t>(order_.size());
  const auto groups =
      std::clamp(patches_at_rest / kPatchesPerGroup, std::min(kGroupsMin, patches_at_rest), kGroupsMax);
  halve(places_of(patches, order_), order_, groups, begin_);
  for (std::uint32_t group = 0; group < groups; ++group) {
    const auto of_group = members(group);
    // In the order of their numbers neighbours follow one another, and so do their rows.
    std::sort(order_.begin() + begin_[group], order_.begin() + begin_[group + 1]);
    double area = 0;
    for (const PatchId patch : of_group) area += patches.area_m2[patch];
    for (const PatchId patch : of_group) share_[patch] = static_cast<float>(patches.area_m2[patch] / area);
  }
}

void CoarseExchange::find_exchange(const TracedLines& lines, std::span<const Rgb> reflectance) {
  const std::size_t groups = group_count();
  std::vector<std::uint32_t> group_of(share_.size(), 0);  // of no group: never a sender
  for (std::uint32_t group = 0; group < groups; ++group)
    for (const PatchId patch : members(group)) group_of[patch] = group;
  std::array<std::vector<double>, 3> channels;
  for (auto& channel : channels) channel.assign(groups * groups, 0.0);
  parallel_for(groups, [&](std::size_t group) {
    std::vector<double> seen(groups);
    for (const PatchId patch : members(static_cast<std::uint32_t>(group))) {
      std::fill(seen.begin(), seen.end(), 0.0);
      for (const Exchange& exchange : lines.static_rows.row(patch))
        seen[group_of[exchange.sender()]] += exchange.count();
      const double weight = share_[patch] / static_cast<double>(lines.crossings.static_count[patch]);
      const Rgb rho = reflectance[patch];
      for (std::size_t sender = 0; sender < groups; ++sender) {
        channels[0][group * groups + sender] += weight * rho.r * seen[sender];
        channels[1][group * groups + sender] += weight * rho.g * seen[sender];
        channels[2][group * groups + sender] += weight * rho.b * seen[sender];
      }
    }
  });
  parallel_for(channels.size(), [&](std::size_t c) { invert(channels[c], groups); });
  matrix_.resize(groups * groups);
  for (std::size_t k = 0; k < matrix_.size(); ++k)
    matrix_[k] = {static_cast<float>(channels[0][k]), static_cast<float>(channels[1][k]),
                  static_cast<float>(channels[2][k])};
}

PatchSeries CoarseExchange::correction(const PatchSeries& residual) const {
  PatchSeries correction(residual.patch_count, residual.frame_count);
  const std::size_t groups = group_count();
  parallel_for(groups, [&](std::size_t group) {
    Rgb* to = correction.row(static_cast<std::uint32_t>(group));
    for (std::uint32_t sender = 0; sender < groups; ++sender) {
      const Rgb weight = matrix_[group * groups + sender];
      const Rgb* from = residual.row(sender);
      for (std::uint32_t c = 0; c < residual.frame_count; ++c) to[c] += weight * from[c];
    }
  });
  return correction;
}

float largest_value(const PatchSeries& series) {
  float largest = 0, nothing = 0;
  for (const Rgb& value : series.values) {
    largest = std::max({largest, std::abs(value.r), std::abs(value.g), std::abs(value.b)});
    nothing += 0.0f * (value.r + value.g + value.b);  // of what is infinite or no number: no number
  }
  return largest + nothing;
}

}  // namespace engine
