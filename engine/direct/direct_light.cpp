#include "engine/direct/direct_light.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>

#include "engine/base/parallel.h"
#include "engine/direct/window_lighter.h"

namespace engine {
namespace {

/// Those that move take as long in a slot as others in all: they are lit in so many slots at a time.
constexpr std::uint32_t kMovingSlots = 16;

/// Room for the sums of a tile, all its replicates together: it should stay in the cache.
constexpr std::uint32_t kSumsMax = 2 * kTileCellsMax;

/// The more replicates, the smaller the tiles: 64, 16, 4, 1.
std::uint32_t cells_per_tile(std::uint32_t replicates) {
  std::uint32_t cells = kTileCellsMax;
  while (cells > 1 && cells * replicates > 4 * kSumsMax) cells /= 4;
  return cells;
}

struct Task {
  Tile tile;
  Slots slots;
};

/// What a tile is lit with; kept for the next one.
struct Bench {
  Bench(const LightingWindow& window, std::uint32_t replicates, std::uint32_t slots)
      : sums(replicates, slots, cells_per_tile(replicates)), lighter(window, sums) {}
  TileLayout layout;
  TileSums sums;
  TileLighter lighter;
};

/// As many as there are threads at work. None of what is kept in one matters to the next tile.
class Benches {
 public:
  template <class Make>
  std::unique_ptr<Bench> take(Make&& make) {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Bench> bench = std::move(idle_.back());
        idle_.pop_back();
        return bench;
      }
    }
    return make();
  }
  void give_back(std::unique_ptr<Bench> bench) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(bench));
  }
  DirectCounts counts() const {
    DirectCounts counts;
    for (const auto& bench : idle_) counts += {bench->lighter.samples(), bench->lighter.rays()};
    return counts;
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Bench>> idle_;
};

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

  std::uint32_t slots_of(std::size_t window) const {
    return static_cast<std::uint32_t>(std::min(kWindowMax, frames.size() - window * kWindowMax));
  }

  std::vector<Task> tasks(PatchId first, PatchId end, std::size_t window) const {
    const std::uint32_t slots = slots_of(window);
    std::vector<Tile> tiles;
    add_tiles(patches, first, end, cells_per_tile(std::max(1u, options.replicates)), tiles);
    std::vector<Task> all;
    for (const Tile& tile : tiles) {
      const ObjectMotion& motion = animation.objects[patches.facets[tile.facet].object];
      const std::uint32_t part = motion.is_static(animation.frame_count) ? kWindowMax : kMovingSlots;
      std::uint32_t slot = 0;
      do {
        all.push_back({tile, {slot, std::min(slots, slot + part)}});
        slot += part;
      } while (slot < slots);
    }
    return all;
  }

  void light(const Task& task, const WindowLighter& lighter, std::size_t window,
             const std::array<PatchId, 2>& asked, Bench& bench, DirectLight& into) const {
    lay_out(patches, task.tile, bench.layout);
    const std::vector<PatchId>& cells = bench.layout.patches;
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (asked[0] <= cells[k] && cells[k] < asked[1]) bits |= std::uint64_t{1} << k;
    if (bits == 0) return;
    bench.sums.begin(static_cast<std::uint32_t>(cells.size()));
    lighter.light_tile(task.tile, bench.layout, bits, task.slots, bench.lighter);
    for (std::uint32_t k = 0; k < cells.size(); ++k)
      if (((bits >> k) & 1) != 0) store(bench.sums, k, cells[k], window, task.slots, into);
  }

  /// Into the columns of the slots.
  void store(const TileSums& sums, std::uint32_t cell, PatchId patch, std::size_t window, Slots slots,
             DirectLight& into) const {
    Rgb* mean = into.irradiance_w_m2.row(patch) + window * kWindowMax;
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) mean[slot] = sums.mean(cell, slot);
    if (sums.replicates() > 1) {
      Rgb* variance = into.variance.row(patch) + window * kWindowMax;
      for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
        variance[slot] = sums.variance(cell, slot);
    }
    if (window == 0 && slots.begin == 0) into.at_rest_w_m2[patch] = sums.mean_at_rest(cell);
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
  const std::size_t windows = impl_->windows();
  std::atomic<bool> stopped = false;
  for (std::size_t window = 0; window < windows && !stopped; ++window) {
    const auto made = impl_->only_window ? nullptr : impl_->make_window(window);
    const WindowLighter& lighter = made ? *made : *impl_->only_window;
    const std::vector<Task> tasks = impl_->tasks(first, end, window);
    Benches benches;
    std::atomic<std::size_t> done = 0;
    parallel_for(tasks.size(), [&](std::size_t t) {
      if (stopped || progress.stop_requested()) {
        stopped = true;
        return;
      }
      auto bench = benches.take([&] {
        return std::make_unique<Bench>(lighter.window(), std::max(1u, impl_->options.replicates),
                                       impl_->slots_of(window));
      });
      impl_->light(tasks[t], lighter, window, {first, end}, *bench, into);
      benches.give_back(std::move(bench));
      progress.report(
          (static_cast<double>(window) + static_cast<double>(++done) / static_cast<double>(tasks.size())) /
          static_cast<double>(windows));
    });
    into.counts += benches.counts();
  }
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
