#include "engine/lighting/compose.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/lighting/gather.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// [object][position in `frames`]: is it there?
std::vector<std::vector<bool>> presence(const Animation& animation, std::span<const FrameIndex> frames) {
  std::vector<std::vector<bool>> there(animation.objects.size(), std::vector<bool>(frames.size(), false));
  for (std::size_t object = 0; object < there.size(); ++object)
    for (const PlacedRange& range : placed_ranges(animation.objects[object], frames))
      std::fill(there[object].begin() + range.first_slot, there[object].begin() + range.last_slot + 1, true);
  return there;
}

/// Replaces every value by make(patch, position, value) where the patch's object is there, by 0 elsewhere.
template <class Make>
void replace(const LitScene& lit, std::span<const FrameIndex> frames, PatchSeries& series, Make&& make) {
  const auto there = presence(lit.animation, frames);
  for_each_patch(series.patch_count, {}, [&](PatchId patch) {
    const auto& present = there[lit.patches.facets[lit.patches.facet_of[patch]].object];
    Rgb* row = series.row(patch);
    for (std::uint32_t k = 0; k < frames.size(); ++k) row[k] = present[k] ? make(patch, k, row[k]) : Rgb{};
  });
}

/// Of frames[k] in direct light that is known in `frames`, or in every frame of the animation.
std::uint32_t column_of(const PatchSeries& direct, std::span<const FrameIndex> frames, std::uint32_t k) {
  return direct.frame_count == frames.size() ? k : frames[k];
}

Rgb square_root(Rgb value) {
  return {std::sqrt(std::max(0.0f, value.r)), std::sqrt(std::max(0.0f, value.g)),
          std::sqrt(std::max(0.0f, value.b))};
}

}  // namespace

std::vector<const LitGroup*> pointers_to(const std::vector<LitGroup>& groups) {
  std::vector<const LitGroup*> pointers;
  for (const LitGroup& group : groups) pointers.push_back(&group);
  return pointers;
}

void add_scaled(const LightGroup& group, const PatchSeries& part, std::span<const FrameIndex> frames,
                PatchSeries& sum) {
  for_each_patch(sum.patch_count, {}, [&](PatchId patch) {
    const Rgb* from = part.row(patch);
    Rgb* to = sum.row(patch);
    for (std::uint32_t k = 0; k < frames.size(); ++k) to[k] += in_frame(group.scale, frames[k]) * from[k];
  });
}

void add_direct_irradiance(std::span<const LitGroup* const> groups, std::span<const FrameIndex> frames,
                           PatchSeries& sum) {
  for (const LitGroup* lit : groups) {
    const PatchSeries& direct = lit->direct.irradiance_w_m2;
    if (direct.values.empty()) continue;
    for_each_patch(sum.patch_count, {}, [&](PatchId patch) {
      for (std::uint32_t k = 0; k < frames.size(); ++k)
        sum.at(patch, k) +=
            in_frame(lit->group.scale, frames[k]) * direct.at(patch, column_of(direct, frames, k));
    });
  }
}

void to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                  std::span<const FrameIndex> frames, PatchSeries& irradiance) {
  replace(lit, frames, irradiance, [&](PatchId patch, std::uint32_t k, Rgb arriving) {
    Rgb exitance;
    for (const LitGroup* group : groups)
      exitance +=
          in_frame(group->group.scale, frames[k]) * lit.exitance(group->group.emission, patch, frames[k]);
    return exitance + lit.reflectance(patch, frames[k]) * arriving;
  });
}

void add_direct_to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                             std::span<const FrameIndex> frames, PatchSeries& indirect) {
  add_direct_irradiance(groups, frames, indirect);
  to_radiosity(lit, groups, frames, indirect);
}

void to_standard_error(const LitScene& lit, std::span<const LitGroup* const> groups,
                       std::span<const FrameIndex> frames, PatchSeries& variance) {
  replace(lit, frames, variance, [&](PatchId patch, std::uint32_t k, Rgb sum) {
    for (const LitGroup* group : groups) {
      const PatchSeries& variance_of = group->direct.variance;
      if (variance_of.values.empty()) continue;
      const Rgb scale = in_frame(group->group.scale, frames[k]);
      sum += scale * scale * variance_of.at(patch, column_of(variance_of, frames, k));
    }
    return lit.reflectance(patch, frames[k]) * square_root(sum);
  });
}

bool ever_emits(const LitScene& lit, PatchId patch) {
  return !lit.patches.is_back(patch) && lit.animation.emission.ever_emits(lit.material_of(patch));
}

double mean_radiosity(const LitScene& lit, const PatchSeries& radiosity_w_m2) {
  double sum = 0, area = 0;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (ever_emits(lit, patch)) continue;
    double of_patch = 0;
    for (std::uint32_t k = 0; k < radiosity_w_m2.frame_count; ++k)
      of_patch += double{max_channel(radiosity_w_m2.at(patch, k))};
    sum += lit.patches.area_m2[patch] * of_patch;
    area += double{lit.patches.area_m2[patch]} * radiosity_w_m2.frame_count;
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace engine
