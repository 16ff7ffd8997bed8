// A coarse and quick look at the lighting of every frame, to choose the key-frames by.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/estimate/estimate_direct.h"
#include "engine/lighting/light_at_rest.h"
#include "engine/lighting/rest_transport.h"

namespace engine {

/// Lines of one trace at most: seconds of work, which is what a killed run has to do again, and less memory
/// than a replicate of the solution takes. Where a step asks for more they are traced in several parts.
inline constexpr std::uint64_t kEstimateLinesPerTraceMax = 1'000'000;
static_assert(kEstimateLinesPerTraceMax <= kLinesPerReplicateMax);

/// Lines of the next trace of a replicate that lacks `lacking` >= 1: the traces left are as few and as even
/// as can be, whatever was traced before.
constexpr std::uint64_t lines_of_next_trace(std::uint64_t lacking) {
  const std::uint64_t traces = (lacking + kEstimateLinesPerTraceMax - 1) / kEstimateLinesPerTraceMax;
  return (lacking + traces - 1) / traces;
}

/// Sharpens an estimate by more and more lines. Every trace of every replicate has lines of its own, and each
/// line counts the same. Source: Besuievsky & Pueyo, 2001, section 5.
class Estimator {
 public:
  /// Cuts the scene into patches of `options.estimate_patch_edge_m`, lights them directly, and takes over the
  /// lines that an earlier run left in `checkpoints`. `static_rays` may be those of finer patches of the same
  /// scene: the facets are the same. All arguments but `progress` outlive it.
  /// Errors: stopped; out_of_resources and invalid_request as mesh_into_patches says.
  static api::Result<Estimator> begin(const Scene& scene, const Animation& animation,
                                      const StaticRays& static_rays, std::span<const LightGroup> groups,
                                      const api::LightingOptions& options, const Progress& progress,
                                      const EstimateCheckpoints& checkpoints = {});

  /// Adds the lines that it lacks of `line_count`, an equal part to every replicate (at least one line, and
  /// rounded down). Saves what there is when that is due: after every window of frames of every replicate.
  /// Error: stopped; then the estimate is of no more use, but what is saved holds whole windows.
  api::Status add_lines_up_to(std::uint64_t line_count, const Progress& progress);

  /// Has it lines beyond `line_count`, finished or not? Then the estimate is not what it was with as many.
  bool is_beyond(std::uint64_t line_count) const;

  /// Those of a trace that is not finished count in part.
  double lines_done() const;

  /// Whole where there is no unfinished trace: where add_lines_up_to has returned.
  const Estimate& estimate() const { return *estimate_; }
  LitScene lit() const { return {*scene_, *animation_, estimate_->patches, *static_rays_}; }

  /// What is kept of it is not needed any more.
  static void forget(Checkpoints& files);

 private:
  /// The trace at work, which every replicate has its own lines of.
  struct Trace {
    std::uint64_t number = 0;
    std::uint64_t lines = 0;      ///< of each replicate; 0: none is begun
    std::uint32_t replicate = 0;  ///< those before are done
    std::uint32_t window = 0;     ///< of the replicate at work; those before are done
  };

  Estimator(const Scene& scene, const Animation& animation, const StaticRays& static_rays,
            const api::LightingOptions& options, Checkpoints* files)
      : scene_(&scene),
        animation_(&animation),
        static_rays_(&static_rays),
        options_(&options),
        files_(files) {}

  std::uint32_t window_count() const;
  bool unfinished() const { return trace_.replicate > 0 || trace_.window > 0; }
  std::vector<GroupSource> sources() const;
  api::Status add_replicate(const Progress& progress);
  api::Status add_window(std::span<const FrameIndex> window, std::span<const GroupSource> sources,
                         std::span<const RestLight> rests, const RestTransport& transport,
                         const LineOptions& lines, const Progress& progress);
  void take_radiosity(PatchSeries irradiance, std::span<const FrameIndex> window);
  void take_compared(const PatchSeries& part, FrameIndex first_frame, std::uint32_t group);
  float share_of_replicate() const;
  void finish_window();
  void make_room();
  void save();
  void load();

  const Scene* scene_;
  const Animation* animation_;
  const StaticRays* static_rays_;
  const api::LightingOptions* options_;
  Checkpoints* files_;
  std::unique_ptr<Estimate> estimate_;
  Trace trace_;
};

}  // namespace engine
