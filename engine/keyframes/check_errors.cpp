#include "engine/keyframes/check_errors.h"

#include <algorithm>
#include <cmath>

#include "engine/interpolate/interpolate.h"
#include "engine/lighting/gather.h"

namespace engine {
namespace {

std::vector<std::uint32_t> positions(std::span<const FrameIndex> wanted, std::span<const FrameIndex> other) {
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto before = std::lower_bound(other.begin(), other.end(), wanted[k]) - other.begin();
    found.push_back(static_cast<std::uint32_t>(k) + static_cast<std::uint32_t>(before));
  }
  return found;
}

}  // namespace

PatchSeries left_out(const LitScene& lit, std::span<const LitGroup> groups,
                     std::span<const PatchSeries* const> interpolated, std::span<const FrameIndex> keys,
                     std::span<const FrameIndex> checks, api::Interpolation interpolation) {
  const Interpolator interpolator(keys, checks, interpolation);
  const auto at_keys = positions(keys, checks), at_checks = positions(checks, keys);
  PatchSeries missed(lit.patches.count(), static_cast<std::uint32_t>(checks.size()));
  for_each_patch(missed.patch_count, {}, [&](PatchId patch) {
    std::vector<Rgb> known(keys.size()), found(checks.size());
    for (std::size_t g = 0; g < interpolated.size(); ++g) {
      const Rgb* row = interpolated[g]->row(patch);
      for (std::size_t k = 0; k < keys.size(); ++k) known[k] = row[at_keys[k]];
      interpolator.apply(known.data(), found.data());
      for (std::size_t c = 0; c < checks.size(); ++c) {
        const Rgb by = found[c] - row[at_checks[c]];
        missed.row(patch)[c] += groups.empty() ? by
                                               : lit.reflectance(patch, checks[c]) *
                                                     in_frame(groups[g].group.scale, checks[c]) * by;
      }
    }
  });
  return missed;
}

std::vector<double> check_errors(const LitScene& lit, const ReplicateMean& missed,
                                 const CheckedRadiosity& radiosity) {
  const bool has_noise = missed.count() > 1;
  const PatchSeries variance = has_noise ? missed.variance() : PatchSeries();
  const std::uint32_t checks = missed.mean().frame_count;
  std::vector<double> largest(checks, 0.0);
  for (const Facet& facet : lit.patches.facets)
    for (std::uint32_t c = 0; c < checks; ++c) {
      Rgb of_facet;
      const PatchId end = facet.first_patch + facet.patch_count();
      for (PatchId patch = facet.first_patch; has_noise && patch < end; ++patch)
        of_facet += variance.at(patch, c) * (1.0f / static_cast<float>(facet.patch_count()));
      for (PatchId patch = facet.first_patch; patch < end; ++patch) {
        const Rgb by = missed.mean().at(patch, c);
        const Rgb noise = has_noise ? variance.at(patch, c) : Rgb{};
        const auto beyond = [&](float m, float own, float facets) {
          return std::abs(m) - kCheckSignificance * std::sqrt(std::max(own, facets));
        };
        const double over = std::max({beyond(by.r, noise.r, of_facet.r), beyond(by.g, noise.g, of_facet.g),
                                      beyond(by.b, noise.b, of_facet.b)});
        const double against =
            std::max(double{max_channel(radiosity.at_checks_w_m2.at(patch, c))}, 0.5 * radiosity.mean_w_m2);
        if (against > 0) largest[c] = std::max(largest[c], over / against);
      }
    }
  return largest;
}

bool split(KeyFrames& chosen, const std::vector<bool>& bad) {
  const std::vector<FrameIndex> keys = std::move(chosen.keys), checks = std::move(chosen.checks);
  chosen.keys = {keys.front()};
  chosen.checks.clear();
  bool changed = false;
  std::size_t next = 0;  // check
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const std::size_t first = next;
    while (next < checks.size() && checks[next] < keys[k]) ++next;
    const bool has_more = keys[k] - keys[k - 1] - 1 > next - first;  // frames between than checks
    const bool is_bad =
        has_more && std::any_of(bad.begin() + static_cast<std::ptrdiff_t>(first),
                                bad.begin() + static_cast<std::ptrdiff_t>(next), [](bool b) { return b; });
    for (std::size_t c = first; c < next; ++c) (is_bad ? chosen.keys : chosen.checks).push_back(checks[c]);
    chosen.keys.push_back(keys[k]);
    for (std::size_t c = first; is_bad && c <= next; ++c) {
      const FrameIndex a = c == first ? keys[k - 1] : checks[c - 1], b = c == next ? keys[k] : checks[c];
      for (const FrameIndex check : checks_between(a, b)) chosen.checks.push_back(check);
    }
    changed = changed || is_bad;
  }
  merge_solved(chosen);
  return changed;
}

}  // namespace engine
