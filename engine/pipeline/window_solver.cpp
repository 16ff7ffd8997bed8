#include "engine/pipeline/window_solver.h"

#include <algorithm>
#include <iterator>

#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// The columns of `a` (frames of_a) and `b` (frames of_b, none of them in of_a), in order of frames.
PatchSeries merged(const PatchSeries& a, const std::vector<FrameIndex>& of_a, const PatchSeries& b,
                   const std::vector<FrameIndex>& of_b) {
  PatchSeries both(a.patch_count, static_cast<std::uint32_t>(of_a.size() + of_b.size()));
  for_each_patch(both.patch_count, {}, [&](PatchId patch) {
    const Rgb *from_a = a.row(patch), *from_b = b.row(patch);
    Rgb* to = both.row(patch);
    std::size_t i = 0, j = 0;
    while (i < of_a.size() || j < of_b.size())
      *to++ = j == of_b.size() || (i < of_a.size() && of_a[i] < of_b[j]) ? from_a[i++] : from_b[j++];
  });
  return both;
}

}  // namespace

WindowSolver::WindowSolver(const LitScene& lit, std::span<const LitGroup> groups,
                           std::span<const GroupSource> sources, std::span<const RestLight> rests,
                           const RestTransport& transport, std::span<const FrameIndex> frames,
                           TracedLines lines)
    : lit_(lit),
      groups_(groups),
      sources_(sources),
      rests_(rests),
      transport_(transport),
      frames_(frames),
      lines_(std::move(lines)),
      of_group_(groups.size()) {
  for (DifferenceLight& light : of_group_) {
    light.irradiance_w_m2 = PatchSeries(lit.patches.count(), 0);
    light.carried_w_m2 = PatchSeries(lit.patches.count(), 0);
  }
}

WindowScene WindowSolver::scene_of(std::size_t g) const {
  return {lit_, frames_, lines_, transport_, rests_[g], sources_[g]};
}

Columns WindowSolver::columns_of(std::span<const FrameIndex> frames) const {
  std::vector<std::uint32_t> slots;
  for (const FrameIndex frame : frames)
    slots.push_back(static_cast<std::uint32_t>(std::lower_bound(frames_.begin(), frames_.end(), frame) -
                                               frames_.begin()));
  return {std::move(slots), static_cast<std::uint32_t>(frames_.size())};
}

api::Status WindowSolver::solve(std::span<const FrameIndex> frames, Carried carried, SolveCounts& counts,
                                const Progress& progress) {
  std::vector<FrameIndex> fresh;
  std::set_difference(frames.begin(), frames.end(), solved_.begin(), solved_.end(),
                      std::back_inserter(fresh));
  if (fresh.empty()) return api::Done{};
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const auto share = [&](std::size_t k) {
      return static_cast<double>(k) / static_cast<double>(groups_.size());
    };
    auto light =
        solve_difference(scene_of(g), columns_of(fresh), part_of(progress, share(g), share(g + 1)), carried);
    if (!light) return light.error();
    counts.add(light->convergence);
    DifferenceLight& known = of_group_[g];
    if (solved_.empty()) {
      known = std::move(*light);
      continue;
    }
    known.irradiance_w_m2 = merged(known.irradiance_w_m2, solved_, light->irradiance_w_m2, fresh);
    if (carried == Carried::wanted)
      known.carried_w_m2 = merged(known.carried_w_m2, solved_, light->carried_w_m2, fresh);
  }
  std::vector<FrameIndex> all;
  std::merge(solved_.begin(), solved_.end(), fresh.begin(), fresh.end(), std::back_inserter(all));
  solved_ = std::move(all);
  return api::Done{};
}

std::vector<const PatchSeries*> WindowSolver::carried() const {
  std::vector<const PatchSeries*> carried;
  for (const DifferenceLight& light : of_group_) carried.push_back(&light.carried_w_m2);
  return carried;
}

void WindowSolver::add_rest(std::size_t g, PatchSeries& difference) const {
  for_each_patch(difference.patch_count, {}, [&](PatchId patch) {
    for (std::uint32_t k = 0; k < difference.frame_count; ++k)
      difference.at(patch, k) += rests_[g].irradiance_w_m2[patch];
  });
}

PatchSeries WindowSolver::at_solved(std::size_t g) const {
  PatchSeries irradiance = of_group_[g].irradiance_w_m2;
  add_rest(g, irradiance);
  return irradiance;
}

PatchSeries WindowSolver::take_at_solved(std::size_t g) {
  add_rest(g, of_group_[g].irradiance_w_m2);
  return std::move(of_group_[g].irradiance_w_m2);
}

api::Result<PatchSeries> WindowSolver::in_every_frame(std::size_t g, api::Interpolation interpolation,
                                                      const Progress& progress) const {
  auto irradiance = fill_between(scene_of(g), columns_of(solved_), of_group_[g], interpolation, progress);
  if (irradiance) add_rest(g, *irradiance);
  return irradiance;
}

PatchSeries WindowSolver::radiosity_at_solved(const std::string* name) const {
  PatchSeries sum(lit_.patches.count(), static_cast<std::uint32_t>(solved_.size()));
  std::vector<const LitGroup*> of_name;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (name && groups_[g].group.name != *name) continue;
    of_name.push_back(&groups_[g]);
    PatchSeries arriving = at_solved(g);
    if (sources_[g].direct)
      for_each_patch(arriving.patch_count, {}, [&](PatchId patch) {
        for (std::uint32_t k = 0; k < arriving.frame_count; ++k)
          arriving.at(patch, k) += sources_[g].direct_in_frame(patch, solved_[k]);
      });
    add_scaled(groups_[g].group, arriving, solved_, sum);
  }
  to_radiosity(lit_, of_name, solved_, sum);
  return sum;
}

EmptyRows WindowSolver::empty_rows() const {
  EmptyRows empty;
  for (const Facet& facet : lit_.patches.facets) {
    const ObjectMotion& motion = lit_.animation.objects[facet.object];
    if (motion.is_static(lit_.animation.frame_count)) continue;
    for (const PlacedRange& range : placed_ranges(motion, frames_))
      for (PatchId patch = facet.first_patch; patch < facet.first_patch + facet.patch_count(); ++patch)
        for (std::uint32_t slot = range.first_slot; slot <= range.last_slot; ++slot)
          if (lines_.crossings.at(patch, slot) == 0) empty.add(patch, lit_.patches.area_m2[patch], 1);
  }
  return empty;
}

}  // namespace engine
