// Which frames are solved, as the mode says, and how good that is expected to be.
#pragma once

#include <vector>

#include "api/job_report.h"
#include "engine/estimate/estimate_lighting.h"

namespace engine {

struct KeyFrames {
  std::vector<api::FrameIndex> keys;    ///< increasing, first and last frame included
  std::vector<api::FrameIndex> checks;  ///< mode `default`: frames of the intervals, solved as well
  std::vector<api::FrameIndex> solved;  ///< both, increasing
  std::vector<double> predicted_error;  ///< [frame] from the keys alone; empty where nothing predicts it
};

/// Modes `reference` and `frame-by-frame`: every frame; no estimate is needed.
KeyFrames all_frames(std::uint32_t frame_count);

/// The other modes, on an estimate without lines, or with those that a run of the same job had added to it
/// when it was cut off: Table 1 on total radiosity, or the fewest keys whose interpolation stays within the
/// tolerance. In the latter mode lines are added, doubling them up to kEstimateRounds times, while the noise
/// of the estimate leaves the number of keys open: while the keys that are surely enough, or those that are
/// hardly enough, are more than one and a tenth off those by the mean of the replicates, which decides then.
/// Forced: the pairs of frames at jumps (jumps.h), and every kIntervalMax-th frame. Error: stopped.
api::Result<KeyFrames> select_key_frames(Estimator& estimator, const api::LightingOptions& options,
                                         const Progress& progress);
inline constexpr int kEstimateRounds = 3;

/// How far select_key_frames is with what `estimator` has, 0 .. 1: its share of the lines that it may come
/// to.
double share_of_selection(const Estimator& estimator, const api::LightingOptions& options);

/// The search keeps to this share of the tolerance: fine patches miss by more than the estimate's, which are
/// means over metres.
inline constexpr double kAim = 0.75;

/// From this length on an interval is checked at two frames.
inline constexpr std::uint32_t kTwoChecks = 6;

/// The frames that check the interval between two keys: its middle where it has one, or, where it is long, a
/// third and two thirds of the way: one frame in the middle misses what happens at the ends.
std::vector<api::FrameIndex> checks_between(api::FrameIndex a, api::FrameIndex b);

/// Those of all intervals.
std::vector<api::FrameIndex> checks_of(const std::vector<api::FrameIndex>& keys);

/// Fills `solved` from keys and checks.
void merge_solved(KeyFrames& chosen);

/// What each frame is, and what is expected of the intervals; no observed errors yet.
api::KeyFrameReport report_of(const KeyFrames& chosen, const api::LightingOptions& options,
                              std::uint32_t frame_count);

}  // namespace engine
