// T_s as what differs from the scene at rest needs it.
#pragma once

#include <algorithm>

#include "engine/lighting/coarse_exchange.h"
#include "engine/lighting/lit_scene.h"

namespace engine {

/// Transport between patches at rest, without what moves, for all windows and groups of a replicate.
///
/// Why lines of its own: the light that it carries is what moving objects change, a few percent of all light
/// in most places, so that few lines do, and every one of them costs a row of all frames in each iteration.
struct RestTransport {
  TracedLines lines;  ///< traced without frames
  CoarseExchange coarse;

  RestTransport(const LitScene& lit, TracedLines traced)
      : lines(std::move(traced)), coarse(lit.patches, lines, reflectance_at_rest(lit)) {}
};

/// Lines of T_s for so many lines that see what moves: with half of them the variance that T_s adds was an
/// eighth of what moving objects make, and iterations were as few as with all. But some ten crossings per
/// patch, as far as there are `static_lines`: patches that lines show only each other pass their light to and
/// fro for long.
inline std::uint64_t rest_transport_lines(std::uint64_t moving_lines, std::uint64_t static_lines,
                                          std::uint32_t patches) {
  constexpr std::uint64_t kLinesPerPatch = 5;
  return std::max((moving_lines + 1) / 2, std::min(static_lines, kLinesPerPatch * patches));
}

/// Traces and sums up. Error: stopped.
inline api::Result<RestTransport> rest_transport(const LitScene& lit, const LineOptions& options,
                                                 const Progress& progress) {
  auto lines = trace_lines(lit.patches, lit.animation, lit.static_rays, {}, options, progress);
  if (!lines) return lines.error();
  return RestTransport(lit, std::move(*lines));
}

}  // namespace engine
