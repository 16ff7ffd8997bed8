// One independent set of lines, and the scene at rest as it shows it.
#pragma once

#include <span>
#include <vector>

#include "engine/lighting/rest_transport.h"
#include "engine/lighting/solve_at_rest.h"
#include "engine/lighting/sources.h"

namespace engine {

/// Lines of one replicate at most: bounds the memory that lines take, whatever their number.
inline constexpr std::uint64_t kLinesPerReplicateMax = 4'000'000;

/// Patches that are there and that no line met: they got no indirect light. Over all frames and replicates.
struct EmptyRows {
  std::uint64_t count = 0;
  double area_m2 = 0;
  PatchId largest = kNoPatch;
  float largest_m2 = 0;

  void add(PatchId patch, float patch_m2, std::uint32_t frames) {
    count += frames;
    area_m2 += double{patch_m2} * frames;
    if (patch_m2 > largest_m2) largest = patch, largest_m2 = patch_m2;
  }
  EmptyRows& operator+=(const EmptyRows& more) {
    count += more.count;
    area_m2 += more.area_m2;
    if (more.largest_m2 > largest_m2) largest = more.largest, largest_m2 = more.largest_m2;
    return *this;
  }
};

/// What was done, and what could not be done; over all lines of a job.
struct SolveCounts {
  TracingCounts tracing;        ///< static_hits: of the scene at rest; the rest of lines that see motion
  std::uint64_t exchanges = 0;  ///< of the scene at rest, equal ones merged
  std::uint64_t moving_exchanges = 0;  ///< that moving objects add or cut, equal ones merged
  EmptyRows empty_rows;
  std::uint32_t iterations = 0;  ///< of the solution that took most
  bool converged = true;         ///< every solution, see solve_at_rest

  void add(const Convergence& convergence) {
    iterations = std::max(iterations, convergence.iterations);
    converged = converged && convergence.converged;
  }
  SolveCounts& operator+=(const SolveCounts& more) {
    tracing += more.tracing;
    exchanges += more.exchanges;
    moving_exchanges += more.moving_exchanges;
    empty_rows += more.empty_rows;
    iterations = std::max(iterations, more.iterations);
    converged = converged && more.converged;
    return *this;
  }
};

/// Traces lines through the scene without what moves, and solves it for every group of lights.
/// Error: stopped.
api::Result<std::vector<RestLight>> light_at_rest(const LitScene& lit, std::span<const GroupSource> groups,
                                                  const LineOptions& options, SolveCounts& counts,
                                                  const Progress& progress);

/// The same on lines that are traced already. enough: see solve_at_rest.
api::Result<std::vector<RestLight>> light_at_rest(const LitScene& lit, std::span<const GroupSource> groups,
                                                  const RestTransport& transport, SolveCounts& counts,
                                                  const Progress& progress, double enough = kIterationError);

}  // namespace engine
