// The sampled operator: what every patch receives from the patches that lines say it sees.
#pragma once

#include <vector>

#include "engine/lighting/empty_rows.h"
#include "engine/lighting/radiosity.h"
#include "engine/lines/trace_lines.h"

namespace engine {

/// T of H = T B, sampled by global lines and divided by actual crossings:
///
///     H_i = 1 / n_i  sum_j n_ij B_j                                          [W/m^2]
///
/// n_i  crossings of patch i        n_ij  those whose next surface on i's side is the front of j
///
/// Why the actual and not the expected crossings: conditionally on n_i each crossing is a cosine-distributed
/// ray, so the ratio is unbiased and has no variance where B is uniform (the furnace).
class SampledOperator {
 public:
  SampledOperator(const Patches& patches, const TracedLines& lines);

  /// H = T B. Each row is summed by one thread in a fixed order: the same bytes for any thread count. False,
  /// and `irradiance` is unfinished, where it was told to stop.
  bool apply(const PatchSeries& radiosity, PatchSeries& irradiance, const Progress& progress) const;

  /// Rows that no line met; apply() gives them the mean of their polygon (else of their object, else 0).
  const std::vector<EmptyRow>& empty_rows() const { return empty_rows_.rows(); }

 private:
  void gather_row(PatchId patch, const PatchSeries& radiosity, Rgb* out) const;

  const Patches& patches_;
  const TracedLines& lines_;
  const EmptyRows empty_rows_;
};

}  // namespace engine
