#include "engine/pipeline/light_indirectly.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/base/sobol.h"
#include "engine/keyframes/check_errors.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/window_solver.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

bool splits(const api::LightingOptions& options) {
  return options.mode == api::LightingMode::standard;
}

Frames part_in(const Frames& frames, FrameIndex first, FrameIndex last) {
  return {std::lower_bound(frames.begin(), frames.end(), first),
          std::upper_bound(frames.begin(), frames.end(), last)};
}

/// The key-frames of one window; its ends are keys.
KeyFrames part_in(const KeyFrames& chosen, const Frames& window) {
  KeyFrames part;
  part.keys = part_in(chosen.keys, window.front(), window.back());
  part.checks = part_in(chosen.checks, window.front(), window.back());
  merge_solved(part);
  return part;
}

/// Adds what a window has and `chosen` lacks, and forgets the checks that became keys.
void take_over(const KeyFrames& part, KeyFrames& chosen) {
  const auto unite = [](Frames& to, const Frames& more) {
    Frames all;
    std::set_union(to.begin(), to.end(), more.begin(), more.end(), std::back_inserter(all));
    to = std::move(all);
  };
  unite(chosen.keys, part.keys);
  unite(chosen.checks, part.checks);
  Frames checks;
  std::set_difference(chosen.checks.begin(), chosen.checks.end(), chosen.keys.begin(), chosen.keys.end(),
                      std::back_inserter(checks));
  chosen.checks = std::move(checks);
  merge_solved(chosen);
}

/// Takes `part`, columns from `skip` on, into the running mean of `count` replicates, at column `first`.
void blend(const PatchSeries& part, std::uint32_t skip, std::uint32_t first, std::uint32_t count,
           PatchSeries& mean) {
  const float share = 1.0f / static_cast<float>(count);
  for_each_patch(part.patch_count, {}, [&](PatchId patch) {
    for (std::uint32_t k = skip; k < part.frame_count; ++k) {
      Rgb& value = mean.at(patch, first + k - skip);
      value += (part.at(patch, k) - value) * share;
    }
  });
}

PatchSeries columns_at(const PatchSeries& series, const Frames& have, const Frames& wanted) {
  PatchSeries taken(series.patch_count, static_cast<std::uint32_t>(wanted.size()));
  for (std::uint32_t k = 0; k < wanted.size(); ++k) {
    const auto from =
        static_cast<std::uint32_t>(std::lower_bound(have.begin(), have.end(), wanted[k]) - have.begin());
    for (PatchId patch = 0; patch < series.patch_count; ++patch) taken.at(patch, k) = series.at(patch, from);
  }
  return taken;
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
      if (const auto s = add_replicate(part); !s) return s.error();
      ++done_;
      if (done_ == replicates_) ask_for_more();
      if (checkpoints_.due() && done_ < replicates_) save();
    }
    IndirectLight light{std::move(frames_), std::move(*mean_),  std::move(of_name_),
                        std::move(names_),  std::move(missed_), counts_};
    return light;
  }

 private:
  double share_done(std::uint32_t ahead = 0) const {
    return static_cast<double>(done_ + ahead) / static_cast<double>(replicates_);
  }

  void prepare() {
    const std::uint64_t lines = options_.line_count;
    const bool wants_errors = options_.standard_errors || options_.target_error;
    replicates_ = static_cast<std::uint32_t>((lines + kLinesPerReplicateMax - 1) / kLinesPerReplicateMax);
    replicates_ = std::max(replicates_, wants_errors ? kReplicatesMin : 1);
    static_lines_ = std::max<std::uint64_t>(1, lines / replicates_);
    moving_lines_ = std::clamp<std::uint64_t>(options_.moving_line_count / replicates_, 1, static_lines_);
    if (!splits(options_)) frames_ = chosen_.solved;
    if (splits(options_) && fills_between(options_)) frames_ = every_frame();
    place_direct();
    for (const LitGroup& group : groups_) {
      sources_.push_back({&group.group.emission,
                          options_.direct == api::DirectLight::apart ? &group.direct : nullptr, position_});
      if (!options_.light_groups.empty() && (names_.empty() || names_.back() != group.group.name))
        names_.push_back(group.group.name);
    }
  }

  /// Direct light was computed in every frame, or where frames are solved.
  void place_direct() {
    if (splits(options_) || chosen_.solved.size() == lit_.animation.frame_count) return;
    position_.assign(lit_.animation.frame_count, 0);
    for (std::uint32_t k = 0; k < chosen_.solved.size(); ++k) position_[chosen_.solved[k]] = k;
  }

  Frames every_frame() const {
    Frames all(lit_.animation.frame_count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }

  /// Windows of frames that are traced together. Where intervals may be split every frame is traced, and
  /// neighbouring windows share a frame, which is a key.
  std::vector<Frames> windows() const {
    const Frames traced = splits(options_) ? every_frame() : chosen_.solved;
    const std::size_t step = splits(options_) ? kIntervalMax : kWindowMax;
    const std::size_t width = splits(options_) ? step + 1 : step;
    std::vector<Frames> windows;
    for (std::size_t first = 0; first < traced.size(); first += step) {
      if (!windows.empty() && splits(options_) && first + 1 == traced.size()) break;  // shared already
      const auto begin = traced.begin() + static_cast<std::ptrdiff_t>(first);
      windows.emplace_back(begin,
                           begin + static_cast<std::ptrdiff_t>(std::min(width, traced.size() - first)));
    }
    return windows;
  }

  std::uint64_t seed() const { return stream_seed(options_.seed, done_); }

  api::Status add_replicate(const Progress& progress) {
    SolveCounts counts;
    const auto rests =
        light_at_rest(lit_, sources_, {static_lines_, seed()}, counts, part_of(progress, 0, kRestShare));
    if (!rests) return rests.error();
    const std::vector<Frames> all = windows();
    std::vector<std::vector<PatchSeries>> found;  // [window][name]
    std::vector<PatchSeries> missed;              // [window]
    for (std::size_t w = 0; w < all.size(); ++w) {
      const auto share = [&](double part) {
        return kRestShare +
               (1 - kRestShare) * (static_cast<double>(w) + part) / static_cast<double>(all.size());
      };
      auto lines = trace_lines(lit_.patches, lit_.animation, lit_.static_rays, all[w],
                               {moving_lines_, seed()}, part_of(progress, share(0), share(kTracingShare)));
      if (!lines) return lines.error();
      count(*lines, counts);
      WindowSolver window(lit_, groups_, sources_, *rests, all[w], std::move(*lines));
      const Progress solving = part_of(progress, share(kTracingShare), share(1));
      if (const auto s = solve(window, all[w], counts, solving); !s) return s.error();
      counts.empty_rows += window.empty_rows();
      if (splits(options_)) missed.push_back(missed_in(window, part_in(chosen_, all[w])));
      auto light = light_of(window, solving);
      if (!light) return light.error();
      found.push_back(std::move(*light));
    }
    accumulate(all, found, missed);
    keep(counts);
    return api::Done{};
  }

  void count(const TracedLines& lines, SolveCounts& counts) const {
    counts.tracing.moving_hits += lines.counts.moving_hits;
    counts.tracing.touched_lines += lines.counts.touched_lines;
    counts.tracing.local_lines += lines.counts.local_lines;
    counts.moving_exchanges += lines.moving_rows.entry_count();
  }

  void keep(const SolveCounts& counts) {
    counts_.tracing += counts.tracing;
    counts_.exchanges += counts.exchanges;
    counts_.moving_exchanges += counts.moving_exchanges;
    counts_.empty_rows += counts.empty_rows;
    counts_.iterations = std::max(counts_.iterations, counts.iterations);
    counts_.converged = counts_.converged && counts.converged;
  }

  /// Solves the window's frames; the first replicate splits the intervals that its check frames show to be
  /// bad.
  api::Status solve(WindowSolver& window, const Frames& frames, SolveCounts& counts,
                    const Progress& progress) {
    KeyFrames part = part_in(chosen_, frames);
    for (bool changed = true; changed;) {
      if (const auto s = window.solve(part.solved, counts, progress); !s) return s.error();
      if (!splits(options_) || done_ > 0) return api::Done{};
      const PatchSeries radiosity = window.radiosity_at_solved();
      const std::vector<double> errors =
          largest_errors(missed_in(window, part), columns_at(radiosity, window.solved(), part.checks),
                         0.5 * mean_radiosity(lit_, radiosity));
      std::vector<bool> bad;
      for (const double error : errors) bad.push_back(error > options_.tolerance);
      changed = split(part, bad);
    }
    take_over(part, chosen_);
    return api::Done{};
  }

  PatchSeries missed_in(const WindowSolver& window, const KeyFrames& part) const {
    if (fills_between(options_))
      return left_out(lit_, groups_, window.carried(), part.keys, part.checks, options_.interpolation);
    const PatchSeries radiosity = window.radiosity_at_solved();
    return left_out(lit_, {}, std::array{&radiosity}, part.keys, part.checks, options_.interpolation);
  }

  /// Indirect irradiance of each name (of all groups where there are none).
  api::Result<std::vector<PatchSeries>> light_of(const WindowSolver& window, const Progress& progress) const {
    std::vector<PatchSeries> light;
    const bool everywhere = splits(options_) && fills_between(options_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      auto of_group = everywhere ? window.in_every_frame(g, options_.interpolation, progress)
                                 : api::Result<PatchSeries>(window.at_solved(g));
      if (!of_group) return of_group.error();
      const bool begins =
          light.empty() || (!names_.empty() && groups_[g].group.name != groups_[g - 1].group.name);
      if (begins) light.emplace_back(of_group->patch_count, of_group->frame_count);
      add_scaled(groups_[g].group, *of_group, everywhere ? window.frames() : std::span(window.solved()),
                 light.back());
    }
    return light;
  }

  void accumulate(const std::vector<Frames>& all, std::vector<std::vector<PatchSeries>>& found,
                  const std::vector<PatchSeries>& missed) {
    if (frames_.empty()) frames_ = chosen_.solved;
    const auto out = static_cast<std::uint32_t>(frames_.size());
    if (!mean_) {
      mean_.emplace(lit_.patches.count(), out);
      of_name_.assign(names_.size(), PatchSeries(lit_.patches.count(), out));
      missed_ = PatchSeries(lit_.patches.count(), static_cast<std::uint32_t>(chosen_.checks.size()));
    }
    mean_->begin();
    std::uint32_t first = 0, first_check = 0;
    for (std::size_t w = 0; w < all.size(); ++w) {
      const std::uint32_t skip = w > 0 && splits(options_) ? 1 : 0;
      for (std::size_t n = 0; n < names_.size(); ++n) blend(found[w][n], skip, first, done_ + 1, of_name_[n]);
      for (std::size_t n = 1; n < found[w].size(); ++n)
        for (std::size_t k = 0; k < found[w][0].values.size(); ++k)
          found[w][0].values[k] += found[w][n].values[k];
      mean_->add(found[w][0], skip, first);
      first += found[w][0].frame_count - skip;
      if (missed.empty()) continue;
      blend(missed[w], 0, first_check, done_ + 1, missed_);
      first_check += missed[w].frame_count;
    }
  }

  /// Where a target error is not met: so many replicates more that it should be.
  void ask_for_more() {
    if (!options_.target_error || replicates_ >= kReplicatesMax) return;
    const auto all = pointers_to(groups_);
    PatchSeries arriving = mean_->mean();
    PatchSeries variance = mean_->variance();
    if (options_.direct == api::DirectLight::apart) {
      const PatchSeries direct = direct_irradiance(all, frames_);
      for (std::size_t k = 0; k < direct.values.size(); ++k) arriving.values[k] += direct.values[k];
    }
    to_radiosity(lit_, all, frames_, arriving);
    const double mean = mean_radiosity(lit_, arriving);
    PatchSeries from_lines = variance;
    to_standard_error(lit_, {}, frames_, from_lines);
    to_standard_error(lit_, all, frames_, variance);
    if (!(mean > 0)) return;
    const double whole = root_mean_square_error(lit_, variance) / mean;
    const double lines = root_mean_square_error(lit_, from_lines) / mean;
    const double target = *options_.target_error;
    if (whole <= target) return;
    const double left = target * target - (whole * whole - lines * lines);  // for lines
    const double factor = left > 0 ? lines * lines / left : kReplicatesMax;
    replicates_ = static_cast<std::uint32_t>(
        std::clamp<double>(std::ceil(1.05 * factor * replicates_), replicates_ + 1, kReplicatesMax));
  }

  void save() {
    std::vector<CheckpointPart> parts{part_of_checkpoint(done_),
                                      part_of_checkpoint(replicates_),
                                      part_of_checkpoint(chosen_.keys),
                                      part_of_checkpoint(chosen_.checks),
                                      part_of_checkpoint(frames_),
                                      part_of_checkpoint(counts_),
                                      part_of_checkpoint(missed_.values),
                                      part_of_checkpoint(mean_->mean().values),
                                      part_of_checkpoint(mean_->squares().values)};
    for (const PatchSeries& series : of_name_) parts.push_back(part_of_checkpoint(series.values));
    (void)checkpoints_.save("indirect", parts);  // one that fails costs time only if the run is killed
  }

  bool load() {
    auto saved = checkpoints_.load("indirect");
    if (!saved) return false;
    KeyFrames chosen = chosen_;
    std::uint32_t done = 0, replicates = 0;
    Frames frames;
    SolveCounts counts;
    PatchSeries missed;
    if (!saved->take(done) || !saved->take(replicates) || !saved->take(chosen.keys) ||
        !saved->take(chosen.checks) || !saved->take(frames) || !saved->take(counts) ||
        !saved->take(missed.values))
      return false;
    const std::uint32_t patches = lit_.patches.count();
    ReplicateMean mean(patches, static_cast<std::uint32_t>(frames.size()));
    if (!saved->take(mean.mean_values().values) || !saved->take(mean.squares().values)) return false;
    std::vector<PatchSeries> of_name(names_.size(),
                                     PatchSeries(patches, static_cast<std::uint32_t>(frames.size())));
    for (PatchSeries& series : of_name)
      if (!saved->take(series.values)) return false;
    mean.set_count(done);
    merge_solved(chosen);
    missed.patch_count = patches;
    missed.frame_count = static_cast<std::uint32_t>(chosen.checks.size());
    done_ = done;
    replicates_ = replicates;
    chosen_ = std::move(chosen);
    frames_ = std::move(frames);
    counts_ = counts;
    missed_ = std::move(missed);
    mean_ = std::move(mean);
    of_name_ = std::move(of_name);
    return true;
  }

  /// Shares of a replicate and of a window; progress only.
  static constexpr double kRestShare = 0.2, kTracingShare = 0.5;

  const LitScene& lit_;
  const std::vector<LitGroup>& groups_;
  const api::LightingOptions& options_;
  KeyFrames& chosen_;
  Checkpoints& checkpoints_;
  StageClock& clock_;

  std::uint32_t done_ = 0, replicates_ = 0;
  std::uint64_t static_lines_ = 0, moving_lines_ = 0;  ///< of one replicate
  std::vector<GroupSource> sources_;
  std::vector<std::uint32_t> position_;  ///< [frame], see GroupSource
  std::vector<std::string> names_;
  Frames frames_;
  std::optional<ReplicateMean> mean_;
  std::vector<PatchSeries> of_name_;
  PatchSeries missed_;
  SolveCounts counts_;
};

}  // namespace

bool fills_between(const api::LightingOptions& options) {
  return options.mode == api::LightingMode::standard && options.interpolated == api::Interpolated::indirect;
}

api::Result<IndirectLight> light_indirectly(const LitScene& lit, const std::vector<LitGroup>& groups,
                                            const api::LightingOptions& options, KeyFrames& chosen,
                                            Checkpoints& checkpoints, StageClock& clock) {
  return IndirectSolver(lit, groups, options, chosen, checkpoints, clock).run();
}

}  // namespace engine
