// The converged solution that errors are measured against.
#pragma once

#include <span>
#include <vector>

#include "engine/bench/bench_runner.h"
#include "engine/bench/limit_bench.h"
#include "engine/bench/sequence_error.h"

namespace engine {

/// Root mean square errors over the mean radiosity of all patches that do not emit, area-weighted, all frames
/// that were compared. total^2 is the mean of the other two's squares, weighted by their areas.
struct LimitError {
  double total = 0, at_rest = 0, moving = 0;
};

struct LimitReference {
  std::filesystem::path radiosity;  ///< .npy, the mean of two halves of different seeds
  std::vector<PatchWeights> sets;   ///< all patches that do not emit; of these those at rest; those that move
  LimitError noise;                 ///< of `radiosity` itself: half the difference of its halves
};

/// Renders the halves, once for all programs, and joins them. Errors: of the jobs.
api::Result<LimitReference> make_reference(LimitBench& bench);

/// `frames`: as for compare_sequences.
api::Result<LimitError> error_against(const LimitReference& reference, const BenchRun& run,
                                      std::span<const FramePair> frames = {});
api::Result<LimitError> error_between(const LimitReference& reference, const BenchRun& run,
                                      const std::filesystem::path& other);

}  // namespace engine
