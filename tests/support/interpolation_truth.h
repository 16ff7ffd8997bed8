// What interpolating a sequence really costs: against the same job with every frame solved.
#pragma once

#include <string>
#include <vector>

#include "engine/pipeline/solve_sequence.h"
#include "tests/support/lit.h"

namespace tests {

/// Solves a sequence as `options` say; the end of the test program where that fails.
engine::SolvedSequence solve(const ReadyScene& ready, const api::LightingOptions& options);

/// Errors of every patch and frame, the moving ones too (emitters and what is not there are exact):
///
///     e(i, f) = max_c | B^ - B | / max(max_c B(i, f), mean B / 2)            [-]
///
/// mean B: area-weighted over patches that never emit, and frames.
struct InterpolationTruth {
  double largest = 0;
  double root_mean_square = 0;   ///< of max_c | B^ - B | over area and frames, relative to the mean B
  double above = 0;              ///< share of patches and frames beyond the tolerance
  std::vector<double> of_frame;  ///< largest, [frame]
  std::size_t keys = 0;          ///< chosen by the estimate
  std::size_t solved = 0;        ///< those, and the frames that check them
  /// Intervals of the report with a frame beyond the tolerance that are not said to be broken, and those said
  /// to be broken in which every frame is within.
  std::vector<std::string> unnamed, named_in_vain;
};

InterpolationTruth interpolation_truth(const ReadyScene& ready, const engine::SolvedSequence& found,
                                       const engine::SolvedSequence& reference, double tolerance);

}  // namespace tests
