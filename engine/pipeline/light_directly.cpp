#include "engine/pipeline/light_directly.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

#include "api/fault_point.h"
#include "engine/base/sobol.h"
#include "engine/direct/direct_checkpoint.h"

namespace engine {
namespace {

/// Patches between two looks at the clock: seconds of work at most.
constexpr PatchId kPatchesPerBlock = 4096;

/// What took less is done again after a crash rather than saved at once.
constexpr std::chrono::seconds kWorthSaving{5};

/// Of the mean of all passes so far.
constexpr std::string_view kMeanName = "direct-mean";

/// Lighting a patch in one more pose is about so much of lighting one at rest in all frames.
constexpr double kWorkOfPose = 0.5;

/// Of the patches before, [patch], and of all; progress only.
std::vector<double> work_until(const LitScene& lit) {
  std::vector<double> work{0};
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    const std::size_t poses =
        lit.animation.objects[lit.patches.facets[lit.patches.facet_of[patch]].object].spans.size();
    work.push_back(work.back() + (lit.at_rest(patch) ? 1 : kWorkOfPose * static_cast<double>(poses)));
  }
  return work;
}

/// One pass over all groups and patches: the part [from, to] of the stage.
class DirectPass {
 public:
  DirectPass(const LitScene& lit, std::span<const FrameIndex> frames, const api::LightingOptions& options,
             std::uint32_t pass, double from, double to, Checkpoints& checkpoints)
      : lit_(lit),
        frames_(frames),
        options_(options),
        pass_(pass),
        from_(from),
        to_(to),
        work_(work_until(lit)),
        checkpoints_(checkpoints) {}

  /// Of group `g` of `count`.
  api::Result<DirectLight> light(const Emission& emission, std::size_t g, std::size_t count,
                                 StageClock& clock, const Progress& progress) {
    const DirectLighter lighter(lit_.patches, lit_.animation, emission, lit_.static_rays, frames_,
                                direct_options(options_, seed()));
    DirectLight direct = lighter.empty();
    const PatchId patches = lit_.patches.count();
    const auto share = [&](PatchId patch) {
      return from_ + (to_ - from_) * (static_cast<double>(g) + work_[patch] / work_[patches]) /
                         static_cast<double>(count);
    };
    PatchId first = saved(g, direct);
    if (first > 0) clock.go_on_from(share(first), "resumed");
    for (; first < patches; first += kPatchesPerBlock) {
      const PatchId end = std::min(first + kPatchesPerBlock, patches);
      if (const auto s = lighter.light(first, end, direct, part_of(progress, share(first), share(end))); !s)
        return s.error();
      if (checkpoints_.due() || (end == patches && took() > kWorthSaving)) save(g, end, direct);
      api::fault_point("patches_lit");
    }
    return direct;
  }

  /// Is some of it saved, or should the whole be?
  bool worth_saving() const { return has_saved_ || took() > kWorthSaving; }

  /// What it has saved of `count` groups is not needed any more.
  void forget(std::size_t count) {
    for (std::size_t g = 0; g < count; ++g) checkpoints_.remove(name(g));
  }

 private:
  std::chrono::steady_clock::duration took() const { return std::chrono::steady_clock::now() - began_; }

  std::uint64_t seed() const {
    return pass_ == 0 ? options_.seed : stream_seed(options_.seed, 0xd17ec7ull + pass_);
  }

  std::string name(std::size_t g) const {
    return "direct-" + std::to_string(pass_) + "-" + std::to_string(g);
  }

  void save(std::size_t g, PatchId done, const DirectLight& direct) {
    has_saved_ = true;
    std::vector<CheckpointPart> parts{part_of_checkpoint(done)};
    add_parts(direct, parts);
    (void)checkpoints_.save(name(g), parts);  // one that fails costs time only if the run is killed
  }

  PatchId saved(std::size_t g, DirectLight& direct) {
    auto checkpoint = checkpoints_.load(name(g));
    PatchId done = 0;
    DirectLight found = direct;
    if (!checkpoint || !checkpoint->take(done) || !take(*checkpoint, found)) return 0;
    direct = std::move(found);
    has_saved_ = true;
    return done;
  }

  const LitScene& lit_;
  const std::span<const FrameIndex> frames_;
  const api::LightingOptions& options_;
  const std::uint32_t pass_;
  const double from_, to_;
  const std::vector<double> work_;
  bool has_saved_ = false;
  Checkpoints& checkpoints_;
  const std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
};

/// Takes one more pass into the mean of those before.
void blend_pass(const DirectLight& pass, std::uint32_t passes_before, DirectLight& mean) {
  const float share = 1.0f / static_cast<float>(passes_before + 1);
  const float keep = 1.0f - share;
  for (std::size_t k = 0; k < mean.irradiance_w_m2.values.size(); ++k) {
    Rgb& value = mean.irradiance_w_m2.values[k];
    value += (pass.irradiance_w_m2.values[k] - value) * share;
  }
  for (std::size_t k = 0; k < mean.variance.values.size(); ++k)
    mean.variance.values[k] =
        mean.variance.values[k] * (keep * keep) + pass.variance.values[k] * (share * share);
  for (std::size_t k = 0; k < mean.at_rest_w_m2.size(); ++k)
    mean.at_rest_w_m2[k] += (pass.at_rest_w_m2[k] - mean.at_rest_w_m2[k]) * share;
  mean.counts += pass.counts;
}

/// Passes that are done, of those that are needed as far as is known.
struct Passes {
  std::uint32_t done = 0, needed = 1;
};

/// Of the stage, once `done` passes are done. How many are needed is known after the first, which is half.
double share_after(std::uint32_t done, std::uint32_t needed) {
  return done == 0 ? 0.0 : 0.5 + 0.5 * (done - 1) / std::max(1u, needed - 1);
}

api::Status save_mean(Passes passes, const std::vector<LitGroup>& groups, Checkpoints& checkpoints) {
  std::vector<CheckpointPart> parts{part_of_checkpoint(passes)};
  for (const LitGroup& group : groups) add_parts(group.direct, parts);
  return checkpoints.save(kMeanName, parts);
}

/// None is done where nothing was saved. Its variance is always known: passes are for a target error.
Passes load_mean(const Checkpoints& checkpoints, PatchSeries room, std::vector<LitGroup>& groups) {
  auto saved = checkpoints.load(kMeanName);
  Passes passes;
  if (!saved || !saved->take(passes)) return {};
  for (LitGroup& group : groups) {
    DirectLight& direct = group.direct;
    direct.irradiance_w_m2 = direct.variance = room;
    direct.at_rest_w_m2.resize(room.patch_count);
    if (!take(*saved, direct)) return {};
  }
  return passes;
}

/// Noise of the direct light relative to the direct light that is reflected: at least that relative to mean
/// B.
double noise_of(const LitScene& lit, const std::vector<LitGroup>& groups,
                std::span<const FrameIndex> frames) {
  const auto all = pointers_to(groups);
  PatchSeries error(lit.patches.count(), static_cast<std::uint32_t>(frames.size()));
  to_standard_error(lit, all, frames, error);
  PatchSeries reflected(lit.patches.count(), static_cast<std::uint32_t>(frames.size()));
  add_direct_to_radiosity(lit, all, frames, reflected);
  const double mean = mean_radiosity(lit, reflected);
  return mean > 0 ? root_mean_square_error(lit, error) / mean : 0;
}

}  // namespace

DirectOptions direct_options(const api::LightingOptions& options, std::uint64_t seed) {
  return {options.samples_per_light,
          wants_errors(options) ? std::clamp(options.samples_per_light, 2u, kReplicatesMin) : 1, seed};
}

double root_mean_square_error(const LitScene& lit, const PatchSeries& standard_error_w_m2) {
  double squares = 0, area = 0;
  for (PatchId patch = 0; patch < lit.patches.count(); ++patch) {
    if (ever_emits(lit, patch)) continue;
    double of_patch = 0;
    for (std::uint32_t k = 0; k < standard_error_w_m2.frame_count; ++k) {
      const double error = max_channel(standard_error_w_m2.at(patch, k));
      of_patch += error * error;
    }
    squares += lit.patches.area_m2[patch] * of_patch;
    area += double{lit.patches.area_m2[patch]} * standard_error_w_m2.frame_count;
  }
  return area > 0 ? std::sqrt(squares / area) : 0;
}

api::Result<std::vector<LitGroup>> light_directly(const LitScene& lit, std::vector<LightGroup> groups,
                                                  std::span<const FrameIndex> frames,
                                                  const api::LightingOptions& options,
                                                  Checkpoints& checkpoints, StageClock& clock) {
  std::vector<LitGroup> lit_groups;
  for (LightGroup& group : groups) lit_groups.push_back({std::move(group), {}});
  if (options.direct == api::DirectLight::pure) return lit_groups;

  const Progress& progress = clock.begin(api::Stage::direct);
  Passes passes;
  if (options.target_error)
    passes =
        load_mean(checkpoints, {lit.patches.count(), static_cast<std::uint32_t>(frames.size())}, lit_groups);
  for (; passes.done < passes.needed; ++passes.done) {
    const std::uint32_t pass = passes.done;
    const double from = options.target_error ? share_after(pass, passes.needed) : 0.0;
    const double to = options.target_error ? share_after(pass + 1, passes.needed) : 1.0;
    DirectPass now(lit, frames, options, pass, from, to, checkpoints);
    for (std::size_t g = 0; g < lit_groups.size(); ++g) {
      auto direct = now.light(lit_groups[g].group.emission, g, lit_groups.size(), clock, progress);
      if (!direct) return direct.error();
      if (pass == 0)
        lit_groups[g].direct = std::move(*direct);
      else
        blend_pass(*direct, pass, lit_groups[g].direct);
    }
    if (pass == 0 && options.target_error) {
      const double over = noise_of(lit, lit_groups, frames) / (*options.target_error / std::sqrt(2.0));
      passes.needed = static_cast<std::uint32_t>(
          std::clamp(std::ceil(over * over), 1.0, double{kSamplesPerLightMax} / options.samples_per_light));
    }
    if (options.target_error && now.worth_saving() &&
        save_mean({pass + 1, passes.needed}, lit_groups, checkpoints))
      now.forget(lit_groups.size());
  }
  return lit_groups;
}

}  // namespace engine
