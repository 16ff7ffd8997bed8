#include "engine/lighting/empty_rows.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/parallel.h"

namespace engine {

EmptyRows::EmptyRows(const Patches& patches, const TracedLines& lines) : patches_(patches), lines_(lines) {
  for (PatchId patch = 0; patch < patches.count(); ++patch) {
    const SlotMask& present = lines.crossings.present[patches.facets[patches.facet_of[patch]].object];
    for (std::uint32_t slot = 0; slot < lines.slot_count; ++slot)
      if (present.test(slot) && lines.crossings.at(patch, slot) == 0) rows_.push_back({patch, slot});
  }
  choose_sides();
}

void EmptyRows::add_facet(Side& side, const Facet& facet, bool back) const {
  if (back && !facet.both_sides) return;
  side.first_patch.push_back(facet.first_patch + (back ? facet.cell_count() : 0));
  side.cells.push_back(facet.cell_count());
}

bool EmptyRows::is_met(const Side& side, std::uint32_t slot) const {
  for (std::size_t f = 0; f < side.cells.size(); ++f)
    for (std::uint32_t cell = 0; cell < side.cells[f]; ++cell)
      if (lines_.crossings.at(side.first_patch[f] + cell, slot) > 0) return true;
  return false;
}

void EmptyRows::choose_sides() {
  using Key = std::pair<std::uint32_t, bool>;  // polygon or object, back
  std::map<Key, std::uint32_t> polygon_sides, object_sides;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> met;  // by side and slot
  const auto side_at = [&](std::map<Key, std::uint32_t>& known, Key key, auto&& facets_of_key) {
    const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(sides_.size()));
    if (is_new) facets_of_key(sides_.emplace_back());
    return entry->second;
  };
  const auto is_met_in = [&](std::uint32_t side, std::uint32_t slot) {
    const auto [entry, is_new] = met.try_emplace({side, slot}, false);
    if (is_new) entry->second = is_met(sides_[side], slot);
    return entry->second;
  };
  for (const auto& [patch, slot] : rows_) {
    const Facet& own = patches_.facets[patches_.facet_of[patch]];
    const bool back = patches_.is_back(patch);
    const std::uint32_t polygon = side_at(polygon_sides, {own.polygon, back}, [&](Side& side) {
      const auto same =
          std::equal_range(patches_.facets.begin(), patches_.facets.end(), own,
                           [](const Facet& a, const Facet& b) { return a.polygon < b.polygon; });
      for (auto facet = same.first; facet != same.second; ++facet) add_facet(side, *facet, back);
    });
    if (is_met_in(polygon, slot)) {
      side_of_row_.push_back(polygon);
      continue;
    }
    const std::uint32_t object = side_at(object_sides, {own.object, back}, [&](Side& side) {
      for (const Facet& facet : patches_.facets)
        if (facet.object == own.object) add_facet(side, facet, back);
    });
    side_of_row_.push_back(is_met_in(object, slot) ? object : kNone);
  }
}

std::vector<Rgb> EmptyRows::means(const Side& side, const PatchSeries& irradiance) const {
  std::vector<Rgb> sum(lines_.slot_count);
  std::vector<float> area_m2(lines_.slot_count, 0.0f);
  for (std::size_t f = 0; f < side.cells.size(); ++f)
    for (PatchId patch = side.first_patch[f]; patch < side.first_patch[f] + side.cells[f]; ++patch)
      for (std::uint32_t slot = 0; slot < lines_.slot_count; ++slot) {
        if (lines_.crossings.at(patch, slot) == 0) continue;
        sum[slot] += irradiance.at(patch, slot) * patches_.area_m2[patch];
        area_m2[slot] += patches_.area_m2[patch];
      }
  for (std::uint32_t slot = 0; slot < lines_.slot_count; ++slot)
    sum[slot] = area_m2[slot] > 0 ? sum[slot] * (1.0f / area_m2[slot]) : Rgb{};
  return sum;
}

void EmptyRows::fill(PatchSeries& irradiance) const {
  if (rows_.empty()) return;
  std::vector<bool> wanted(sides_.size(), false);
  for (const std::uint32_t side : side_of_row_)
    if (side != kNone) wanted[side] = true;
  std::vector<std::vector<Rgb>> known(sides_.size());
  parallel_for(sides_.size(), [&](std::size_t side) {
    if (wanted[side]) known[side] = means(sides_[side], irradiance);
  });
  for (std::size_t k = 0; k < rows_.size(); ++k)
    irradiance.at(rows_[k].patch, rows_[k].slot) =
        side_of_row_[k] == kNone ? Rgb{} : known[side_of_row_[k]][rows_[k].slot];
}

}  // namespace engine
