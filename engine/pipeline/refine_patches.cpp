#include "engine/pipeline/refine_patches.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/direct/direct_light.h"
#include "engine/patches/grade.h"
#include "engine/pipeline/openness.h"
#include "engine/visibility/ray_scene.h"

namespace engine {
namespace {

/// Light of the quarters in the frames that are lit together.  [bytes]
constexpr std::uint64_t kLitBytesMax = std::uint64_t{512} << 20;

/// A child spreads like its parent where a shadow's edge passes both, on a quarter of the area; this many
/// times more is allowed for before a child is left out unseen.
constexpr double kChildSafety = 2;

/// A cell that could be quartered.
struct Refinable {
  std::uint32_t facet = 0, grid_cell = 0;
  Leaf leaf;
  double area_m2 = 0;                 ///< of one side
  double worth = 0;                   ///< spread^2 x area, mean of all frames, per new patch  [m^2]
  double spread = 0;                  ///< largest of all frames
  std::uint32_t first_child = kNone;  ///< its quarters, four in a row
  bool quartered = false;
  static constexpr std::uint32_t kNone = 0xffffffffu;
};

std::uint32_t level_of(Leaf leaf) {
  return leaf.slots == 64 ? 0 : leaf.slots == 16 ? 1 : leaf.slots == 4 ? 2 : 3;
}

/// Sets the bits that quarter the candidate and all that it is a quarter of.
void quarter(const Refinable& candidate, Patches& patches) {
  std::uint64_t& starts = patches.facets[candidate.facet].trees[candidate.grid_cell].leaf_starts;
  for (std::uint32_t slots = kCellTreeSlots; slots >= candidate.leaf.slots; slots /= 4)
    starts |= quartered(Leaf{candidate.leaf.first / slots * slots, slots});
}

Patches with_trees(Patches patches) {
  for (Facet& facet : patches.facets) facet.trees.resize(facet.grid_cells());
  return patches;
}

/// Weighs what the quarters of candidates show, frame after frame.
class SpreadMeter {
 public:
  SpreadMeter(const Scene& scene, const Animation& animation) : scene_(scene), animation_(animation) {}

  /// From direct light in `frames`: half the mean of what is reflected is the least that differences are
  /// compared with; and what else arrives is taken to be rho / (1 - rho) of the mean of what arrives, with
  /// rho the mean reflectance, wherever it is not hidden.
  void set_means(const Patches& patches, std::span<const FrameIndex> frames, const PatchSeries& irradiance) {
    for (float Rgb::*channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
      double reflected = 0, arriving = 0, rho = 0, area_m2 = 0;
      for (PatchId patch = 0; patch < patches.count(); ++patch)
        for (std::uint32_t k = 0; k < frames.size(); ++k) {
          const std::uint32_t material = patches.facets[patches.facet_of[patch]].material;
          const double area = patches.area_m2[patch], of_patch = reflectance(material, frames[k]).*channel;
          reflected += area * of_patch * irradiance.at(patch, k).*channel;
          arriving += area * irradiance.at(patch, k).*channel;
          rho += area * of_patch;
          area_m2 += area;
        }
      const double others = arriving / area_m2 * (rho / area_m2) / (1 - rho / area_m2);
      surrounding_w_m2_.*channel = static_cast<float>(others);
      least_w_m2_ = std::max(least_w_m2_, 0.5 * (reflected + rho * others) / area_m2);
    }
  }

  /// Adds the frames of `lit` to a candidate; `first`: the first of its quarters, on one side.
  void add(const Patches& patches, PatchId first, std::span<const FrameIndex> frames, const DirectLight& lit,
           std::span<const float> open, Refinable& candidate) const {
    const std::uint32_t material = patches.facets[candidate.facet].material;
    const double new_patches = 3.0 * (patches.facets[candidate.facet].both_sides ? 2 : 1);
    candidate.area_m2 = 4.0 * patches.area_m2[first];
    const double weight = candidate.area_m2 / (new_patches * animation_.frame_count);
    for (std::uint32_t k = 0; k < frames.size(); ++k) {
      const Rgb rho = reflectance(material, frames[k]);
      const double squared = squared_spread(rho, first, k, lit, open);
      candidate.worth += squared * weight;
      candidate.spread = std::max(candidate.spread, std::sqrt(squared));
    }
  }

 private:
  Rgb reflectance(std::uint32_t material, FrameIndex frame) const {
    return material_reflectance(scene_, animation_, material, frame);
  }

  /// Variance between the quarters, relative.
  double squared_spread(Rgb rho, PatchId first, std::uint32_t k, const DirectLight& lit,
                        std::span<const float> open) const {
    double largest = 0, most = least_w_m2_;
    for (float Rgb::*channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
      double sum = 0, squares = 0;
      for (PatchId quarter = first; quarter < first + 4; ++quarter) {
        const double value =
            lit.irradiance_w_m2.at(quarter, k).*channel + double{open[quarter]} * surrounding_w_m2_.*channel;
        sum += value;
        squares += value * value;
      }
      const double mean = sum / 4, reflected = rho.*channel;
      most = std::max(most, reflected * mean);
      largest = std::max(largest, reflected * reflected * (squares / 4 - mean * mean));
    }
    return most > 0 ? std::max(0.0, largest) / (most * most) : 0;
  }

  const Scene& scene_;
  const Animation& animation_;
  double least_w_m2_ = 0;
  Rgb surrounding_w_m2_;
};

class Refiner {
 public:
  Refiner(const Scene& scene, const Animation& animation, const api::LightingOptions& lighting,
          std::uint64_t patch_count_max, Patches coarse, const Progress& progress)
      : animation_(animation),
        lighting_(lighting),
        patch_count_max_(patch_count_max),
        coarse_(std::move(coarse)),
        static_rays_(coarse_, animation),
        meter_(scene, animation),
        progress_(progress),
        frames_(every_frame(animation)) {}

  api::Result<RefinedPatches> run() {
    if (const auto s = measure_means(); !s) return s.error();
    std::vector<std::uint32_t> now = first_candidates();
    for (std::uint32_t level = 0; level < kCellTreeLevels && !now.empty(); ++level) {
      const auto share = [](std::uint32_t l) { return l / static_cast<double>(kCellTreeLevels); };
      if (const auto s = weigh(now, level, part_of(progress_, share(level), share(level + 1))); !s)
        return s.error();
      const double cutoff = choose(patch_count_max_);
      now = next_candidates(level, cutoff);
    }
    return RefinedPatches{graded(), candidates_.size(), shadow_rays_};
  }

 private:
  bool may_be_quartered(std::uint32_t facet, std::uint32_t level) const {
    return level < levels_of(coarse_.facets[facet], lighting_.patch_edge_m);
  }

  std::vector<std::uint32_t> first_candidates() {
    for (std::uint32_t f = 0; f < coarse_.facets.size(); ++f)
      if (may_be_quartered(f, 0))
        for (std::uint32_t cell = 0; cell < coarse_.facets[f].grid_cells(); ++cell)
          candidates_.push_back({f, cell, {}});
    std::vector<std::uint32_t> all(candidates_.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }

  /// The quarters of those chosen at `level`, where they may matter.
  std::vector<std::uint32_t> next_candidates(std::uint32_t level, double cutoff) {
    std::vector<std::uint32_t> next;
    for (std::uint32_t c = 0; c < candidates_.size(); ++c) {
      const Refinable parent = candidates_[c];
      if (!parent.quartered || level_of(parent.leaf) != level) continue;
      if (!may_be_quartered(parent.facet, level + 1) || parent.worth / 4 * kChildSafety < cutoff) continue;
      const std::uint32_t slots = parent.leaf.slots / 4;
      candidates_[c].first_child = static_cast<std::uint32_t>(candidates_.size());
      for (std::uint32_t q = 0; q < 4; ++q) {
        next.push_back(static_cast<std::uint32_t>(candidates_.size()));
        candidates_.push_back({parent.facet, parent.grid_cell, {parent.leaf.first + q * slots, slots}});
      }
    }
    return next;
  }

  /// On the coarse mesh, in a few frames.
  api::Status measure_means() {
    constexpr std::size_t kFrames = 8;
    const std::size_t count = std::min(kFrames, frames_.size());
    std::vector<FrameIndex> few;
    for (std::size_t k = 0; k < count; ++k) few.push_back(frames_[k * frames_.size() / count]);
    const auto lit = light(coarse_, few, kCellTreeLevels, {[](double) {}, progress_.stop_requested});
    if (!lit) return lit.error();
    meter_.set_means(coarse_, few, lit->irradiance_w_m2);
    return api::Done{};
  }

  api::Result<DirectLight> light(const Patches& patches, std::span<const FrameIndex> frames,
                                 std::uint64_t stream, const Progress& progress) {
    auto lit = direct_light(patches, animation_, animation_.emission, static_rays_, frames,
                            {kRefineSamples, 1, stream_seed(lighting_.seed, stream)}, progress);
    if (lit) shadow_rays_ += lit->counts.shadow_rays;
    return lit;
  }

  /// Lights the quarters of the candidates `now`, some frames at a time.
  api::Status weigh(const std::vector<std::uint32_t>& now, std::uint32_t level, const Progress& progress) {
    Patches trial = with_trees(coarse_);
    for (const std::uint32_t c : now) quarter(candidates_[c], trial);
    number_patches(trial);
    const auto open =
        openness(trial, animation_, static_rays_, static_cast<float>(kHidingReach * lighting_.patch_edge_m),
                 stream_seed(lighting_.seed, kCellTreeLevels + 1 + level), progress_);
    if (!open) return open.error();
    const std::uint64_t per_frame = sizeof(Rgb) * std::uint64_t{trial.count()};
    const std::size_t step = std::clamp<std::uint64_t>(kLitBytesMax / per_frame, 1, kWindowMax);
    for (std::size_t first = 0; first < frames_.size(); first += step) {
      const auto frames = std::span(frames_).subspan(first, std::min(step, frames_.size() - first));
      const auto share = [&](std::size_t f) {
        return static_cast<double>(f) / static_cast<double>(frames_.size());
      };
      const auto lit =
          light(trial, frames, level, part_of(progress, share(first), share(first + frames.size())));
      if (!lit) return lit.error();
      add_frames(now, trial, frames, *lit, *open);
    }
    return api::Done{};
  }

  void add_frames(const std::vector<std::uint32_t>& now, const Patches& trial,
                  std::span<const FrameIndex> frames, const DirectLight& lit, std::span<const float> open) {
    constexpr std::size_t kChunk = 256;
    parallel_for((now.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
      for (std::size_t k = chunk * kChunk; k < std::min(now.size(), (chunk + 1) * kChunk); ++k) {
        Refinable& candidate = candidates_[now[k]];
        const Facet& facet = trial.facets[candidate.facet];
        const PatchId first =
            facet.first_patch + facet.trees[candidate.grid_cell].leaf_at(candidate.leaf.first);
        meter_.add(trial, first, frames, lit, open, candidate);
        if (facet.both_sides) meter_.add(trial, first + facet.cell_count(), frames, lit, open, candidate);
      }
    });
  }

  /// Is a cell to be quartered, however many patches there may be? Not by its spread alone: what counts in
  /// the whole is spread^2 x area, so large cells are for less.
  bool is_uneven(const Refinable& candidate) const {
    const double edge_m = lighting_.patch_edge_m;
    return candidate.spread * candidate.spread * candidate.area_m2 > kSpread * kSpread * edge_m * edge_m;
  }

  /// Chooses anew among all that are known, the worthiest first, and a quarter only after what it is a
  /// quarter of. Where the patches ran out, the worth of the first left out; else 0.
  double choose(std::uint64_t patch_count_max) {
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(candidates_[a].worth, b) < std::pair(candidates_[b].worth, a);
    };
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, decltype(less)> queue(less);
    const auto offer = [&](std::uint32_t c) {
      if (is_uneven(candidates_[c])) queue.push(c);
    };
    for (std::uint32_t c = 0; c < candidates_.size(); ++c) {
      candidates_[c].quartered = false;
      if (level_of(candidates_[c].leaf) == 0) offer(c);
    }
    for (std::uint64_t count = coarse_.count(); !queue.empty();) {
      Refinable& best = candidates_[queue.top()];
      queue.pop();
      count += coarse_.facets[best.facet].both_sides ? 6 : 3;
      if (count > patch_count_max) return best.worth;
      best.quartered = true;
      for (std::uint32_t q = 0; q < 4 && best.first_child != Refinable::kNone; ++q)
        offer(best.first_child + q);
    }
    return 0;
  }

  /// The mesh of those that are chosen with `most` patches before grading.
  Patches graded(std::uint64_t most) {
    Patches patches = with_trees(coarse_);
    (void)choose(most);
    for (const Refinable& candidate : candidates_)
      if (candidate.quartered) quarter(candidate, patches);
    parallel_for(patches.facets.size(), [&](std::size_t f) { grade(patches.facets[f]); });
    number_patches(patches);
    return patches;
  }

  /// Grading takes patches too: as many are chosen as leave room for that, within a thousandth or so.
  Patches graded() {
    Patches best = graded(patch_count_max_);
    if (best.count() <= patch_count_max_) return best;
    best = coarse_;
    std::uint64_t fits = coarse_.count(), beyond = patch_count_max_;
    for (int step = 0; step < 10 && beyond - fits > 1; ++step) {
      const std::uint64_t most = fits + (beyond - fits) / 2;
      Patches tried = graded(most);
      if (tried.count() > patch_count_max_) {
        beyond = most;
        continue;
      }
      fits = most;
      best = std::move(tried);
    }
    return best;
  }

  const Animation& animation_;
  const api::LightingOptions& lighting_;
  const std::uint64_t patch_count_max_;
  const Patches coarse_;
  const StaticRays static_rays_;
  SpreadMeter meter_;
  const Progress& progress_;
  std::vector<FrameIndex> frames_;
  std::vector<Refinable> candidates_;
  std::uint64_t shadow_rays_ = 0;
};

api::Error too_many(std::uint64_t patches, std::uint64_t patch_count_max) {
  const std::string detail = "the scene cuts into " + std::to_string(patches) +
                             " patches at the coarsest, more than " + std::to_string(patch_count_max) +
                             "; choose a larger patch_count_max or patch_edge_m";
  return {api::Fault::out_of_resources,
          detail,
          {{"animation.json", "/lighting/patch_count_max", 0, 0, "limit_exceeded", detail}}};
}

}  // namespace

api::Result<RefinedPatches> refine_patches(const Scene& scene, const Animation& animation,
                                           const api::LightingOptions& lighting,
                                           std::uint64_t patch_count_max, const Progress& progress) {
  auto coarse = mesh_into_patches(scene, {lighting.patch_edge_m, api::PatchLayout::adaptive});
  if (!coarse) return coarse.error();
  if (coarse->count() > patch_count_max) return too_many(coarse->count(), patch_count_max);
  return Refiner(scene, animation, lighting, patch_count_max, std::move(*coarse), progress).run();
}

}  // namespace engine
