#include "engine/pipeline/light_indirectly.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "api/fault_point.h"
#include "engine/base/sobol.h"
#include "engine/keyframes/check_errors.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/target_error.h"
#include "engine/pipeline/window_solver.h"
#include "engine/pipeline/windows.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

bool splits(const api::LightingOptions& options) {
  return options.mode == api::LightingMode::standard;
}

/// Takes `part`, columns from `skip` on, into the running mean of `count` replicates, at column `first`.
void blend_window(const PatchSeries& part, std::uint32_t skip, std::uint32_t first, std::uint32_t count,
                  PatchSeries& mean) {
  const float share = 1.0f / static_cast<float>(count);
  for_each_patch(part.patch_count, {}, [&](PatchId patch) {
    for (std::uint32_t k = skip; k < part.frame_count; ++k) {
      Rgb& value = mean.at(patch, first + k - skip);
      value += (part.at(patch, k) - value) * share;
    }
  });
}

class IndirectSolver {
 public:
  IndirectSolver(const LitScene& lit, const std::vector<LitGroup>& groups,
                 const api::LightingOptions& options, KeyFrames& chosen, Checkpoints& checkpoints,
                 StageClock& clock)
      : lit_(lit),
        groups_(groups),
        options_(options),
        chosen_(chosen),
        checkpoints_(checkpoints),
        clock_(clock) {}

  api::Result<IndirectLight> run() {
    prepare();
    const Progress& progress = clock_.begin(api::Stage::solve);
    if (load()) clock_.go_on_from(share_done(), "resumed");
    while (done_ < replicates_) {
      const Progress part = part_of(progress, share_done(), share_done(1));
      if (const auto s = add_replicate(part); !s) {
        // Whoever stops it lets it go on later, most often. What the last save has is not written again.
        if (s.error().fault == api::Fault::stopped && whole_ && saved_ < done_) save();
        return s.error();
      }
      ++done_;
      const bool all_done = done_ == replicates_;
      const bool begins_again = (all_done || done_ == kEarlyCheck) && splits_bad_intervals();
      if (all_done && !begins_again) ask_for_more();
      if (checkpoints_.due() && 0 < done_ && done_ < replicates_) save();
      api::fault_point("replicate_solved");
    }
    return IndirectLight{std::move(frames_), std::move(*mean_),    std::move(of_name_),
                         std::move(names_),  std::move(observed_), counts_};
  }

 private:
  double share_done(std::uint32_t ahead = 0) const {
    return static_cast<double>(done_ + ahead) / static_cast<double>(replicates_);
  }

  void prepare() {
    replicates_ = replicates_of(options_);
    block_ = replicates_;
    static_lines_ = std::max<std::uint64_t>(1, options_.line_count / replicates_);
    moving_lines_ = std::clamp<std::uint64_t>(options_.moving_line_count / replicates_, 1, static_lines_);
    if (fills_between(options_)) frames_ = every_frame(lit_.animation);
    place_direct();
    for (const LitGroup& group : groups_) {
      sources_.push_back({&group.group.emission,
                          options_.direct == api::DirectLight::apart ? &group.direct : nullptr, position_});
      if (!options_.light_groups.empty() && (names_.empty() || names_.back() != group.group.name))
        names_.push_back(group.group.name);
    }
    begin_replicates();
  }

  /// Direct light was computed in every frame, or where frames are solved.
  void place_direct() {
    if (splits(options_) || chosen_.solved.size() == lit_.animation.frame_count) return;
    position_.assign(lit_.animation.frame_count, 0);
    for (std::uint32_t k = 0; k < chosen_.solved.size(); ++k) position_[chosen_.solved[k]] = k;
  }

  std::vector<Frames> windows() const {
    return windows_of(splits(options_) ? every_frame(lit_.animation) : chosen_.solved, splits(options_));
  }

  std::uint64_t seed() const { return stream_seed(options_.seed, done_); }

  /// Gives every group's source the noise of its direct light in this replicate. It adds up to 0 over each
  /// block of as many replicates as were begun with.
  void draw_noise() {
    noise_.assign(groups_.size(), {});
    if (options_.direct == api::DirectLight::pure) return;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      noise_[g] = noise_of_direct(groups_[g].direct, done_, block_, options_.seed, g);
      sources_[g].noise = noise_[g];
    }
  }

  api::Status add_replicate(const Progress& progress) {
    SolveCounts counts;
    draw_noise();
    const auto rests =
        light_at_rest(lit_, sources_, {static_lines_, seed()}, counts, part_of(progress, 0, kRestShare));
    if (!rests) return rests.error();
    const auto transport = rest_transport(
        lit_, {rest_transport_lines(moving_lines_, static_lines_, lit_.patches.count()), seed()},
        part_of(progress, kRestShare, kRestShare));
    if (!transport) return transport.error();
    const std::vector<Frames> all = windows();
    mean_->begin();
    missed_->begin();
    std::uint32_t first = 0, first_check = 0;  // columns
    for (std::size_t w = 0; w < all.size(); ++w) {
      const auto share = [&](double part) {
        return kRestShare +
               (1 - kRestShare) * (static_cast<double>(w) + part) / static_cast<double>(all.size());
      };
      auto lines = trace_lines(lit_.patches, lit_.animation, lit_.static_rays, all[w],
                               {.line_count = moving_lines_, .seed = seed(), .with_static_rows = false},
                               part_of(progress, share(0), share(kTracingShare)));
      if (!lines) return lines.error();
      count(*lines, counts);
      WindowSolver window(lit_, groups_, sources_, *rests, *transport, all[w], std::move(*lines));
      const KeyFrames part = part_in(chosen_, all[w]);
      const Progress solving = part_of(progress, share(kTracingShare), share(kSolvedShare));
      const Carried carried = fills_between(options_) ? Carried::wanted : Carried::left_out;
      if (const auto s = window.solve(part.solved, carried, counts, solving); !s) return s.error();
      counts.empty_rows += window.empty_rows();
      const std::uint32_t skip = w > 0 && splits(options_) ? 1 : 0;  // what the window before had as well
      std::optional<PatchSeries> missed;
      if (fills_between(options_))
        missed = left_out(lit_, groups_, window.carried(), part.keys, part.checks, options_.interpolation);
      else if (splits(options_))
        take_radiosity(window, skip, first);
      auto light = light_of(window, part_of(progress, share(kSolvedShare), share(1)));
      if (!light) return light.error();
      whole_ = false;
      if (missed) {
        missed_->add(std::move(*missed), 0, first_check);
        first_check += static_cast<std::uint32_t>(part.checks.size());
      }
      const std::uint32_t columns = (*light)[0].frame_count;
      accumulate(std::move(*light), skip, first);
      first += columns - skip;
    }
    if (!radiosity_.empty()) miss_in_all_windows();
    counts_ += counts;
    whole_ = true;
    return api::Done{};
  }

  void count(const TracedLines& lines, SolveCounts& counts) const {
    counts.tracing.moving_hits += lines.counts.moving_hits;
    counts.tracing.touched_lines += lines.counts.touched_lines;
    counts.tracing.local_lines += lines.counts.local_lines;
    counts.moving_exchanges += lines.moving_rows.entry_count();
  }

  /// Where all light is interpolated: that of each name in the solved frames of a window, columns from `skip`
  /// on, at column `first` of all that are solved.
  void take_radiosity(const WindowSolver& window, std::uint32_t skip, std::uint32_t first) {
    const auto solved = static_cast<std::uint32_t>(chosen_.solved.size());
    radiosity_.resize(std::max<std::size_t>(1, names_.size()), PatchSeries(lit_.patches.count(), solved));
    for (std::size_t n = 0; n < radiosity_.size(); ++n)
      blend_window(window.radiosity_at_solved(names_.empty() ? nullptr : &names_[n]), skip, first, 1,
                   radiosity_[n]);
  }

  /// All light is interpolated over the whole sequence, and that of each name by itself.
  void miss_in_all_windows() {
    std::vector<const PatchSeries*> of_name;
    for (const PatchSeries& radiosity : radiosity_) of_name.push_back(&radiosity);
    missed_->add(left_out(lit_, {}, of_name, chosen_.keys, chosen_.checks, options_.interpolation), 0, 0);
    radiosity_.clear();
  }

  /// Indirect irradiance of each name (of all groups where there are none), taken from `window`.
  api::Result<std::vector<PatchSeries>> light_of(WindowSolver& window, const Progress& progress) const {
    std::vector<PatchSeries> light;
    const bool everywhere = fills_between(options_);
    const auto count = static_cast<double>(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Progress of_this =
          part_of(progress, static_cast<double>(g) / count, static_cast<double>(g + 1) / count);
      auto of_group = everywhere ? window.in_every_frame(g, options_.interpolation, of_this)
                                 : api::Result<PatchSeries>(window.take_at_solved(g));
      if (!of_group) return of_group.error();
      if (groups_.size() == 1 && is_unscaled(groups_[g].group)) {
        light.push_back(std::move(*of_group));
        break;
      }
      const bool begins =
          light.empty() || (!names_.empty() && groups_[g].group.name != groups_[g - 1].group.name);
      if (begins) light.emplace_back(of_group->patch_count, of_group->frame_count);
      add_scaled(groups_[g].group, *of_group, everywhere ? window.frames() : std::span(window.solved()),
                 light.back());
    }
    return light;
  }

  /// Takes the light of one window, columns from `skip` on, into the means, at column `first`.
  void accumulate(std::vector<PatchSeries> of_window, std::uint32_t skip, std::uint32_t first) {
    for (std::size_t n = 0; n < names_.size(); ++n)
      blend_window(of_window[n], skip, first, done_ + 1, of_name_[n]);
    for (std::size_t n = 1; n < of_window.size(); ++n) add(of_window[n], of_window[0]);
    mean_->add(std::move(of_window[0]), skip, first);
  }

  /// Room for the replicates, none of which is done.
  void begin_replicates() {
    if (!fills_between(options_)) frames_ = chosen_.solved;
    const auto out = static_cast<std::uint32_t>(frames_.size());
    mean_.emplace(lit_.patches.count(), out);
    of_name_.assign(names_.size(), PatchSeries(lit_.patches.count(), out));
    missed_.emplace(lit_.patches.count(), static_cast<std::uint32_t>(chosen_.checks.size()));
    done_ = saved_ = 0;
    counts_ = {};
    spent_before_ = {};
  }

  /// Looks at the check frames; where they show intervals to be bad, splits those and begins again.
  bool splits_bad_intervals() {
    if (!splits(options_) || chosen_.checks.empty()) return false;
    observed_ = check_errors(lit_, *missed_, radiosity_at_checks());
    std::vector<bool> bad;
    for (const double error : observed_) bad.push_back(error > options_.tolerance);
    if (rounds_ == kSplitRounds || !split(chosen_, bad)) return false;
    ++rounds_;
    begin_replicates();
    return true;
  }

  /// B at the check frames, [patch][check], and the mean B.
  CheckedRadiosity radiosity_at_checks() const {
    PatchSeries arriving = mean_->mean();
    const auto all = pointers_to(groups_);
    add_direct_to_radiosity(lit_, all, frames_, arriving);
    CheckedRadiosity found{
        PatchSeries(arriving.patch_count, static_cast<std::uint32_t>(chosen_.checks.size())),
        mean_radiosity(lit_, arriving)};
    for (std::uint32_t c = 0; c < chosen_.checks.size(); ++c) {
      const auto k = static_cast<std::uint32_t>(
          std::lower_bound(frames_.begin(), frames_.end(), chosen_.checks[c]) - frames_.begin());
      for (PatchId patch = 0; patch < arriving.patch_count; ++patch)
        found.at_checks_w_m2.at(patch, c) = arriving.at(patch, k);
    }
    return found;
  }

  /// Where a target error is not met: so many replicates more that it should be.
  void ask_for_more() {
    if (!options_.target_error || replicates_ >= kReplicatesMax) return;
    const LinesSpent spent{replicates_, noise_of(lit_, groups_, frames_, *mean_)};
    const auto wanted = replicates_for(*options_.target_error, spent_before_, spent);
    spent_before_ = spent;
    const std::uint32_t most = std::max(replicates_, kReplicatesMax / block_ * block_);
    if (wanted > replicates_) replicates_ = std::min(most, (wanted + block_ - 1) / block_ * block_);
  }

  void save() {
    saved_ = done_;
    std::vector<CheckpointPart> parts{part_of_checkpoint(done_),
                                      part_of_checkpoint(replicates_),
                                      part_of_checkpoint(rounds_),
                                      part_of_checkpoint(spent_before_),
                                      part_of_checkpoint(chosen_.keys),
                                      part_of_checkpoint(chosen_.checks),
                                      part_of_checkpoint(counts_),
                                      part_of_checkpoint(missed_->mean().values),
                                      part_of_checkpoint(missed_->squares().values),
                                      part_of_checkpoint(mean_->mean().values),
                                      part_of_checkpoint(mean_->squares().values)};
    for (const PatchSeries& series : of_name_) parts.push_back(part_of_checkpoint(series.values));
    (void)checkpoints_.save("indirect", parts);  // one that fails costs time only if the run is killed
  }

  /// A checkpoint is whole, and of this job, or not there.
  bool load() {
    auto saved = checkpoints_.load("indirect");
    std::uint32_t done = 0, replicates = 0, rounds = 0;
    LinesSpent spent;
    KeyFrames chosen = chosen_;
    if (!saved || !saved->take(done) || !saved->take(replicates) || !saved->take(rounds) ||
        !saved->take(spent) || !saved->take(chosen.keys) || !saved->take(chosen.checks))
      return false;
    merge_solved(chosen);
    std::swap(chosen, chosen_);
    begin_replicates();
    if (!take_replicates(*saved, done)) {
      chosen_ = chosen;
      begin_replicates();
      return false;
    }
    replicates_ = replicates;
    rounds_ = rounds;
    spent_before_ = spent;
    return true;
  }

  /// Into what begin_replicates() has made room for.
  bool take_replicates(SavedCheckpoint& saved, std::uint32_t done) {
    done_ = saved_ = done;
    mean_->set_count(done);
    missed_->set_count(done);
    bool whole = saved.take(counts_) && saved.take(missed_->mean_values().values) &&
                 saved.take(missed_->squares().values) && saved.take(mean_->mean_values().values) &&
                 saved.take(mean_->squares().values);
    for (PatchSeries& series : of_name_) whole = whole && saved.take(series.values);
    return whole;
  }

  /// Replicates after which the check frames are looked at for the first time: what is clearly bad shows
  /// then, and beginning again costs little.
  static constexpr std::uint32_t kEarlyCheck = 4;

  /// Shares of a replicate and of a window; progress only.
  static constexpr double kRestShare = 0.2, kTracingShare = 0.5, kSolvedShare = 0.85;

  const LitScene& lit_;
  const std::vector<LitGroup>& groups_;
  const api::LightingOptions& options_;
  KeyFrames& chosen_;
  Checkpoints& checkpoints_;
  StageClock& clock_;

  std::uint32_t done_ = 0, replicates_ = 0, block_ = 1;  ///< block_: replicates begun with
  std::uint32_t saved_ = 0;                              ///< replicates in the checkpoint
  bool whole_ = true;  ///< no part of the replicate at work is in the means yet
  std::uint64_t static_lines_ = 0, moving_lines_ = 0;  ///< of one replicate
  std::vector<GroupSource> sources_;
  std::vector<std::vector<float>> noise_;  ///< [group], of sources_ in the replicate at work
  std::vector<std::uint32_t> position_;    ///< [frame], see GroupSource
  std::vector<std::string> names_;
  Frames frames_;
  std::optional<ReplicateMean> mean_;
  std::vector<PatchSeries> of_name_;
  std::vector<PatchSeries> radiosity_;  ///< of the replicate at work, see take_radiosity
  std::optional<ReplicateMean> missed_;
  std::vector<double> observed_;
  std::uint32_t rounds_ = 0;
  LinesSpent spent_before_;  ///< when it was last found to be too little
  SolveCounts counts_;
};

}  // namespace

std::uint32_t replicates_of(const api::LightingOptions& options) {
  const std::uint64_t needed = (options.line_count + kLinesPerReplicateMax - 1) / kLinesPerReplicateMax;
  const std::uint32_t least = wants_errors(options) ? kReplicatesMin : splits(options) ? 2 : 1;
  return std::max(static_cast<std::uint32_t>(needed), least);
}

bool fills_between(const api::LightingOptions& options) {
  return options.mode == api::LightingMode::standard && options.interpolated == api::Interpolated::indirect;
}

std::vector<LightGroup> solved_groups(const Scene& scene, const Animation& animation,
                                      const api::LightingOptions& options) {
  return light_groups(scene, animation, options.light_groups, fills_between(options) ? kScaledGroupsMax : 0);
}

api::Result<IndirectLight> light_indirectly(const LitScene& lit, const std::vector<LitGroup>& groups,
                                            const api::LightingOptions& options, KeyFrames& chosen,
                                            Checkpoints& checkpoints, StageClock& clock) {
  return IndirectSolver(lit, groups, options, chosen, checkpoints, clock).run();
}

}  // namespace engine
