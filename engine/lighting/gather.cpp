#include "engine/lighting/gather.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <tuple>

#include "engine/base/parallel.h"
#include "engine/lighting/row_kernels.h"

namespace engine {
namespace {

constexpr std::uint32_t kRowsPerTask = 16;

/// Area-weighted mean over the patches on one side of some facets that a line did meet in `slot`.
class SideMean {
 public:
  SideMean(const Patches& patches, const CrossingCounts& crossings, const PatchSeries& series)
      : patches_(patches), crossings_(crossings), series_(series) {}

  void add(const Facet& facet, bool back, std::uint32_t slot) {
    const PatchId first = facet.first_patch + (back ? facet.cell_count() : 0);
    for (PatchId patch = first; patch < first + facet.cell_count(); ++patch) {
      if (crossings_.at(patch, slot) == 0) continue;
      sum_ += series_.at(patch, slot) * patches_.area_m2[patch];
      area_m2_ += patches_.area_m2[patch];
    }
  }
  bool known() const { return area_m2_ > 0; }
  Rgb value() const { return known() ? sum_ * (1.0f / area_m2_) : Rgb{}; }

 private:
  const Patches& patches_;
  const CrossingCounts& crossings_;
  const PatchSeries& series_;
  Rgb sum_;
  float area_m2_ = 0;
};

/// The mean of the polygon of `of`, on one side; where no line met any of it, that of its object.
Rgb stand_in(const Patches& patches, const TracedLines& lines, const PatchSeries& series, const Facet& of,
             bool back, std::uint32_t slot) {
  SideMean polygon(patches, lines.crossings, series), object(patches, lines.crossings, series);
  const auto same_polygon =
      std::equal_range(patches.facets.begin(), patches.facets.end(), of,
                       [](const Facet& a, const Facet& b) { return a.polygon < b.polygon; });
  for (auto facet = same_polygon.first; facet != same_polygon.second; ++facet)
    polygon.add(*facet, back, slot);
  if (polygon.known()) return polygon.value();
  for (const Facet& facet : patches.facets)
    if (facet.object == of.object) object.add(facet, back, slot);
  return object.value();
}

const float* floats(const Rgb* row) {
  return reinterpret_cast<const float*>(row);
}
float* floats(Rgb* row) {
  return reinterpret_cast<float*>(row);
}

}  // namespace

SampledOperator::SampledOperator(const Patches& patches, const TracedLines& lines)
    : patches_(patches), lines_(lines) {
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const SlotMask& present = lines.crossings.present[patches.facets[patches.facet_of[patch]].object];
    for (std::uint32_t slot = 0; slot < lines.slot_count; ++slot)
      if (present.test(slot) && lines.crossings.at(patch, slot) == 0) empty_rows_.push_back({patch, slot});
  }
}

bool SampledOperator::apply(const PatchSeries& radiosity, PatchSeries& irradiance,
                            const Progress& progress) const {
  const std::uint32_t count = patches_.count();
  std::atomic<bool> stopped = false;
  parallel_for((count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    if (stopped || progress.stop_requested()) {
      stopped = true;
      return;
    }
    const PatchId first = static_cast<PatchId>(task) * kRowsPerTask;
    for (PatchId patch = first; patch < std::min(first + kRowsPerTask, count); ++patch)
      gather_row(patch, radiosity, irradiance.row(patch));
  });
  if (!stopped) fill_empty_rows(irradiance);
  return !stopped;
}

void SampledOperator::gather_row(PatchId patch, const PatchSeries& radiosity, Rgb* out) const {
  const std::uint32_t slots = lines_.slot_count;
  std::fill_n(out, slots, Rgb{});
  add_rows(floats(out), floats(radiosity.values.data()), 3 * std::size_t{slots},
           lines_.static_rows.row(patch));
  for (const SlotExchange& change : lines_.moving_rows.row(patch)) {
    const std::size_t width = 3 * (std::size_t{change.last_slot} - change.first_slot + 1);
    add_scaled(floats(out + change.first_slot), floats(radiosity.row(change.sender) + change.first_slot),
               change.weight, width);
  }
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    const std::uint32_t crossings = lines_.crossings.at(patch, slot);
    out[slot] = crossings > 0 ? out[slot] * (1.0f / static_cast<float>(crossings)) : Rgb{};
  }
}

void SampledOperator::fill_empty_rows(PatchSeries& irradiance) const {
  std::map<std::tuple<std::uint32_t, bool, std::uint32_t>, Rgb> known;  // by polygon, side and slot
  for (const auto& [patch, slot] : empty_rows_) {
    const Facet& facet = patches_.facets[patches_.facet_of[patch]];
    const bool back = patches_.is_back(patch);
    const auto [mean, is_new] = known.try_emplace({facet.polygon, back, slot});
    if (is_new) mean->second = stand_in(patches_, lines_, irradiance, facet, back, slot);
    irradiance.at(patch, slot) = mean->second;
  }
}

}  // namespace engine
