// Indirect light of a sequence: independent replicates of lines, window by window, and the check of the
// key-frames by the solution itself.
#pragma once

#include <span>
#include <vector>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/animation/light_groups.h"
#include "engine/base/checkpoint.h"
#include "engine/keyframes/select_key_frames.h"
#include "engine/lighting/light_at_rest.h"
#include "engine/lighting/replicate_mean.h"
#include "engine/pipeline/stage_clock.h"

namespace engine {

/// Replicates that a job begins with: no fewer than its lines need, and kReplicatesMin where errors are
/// wanted (wants_errors): then the same in every mode, so that all modes share their lines. Where they are
/// not, one; two in mode `default`, whose checks must know what is noise.
std::uint32_t replicates_of(const api::LightingOptions& options);

/// Replicates at most, where a target error asks for more and more.
inline constexpr std::uint32_t kReplicatesMax = 512;

struct IndirectLight {
  std::vector<FrameIndex> frames;  ///< those that there is light of: all, or those solved
  ReplicateMean irradiance_w_m2;   ///< all groups with their scale, [patch][position in frames]
  /// The same of each named group, mean of the replicates; empty where the job names none.
  std::vector<PatchSeries> of_name;
  std::vector<std::string> names;      ///< of of_name, in order
  std::vector<double> observed_error;  ///< at the checks, see check_errors; in mode `default`
  SolveCounts counts;
};

/// Times that bad intervals are split and all is solved again.
inline constexpr std::uint32_t kSplitRounds = 3;

/// Solves the frames of `chosen`. In mode `default` the check frames are looked at after four and after all
/// replicates: intervals that they show to be worse than the tolerance are split in `chosen`, their halves
/// get checks of their own, and all is solved again (the same lines), kSplitRounds times at most. Where only
/// indirect light is interpolated, the frames between are filled too (fill_between). With a target error
/// replicates are added until the noise of all the light meets it (or kReplicatesMax). Error: stopped.
api::Result<IndirectLight> light_indirectly(const LitScene& lit, const std::vector<LitGroup>& groups,
                                            const api::LightingOptions& options, KeyFrames& chosen,
                                            Checkpoints& checkpoints, StageClock& clock);

/// Is only the indirect light interpolated, and direct light known in every frame?
bool fills_between(const api::LightingOptions& options);

/// The groups of lights that are solved by themselves: as named by the job, and by curves of brightness where
/// that saves key-frames.
std::vector<LightGroup> solved_groups(const Scene& scene, const Animation& animation,
                                      const api::LightingOptions& options);

}  // namespace engine
