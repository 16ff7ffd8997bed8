#include "engine/lighting/light_at_rest.h"

namespace engine {
namespace {

/// Tracing is about this share of the time, the solution the rest; progress only.
constexpr double kTracingShare = 0.7;

EmptyRows empty_rows_at_rest(const LitScene& lit, const TracedLines& lines) {
  EmptyRows empty;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch)
    if (lit.at_rest(patch) && lines.crossings.static_count[patch] == 0)
      empty.add(patch, lit.patches.area_m2[patch], lit.animation.frame_count);
  return empty;
}

}  // namespace

api::Result<std::vector<RestLight>> light_at_rest(const LitScene& lit, std::span<const GroupSource> groups,
                                                  const LineOptions& options, SolveCounts& counts,
                                                  const Progress& progress) {
  const auto transport = rest_transport(lit, options, part_of(progress, 0, kTracingShare));
  if (!transport) return transport.error();
  return light_at_rest(lit, groups, *transport, counts, part_of(progress, kTracingShare, 1));
}

api::Result<std::vector<RestLight>> light_at_rest(const LitScene& lit, std::span<const GroupSource> groups,
                                                  const RestTransport& transport, SolveCounts& counts,
                                                  const Progress& progress, double enough) {
  const TracedLines& lines = transport.lines;
  counts.tracing += lines.counts;
  counts.exchanges += lines.static_rows.entry_count();
  counts.empty_rows += empty_rows_at_rest(lit, lines);

  const std::vector<Rgb> reflectance = reflectance_at_rest(lit);
  std::vector<RestLight> at_rest;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto share = [&](std::size_t k) {
      return static_cast<double>(k) / static_cast<double>(groups.size());
    };
    auto light =
        solve_at_rest(lit.patches, lines, transport.coarse, source_at_rest(lit, groups[g], reflectance),
                      reflectance, part_of(progress, share(g), share(g + 1)), enough);
    if (!light) return light.error();
    counts.add(light->convergence);
    at_rest.push_back(std::move(*light));
  }
  return at_rest;
}

}  // namespace engine
