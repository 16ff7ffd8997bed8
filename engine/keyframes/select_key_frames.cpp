#include "engine/keyframes/select_key_frames.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "engine/keyframes/fewest_key_frames.h"
#include "engine/keyframes/interpolation_error.h"
#include "engine/keyframes/jumps.h"
#include "engine/keyframes/table1.h"

namespace engine {
namespace {

using Frames = std::vector<FrameIndex>;

/// Of a round; the rest is the search. Progress only.
constexpr double kTracingShare = 0.9;

bool contains(const Frames& frames, FrameIndex frame) {
  return std::binary_search(frames.begin(), frames.end(), frame);
}

/// Jumps, and the frames that windows of frames share.
Frames forced_keys(const Animation& animation, const Estimate& estimate) {
  std::vector<LightGroup> groups;
  for (const LitGroup& lit : estimate.groups) groups.push_back(lit.group);
  Frames forced = frames_at_jumps(animation, groups);
  const Frames shared = shared_frames(animation.frame_count);
  forced.insert(forced.end(), shared.begin(), shared.end());
  std::sort(forced.begin(), forced.end());
  forced.erase(std::unique(forced.begin(), forced.end()), forced.end());
  return forced;
}

/// Search by linear interpolation on what the estimate has.
class Search {
 public:
  Search(const Estimator& estimator, const api::LightingOptions& options, const Frames& forced)
      : error_(estimator.lit(), estimator.estimate(), options.interpolated),
        options_(options),
        forced_(forced) {}

  api::Result<Frames> keys(Evidence evidence, const Progress& progress) {
    const double tolerance = kAim * options_.tolerance;
    return fewest_key_frames(
        error_.frame_count(),
        [&](FrameIndex a, FrameIndex b) { return error_.seems_within(a, b, tolerance, evidence); },
        [&](FrameIndex a, FrameIndex b) { return error_.within(a, b, tolerance, evidence); }, forced_,
        progress);
  }

  std::vector<double> errors(const Frames& keys) const {
    return error_.largest(keys, options_.interpolation);
  }

 private:
  InterpolationError error_;
  const api::LightingOptions& options_;
  const Frames& forced_;
};

/// Adds the worst frame of every interval in which the interpolation that is used is worse than the linear
/// one the search was made by, until there is none.
Frames recheck(const Search& search, double tolerance, Frames keys) {
  for (;;) {
    const std::vector<double> errors = search.errors(keys);
    Frames more;
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
      const auto worst = std::max_element(errors.begin() + keys[k], errors.begin() + keys[k + 1]);
      if (*worst > tolerance) more.push_back(static_cast<FrameIndex>(worst - errors.begin()));
    }
    if (more.empty()) return keys;
    Frames all;
    std::merge(keys.begin(), keys.end(), more.begin(), more.end(), std::back_inserter(all));
    keys = std::move(all);
  }
}

/// Does noise leave the number of keys open?
bool is_open(const Frames& many, const Frames& keys, const Frames& few) {
  const std::size_t open = std::max(many.size() - std::min(many.size(), keys.size()),
                                    keys.size() - std::min(few.size(), keys.size()));
  return open > std::max<std::size_t>(1, keys.size() / 10);
}

/// Of the first round; those of all rounds so far double from round to round.
std::uint64_t first_lines(const api::LightingOptions& options) {
  return std::max<std::uint64_t>(1, options.estimate_line_count / kEstimateReplicates) * kEstimateReplicates;
}

/// Of the lines of all rounds, and of what else it takes to search on them.
double share_of(double lines, const api::LightingOptions& options) {
  const std::uint64_t rounds = options.mode == api::LightingMode::standard ? kEstimateRounds : 0;
  return lines / static_cast<double>(first_lines(options) << rounds);
}

api::Result<KeyFrames> by_interpolation_error(Estimator& estimator, const api::LightingOptions& options,
                                              const Progress& progress) {
  const Frames forced = forced_keys(estimator.lit().animation, estimator.estimate());
  for (int round = 0;; ++round) {
    const std::uint64_t lines = first_lines(options) << round;
    if (estimator.is_beyond(lines)) continue;  // an earlier run searched on these, and they left it open
    const double before = share_of(estimator.lines_done(), options);
    const double after = share_of(static_cast<double>(lines), options);
    const double traced = before + kTracingShare * (after - before);
    if (const auto s = estimator.add_lines_up_to(lines, part_of(progress, before, traced)); !s)
      return s.error();
    const auto searching = [&](int k) { return traced + (after - traced) * k / 3.0; };
    Search search(estimator, options, forced);
    const auto many = search.keys(Evidence::surely, part_of(progress, searching(0), searching(1)));
    const auto few = search.keys(Evidence::hardly, part_of(progress, searching(1), searching(2)));
    auto keys = search.keys(Evidence::likely, part_of(progress, searching(2), searching(3)));
    if (!many || !few || !keys) return api::Error{api::Fault::stopped, "stopped while choosing key-frames"};
    if (is_open(*many, *keys, *few) && round < kEstimateRounds) continue;
    KeyFrames chosen;
    chosen.keys = recheck(search, kAim * options.tolerance, std::move(*keys));
    chosen.checks = checks_of(chosen.keys);
    chosen.predicted_error = search.errors(chosen.keys);
    merge_solved(chosen);
    return chosen;
  }
}

double largest_between(const std::vector<double>& errors, FrameIndex a, FrameIndex b) {
  double largest = 0;
  for (FrameIndex f = a + 1; f < b; ++f) largest = std::max(largest, errors[f]);
  return largest;
}

}  // namespace

Frames checks_between(FrameIndex a, FrameIndex b) {
  const FrameIndex length = b - a;
  if (length < 2) return {};
  if (length < kTwoChecks) return {a + length / 2};
  return {a + length / 3, b - length / 3};
}

Frames checks_of(const Frames& keys) {
  Frames checks;
  for (std::size_t k = 0; k + 1 < keys.size(); ++k)
    for (const FrameIndex check : checks_between(keys[k], keys[k + 1])) checks.push_back(check);
  return checks;
}

void merge_solved(KeyFrames& chosen) {
  chosen.solved.clear();
  std::merge(chosen.keys.begin(), chosen.keys.end(), chosen.checks.begin(), chosen.checks.end(),
             std::back_inserter(chosen.solved));
}

KeyFrames all_frames(std::uint32_t frame_count) {
  KeyFrames chosen;
  chosen.keys.resize(frame_count);
  std::iota(chosen.keys.begin(), chosen.keys.end(), 0u);
  merge_solved(chosen);
  return chosen;
}

double share_of_selection(const Estimator& estimator, const api::LightingOptions& options) {
  return share_of(estimator.lines_done(), options);
}

api::Result<KeyFrames> select_key_frames(Estimator& estimator, const api::LightingOptions& options,
                                         const Progress& progress) {
  if (options.mode == api::LightingMode::standard)
    return by_interpolation_error(estimator, options, progress);
  if (const auto s = estimator.add_lines_up_to(first_lines(options),
                                               part_of(progress, share_of_selection(estimator, options), 1));
      !s)
    return s.error();
  const LastKey last = options.mode == api::LightingMode::paper_literal ? LastKey::lost : LastKey::marked;
  KeyFrames chosen;
  chosen.keys = table1_key_frames(estimator.lit(), estimator.estimate().radiosity_w_m2, options.metric,
                                  options.epsilon, last);
  merge_solved(chosen);
  return chosen;
}

api::KeyFrameReport report_of(const KeyFrames& chosen, const api::LightingOptions& options,
                              std::uint32_t frame_count) {
  api::KeyFrameReport report;
  report.mode = options.mode;
  const bool promises = options.mode == api::LightingMode::standard;
  if (promises) report.tolerance = options.tolerance;
  for (FrameIndex frame = 0; frame < frame_count; ++frame) {
    api::FrameRecord record{frame, api::FrameKind::interpolated, std::nullopt};
    if (contains(chosen.keys, frame)) record.kind = api::FrameKind::key;
    if (contains(chosen.checks, frame)) record.kind = api::FrameKind::check;
    if (record.kind != api::FrameKind::interpolated)
      record.error = 0.0;
    else if (!chosen.predicted_error.empty())
      record.error = chosen.predicted_error[frame];
    report.frames.push_back(record);
  }
  for (std::size_t k = 0; k + 1 < chosen.keys.size(); ++k) {
    api::KeyFrameInterval interval;
    interval.first = chosen.keys[k];
    interval.last = chosen.keys[k + 1];
    if (!chosen.predicted_error.empty())
      interval.predicted_error = largest_between(chosen.predicted_error, interval.first, interval.last);
    if (promises && interval.predicted_error) interval.kept = *interval.predicted_error <= options.tolerance;
    report.intervals.push_back(interval);
  }
  return report;
}

}  // namespace engine
