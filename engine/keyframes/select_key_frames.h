// Which frames are solved, as the mode says, and how good that is expected to be.
#pragma once

#include <vector>

#include "api/job_report.h"
#include "engine/estimate/estimate_lighting.h"

namespace engine {

struct KeyFrames {
  std::vector<api::FrameIndex> keys;    ///< increasing, first and last frame included
  std::vector<api::FrameIndex> checks;  ///< mode `default`: the middle of each interval, solved as well
  std::vector<api::FrameIndex> solved;  ///< both, increasing
  api::KeyFrameReport report;           ///< without the observed errors
};

/// Mode `reference`: every frame; no estimate is needed.
KeyFrames all_frames(const api::LightingOptions& options, std::uint32_t frame_count);

/// The other modes, on the estimate: Table 1 on the power of total radiosity, or the fewest keys whose
/// interpolation of the indirect light (of all of it where lines carry everything) stays within the
/// tolerance. In the latter mode pairs of frames are forced between which an object appears or disappears, or
/// a light is switched: a channel of a material's exitance changes by more than half of the largest that the
/// material has in any frame (a ramp over two frames or more does not).
/// Error: stopped.
api::Result<KeyFrames> select_key_frames(const Scene& scene, const Animation& animation,
                                         const StaticRays& static_rays, const Estimate& estimate,
                                         const api::LightingOptions& options, const Progress& progress);

/// Fills in what the solution says of each interval with a check frame: the error of having left it out.
/// radiosity, interpolated: of the solved frames, [patch][position in key_frames.solved].
void observe_errors(const LitScene& lit, const PatchSeries& radiosity_w_m2,
                    const PatchSeries& interpolated_w_m2, KeyFrames& key_frames);

}  // namespace engine
