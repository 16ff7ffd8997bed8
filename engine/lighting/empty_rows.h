// Rows of the operator that no line met, and what stands in for them.
#pragma once

#include <vector>

#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// A patch that is there in a slot, and that no line met.
struct EmptyRow {
  PatchId patch = 0;
  std::uint32_t slot = 0;
};

/// Gives each of them the area-weighted mean of the patches that lines did meet on its side of its polygon;
/// where there are none in that slot, on its side of its object; else 0.
class EmptyRows {
 public:
  EmptyRows(const Patches& patches, const TracedLines& lines);

  const std::vector<EmptyRow>& rows() const { return rows_; }

  /// Cost: one read of the rows of all polygons (objects) that have empty rows. From several threads, the
  /// same bytes for any number of them.
  void fill(PatchSeries& irradiance) const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  /// One side of a polygon or an object: the patches whose mean stands in.
  struct Side {
    std::vector<PatchId> first_patch;  ///< of each facet
    std::vector<std::uint32_t> cells;  ///< of each facet
  };

  void add_facet(Side& side, const Facet& facet, bool back) const;
  bool is_met(const Side& side, std::uint32_t slot) const;
  std::vector<Rgb> means(const Side& side, const PatchSeries& irradiance) const;
  void choose_sides();

  const Patches& patches_;
  const TracedLines& lines_;
  std::vector<EmptyRow> rows_;
  std::vector<std::uint32_t> side_of_row_;  ///< into sides_, or kNone
  std::vector<Side> sides_;
};

}  // namespace engine
