// Which settings `bench limit` tries: the table to change when the engine has become faster.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/bench/bench_job.h"
#include "engine/bench/bench_options.h"

namespace engine {

/// What quality is bought with.
struct LadderRung {
  std::uint32_t samples_per_light = 0;
  std::uint64_t line_count = 0, moving_line_count = 0;
};

/// "4/2M/0.5M": samples per light, lines, lines that see moving objects.
std::string name_of(const LadderRung& rung);

/// From cheap to dear, as far as that is known beforehand. All frames at once.
std::span<const LadderRung> sequence_ladder(bool quick);
/// The same for frames one by one; all lines see moving objects.
std::span<const LadderRung> alone_ladder(bool quick);
/// Of each of the two halves of the converged solution.
LadderRung converged_half(bool quick);

/// The errors that time is asked for, the larger one first: RMSE over mean radiosity.
struct ErrorBars {
  double rough = 0.025, fine = 0.012;
};
/// Quick: what large patches and few lines can reach.
ErrorBars error_bars(bool quick);

/// Mode `reference`, without standard errors and images: the garage in patches of at most .035 m^2, 43,630.
BenchJob limit_job(const std::string& what, const LadderRung& rung, const BenchOptions& options);

}  // namespace engine
