#include "engine/lighting/moving_light.h"

#include <algorithm>
#include <array>

#include "engine/lighting/convergence.h"

namespace engine {
namespace {

constexpr int kSweepsMax = 32;

}  // namespace

MovingLight::MovingLight(const TracedLines& lines, const Columns& columns,
                         std::span<const Rgb> rest_radiosity, const CarriedRows& rows)
    : lines_(lines), columns_(columns), rest_radiosity_(rest_radiosity), rows_(rows), begin_{0} {
  const auto& row_of = lines.crossings.moving_row;
  for (PatchId patch = 0; patch < row_of.size(); ++patch) {
    if (row_of[patch] == kNoPatch) continue;
    patches_.push_back(patch);
    for (const SlotExchange& exchange : lines.moving_rows.row(patch))
      if (row_of[exchange.sender] != kNoPatch) between_.push_back(exchange);
    begin_.push_back(between_.size());
  }
  from_rest_ = PatchSeries(static_cast<std::uint32_t>(patches_.size()), columns.count());
}

void MovingLight::gather_from_rest(const PatchSeries& r) {
  const auto& row_of = lines_.crossings.moving_row;
  for_each_patch(from_rest_.patch_count, {}, [&](std::uint32_t k) {
    Rgb* sum = from_rest_.row(k);
    std::fill_n(sum, columns_.count(), Rgb{});
    each_exchange(lines_.moving_rows.row(patches_[k]), r, columns_, [&](const SlotExchange& exchange) {
      if (row_of[exchange.sender] == kNoPatch)
        add_exchange(exchange, columns_, rest_radiosity_[exchange.sender], r.row(exchange.sender), sum);
    });
  });
}

float MovingLight::sweep(PatchSeries& difference, PatchSeries& r) const {
  std::vector<float> changes(patches_.size());
  for_each_patch(from_rest_.patch_count, {}, [&](std::uint32_t k) {
    const PatchId patch = patches_[k];
    Rgb* arriving = difference.row(patch);
    std::copy_n(from_rest_.row(k), columns_.count(), arriving);
    for (std::size_t e = begin_[k]; e < begin_[k + 1]; ++e)
      add_exchange(between_[e], columns_, {}, r.row(between_[e].sender), arriving);
    for (std::uint32_t c = 0; c < columns_.count(); ++c) {
      const std::uint32_t crossings = lines_.crossings.at(patch, columns_.slot(c));
      arriving[c] = crossings > 0 ? arriving[c] * (1.0f / static_cast<float>(crossings)) : Rgb{};
    }
  });
  for_each_patch(from_rest_.patch_count, {}, [&](std::uint32_t k) {
    const PatchId patch = patches_[k];
    std::array<Rgb, kWindowMax> next;
    rows_.radiosity_difference(patch, difference.row(patch), next.data());
    changes[k] = largest_change(r.row(patch), next.data(), columns_.count());
    std::copy_n(next.data(), columns_.count(), r.row(patch));
  });
  return changes.empty() ? 0 : *std::max_element(changes.begin(), changes.end());
}

float MovingLight::solve(float enough, PatchSeries& difference, PatchSeries& r) {
  gather_from_rest(r);
  float change = 0;
  for (int k = 0; k < kSweepsMax; ++k) {
    change = sweep(difference, r);
    if (change <= enough) break;
  }
  return change;
}

}  // namespace engine
