#include "engine/direct/direct_light.h"

#include <algorithm>
#include <atomic>

#include "engine/base/parallel.h"
#include "engine/direct/window_lighter.h"

namespace engine {
namespace {

constexpr PatchId kPatchesPerTask = 8;  // one that moves takes as long as all its frames

}  // namespace

struct DirectLighter::Impl {
  const Patches& patches;
  const Animation& animation;
  const Emission& emission;
  const StaticRays& static_rays;
  const std::span<const FrameIndex> frames;
  const DirectOptions options;
  const StaticOccluders static_occluders;
  std::unique_ptr<const WindowLighter> only_window;  ///< where there is just one

  std::size_t windows() const {
    return std::max<std::size_t>(1, (frames.size() + kWindowMax - 1) / kWindowMax);
  }

  std::unique_ptr<const WindowLighter> make_window(std::size_t window) const {
    const std::size_t begin = window * kWindowMax;
    const auto part = frames.subspan(begin, std::min(kWindowMax, frames.size() - begin));
    return std::make_unique<const WindowLighter>(patches, animation, emission, static_rays, static_occluders,
                                                 part, options, window == 0);
  }

  /// Into the columns of the window.
  void store(const PatchSums& sums, PatchId patch, std::size_t window, DirectLight& into) const {
    const std::size_t begin = window * kWindowMax;
    const auto count = static_cast<std::uint32_t>(std::min(kWindowMax, frames.size() - begin));
    Rgb* mean = into.irradiance_w_m2.row(patch) + begin;
    for (std::uint32_t slot = 0; slot < count; ++slot) mean[slot] = sums.mean(slot);
    if (sums.replicates() > 1) {
      Rgb* variance = into.variance.row(patch) + begin;
      for (std::uint32_t slot = 0; slot < count; ++slot) variance[slot] = sums.variance(slot);
    }
    if (window == 0) into.at_rest_w_m2[patch] = sums.mean_at_rest();
  }
};

DirectLighter::DirectLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                             const StaticRays& static_rays, std::span<const FrameIndex> frames,
                             const DirectOptions& options) {
  auto impl = std::unique_ptr<Impl>(
      new Impl{patches, animation, emission, static_rays, frames, options, {patches, animation}, nullptr});
  if (impl->windows() == 1) impl->only_window = impl->make_window(0);
  impl_ = std::move(impl);
}

DirectLighter::~DirectLighter() = default;

DirectLight DirectLighter::empty() const {
  const auto frames = static_cast<std::uint32_t>(impl_->frames.size());
  const std::uint32_t patches = impl_->patches.count();
  DirectLight light;
  light.irradiance_w_m2 = PatchSeries(patches, frames);
  if (impl_->options.replicates > 1) light.variance = PatchSeries(patches, frames);
  light.at_rest_w_m2.resize(patches);
  return light;
}

api::Status DirectLighter::light(PatchId first, PatchId end, DirectLight& into,
                                 const Progress& progress) const {
  const std::size_t tasks = (end - first + kPatchesPerTask - 1) / kPatchesPerTask;
  const std::size_t windows = impl_->windows();
  const auto slots = static_cast<std::uint32_t>(std::min(kWindowMax, impl_->frames.size()));
  std::atomic<std::size_t> done = 0;
  std::atomic<std::uint64_t> samples = 0, rays = 0;
  std::atomic<bool> stopped = false;
  for (std::size_t window = 0; window < windows && !stopped; ++window) {
    const auto made = impl_->only_window ? nullptr : impl_->make_window(window);
    const WindowLighter& lighter = made ? *made : *impl_->only_window;
    parallel_for(tasks, [&](std::size_t task) {
      const PatchId from = first + static_cast<PatchId>(task) * kPatchesPerTask;
      PatchSums sums(std::max(1u, impl_->options.replicates), slots);
      PatchLighter of_patch(lighter.window(), sums);
      for (PatchId patch = from; patch < std::min(from + kPatchesPerTask, end); ++patch) {
        if (stopped || progress.stop_requested()) {
          stopped = true;
          return;
        }
        sums.clear();
        lighter.light_patch(patch, of_patch);
        impl_->store(sums, patch, window, into);
      }
      samples += of_patch.samples();
      rays += of_patch.rays();
      progress.report(static_cast<double>(++done) / static_cast<double>(tasks * windows));
    });
  }
  into.counts += {samples, rays};
  if (stopped) return api::Error{api::Fault::stopped, "stopped while lighting directly"};
  return api::Done{};
}

api::Result<DirectLight> direct_light(const Patches& patches, const Animation& animation,
                                      const Emission& emission, const StaticRays& static_rays,
                                      std::span<const FrameIndex> frames, const DirectOptions& options,
                                      const Progress& progress) {
  const DirectLighter lighter(patches, animation, emission, static_rays, frames, options);
  DirectLight light = lighter.empty();
  if (const auto lit = lighter.light(0, patches.count(), light, progress); !lit) return lit.error();
  return light;
}

}  // namespace engine
