#include "engine/lighting/compose.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/lighting/gather.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// [object][position in `frames`]: is it there? Empty where it always is.
std::vector<std::vector<bool>> presence(const Animation& animation, std::span<const FrameIndex> frames) {
  std::vector<std::vector<bool>> there(animation.objects.size());
  for (std::size_t object = 0; object < there.size(); ++object) {
    there[object].assign(frames.size(), false);
    for (const PlacedRange& range : placed_ranges(animation.objects[object], frames))
      std::fill(there[object].begin() + range.first_slot, there[object].begin() + range.last_slot + 1, true);
    if (std::find(there[object].begin(), there[object].end(), false) == there[object].end())
      there[object].clear();
  }
  return there;
}

/// Calls make(patch, row) for every row, and clears the frames of it in which the patch's object is not
/// there.
template <class Make>
void replace_rows(const LitScene& lit, std::span<const FrameIndex> frames, PatchSeries& series, Make&& make) {
  const auto there = presence(lit.animation, frames);
  for_each_patch(series.patch_count, {}, [&](PatchId patch) {
    Rgb* row = series.row(patch);
    make(patch, row);
    const auto& present = there[lit.patches.facets[lit.patches.facet_of[patch]].object];
    for (std::uint32_t k = 0; k < present.size(); ++k)
      if (!present[k]) row[k] = {};
  });
}

/// Calls use(k, rho) for all frames[k].
template <class Use>
void each_reflectance(const LitScene& lit, PatchId patch, std::span<const FrameIndex> frames, Use&& use) {
  const bool keyed = lit.has_keyed_reflectance(patch);
  Rgb rho = lit.reflectance(patch, 0);
  for (std::uint32_t k = 0; k < frames.size(); ++k) {
    if (keyed) rho = lit.reflectance(patch, frames[k]);
    use(k, rho);
  }
}

/// Of frames[k] in direct light that is known in `frames`, or in every frame of the animation.
std::uint32_t column_of(const PatchSeries& direct, std::span<const FrameIndex> frames, std::uint32_t k) {
  return direct.frame_count == frames.size() ? k : frames[k];
}

Rgb square_root(Rgb value) {
  return {std::sqrt(std::max(0.0f, value.r)), std::sqrt(std::max(0.0f, value.g)),
          std::sqrt(std::max(0.0f, value.b))};
}

void add_direct(std::span<const LitGroup* const> groups, std::span<const FrameIndex> frames, PatchId patch,
                Rgb* row) {
  for (const LitGroup* group : groups) {
    const PatchSeries& direct = group->direct.irradiance_w_m2;
    if (direct.values.empty()) continue;
    const Rgb* from = direct.row(patch);
    for (std::uint32_t k = 0; k < frames.size(); ++k)
      row[k] += in_frame(group->group.scale, frames[k]) * from[column_of(direct, frames, k)];
  }
}

/// E + rho H in place of H.
void make_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                    std::span<const FrameIndex> frames, PatchId patch, Rgb* row) {
  each_reflectance(lit, patch, frames, [&](std::uint32_t k, Rgb rho) { row[k] = rho * max(row[k], Rgb{}); });
  for (const LitGroup* group : groups) {
    if (lit.patches.is_back(patch) || !group->group.emission.ever_emits(lit.material_of(patch))) continue;
    for (std::uint32_t k = 0; k < frames.size(); ++k)
      row[k] +=
          in_frame(group->group.scale, frames[k]) * lit.exitance(group->group.emission, patch, frames[k]);
  }
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
  for_each_patch(sum.patch_count, {},
                 [&](PatchId patch) { add_direct(groups, frames, patch, sum.row(patch)); });
}

void to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                  std::span<const FrameIndex> frames, PatchSeries& irradiance) {
  replace_rows(lit, frames, irradiance,
               [&](PatchId patch, Rgb* row) { make_radiosity(lit, groups, frames, patch, row); });
}

void add_direct_to_radiosity(const LitScene& lit, std::span<const LitGroup* const> groups,
                             std::span<const FrameIndex> frames, PatchSeries& indirect) {
  replace_rows(lit, frames, indirect, [&](PatchId patch, Rgb* row) {
    add_direct(groups, frames, patch, row);
    make_radiosity(lit, groups, frames, patch, row);
  });
}

void to_standard_error(const LitScene& lit, std::span<const LitGroup* const> groups,
                       std::span<const FrameIndex> frames, PatchSeries& variance) {
  replace_rows(lit, frames, variance, [&](PatchId patch, Rgb* row) {
    for (const LitGroup* group : groups) {
      const PatchSeries& of_group = group->direct.variance;
      if (of_group.values.empty()) continue;
      for (std::uint32_t k = 0; k < frames.size(); ++k) {
        const Rgb scale = in_frame(group->group.scale, frames[k]);
        row[k] += scale * scale * of_group.at(patch, column_of(of_group, frames, k));
      }
    }
    each_reflectance(lit, patch, frames,
                     [&](std::uint32_t k, Rgb rho) { row[k] = rho * square_root(row[k]); });
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
