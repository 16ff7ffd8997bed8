#include "engine/direct/window_lighter.h"

#include <algorithm>
#include <array>

#include "engine/base/sobol.h"
#include "engine/direct/scene_reach.h"

namespace engine {
namespace {

std::uint64_t seed_of(const DirectOptions& options, std::uint32_t replicate, PatchId patch,
                      std::uint32_t stream) {
  return stream_seed(stream_seed(options.seed, replicate), (std::uint64_t{patch} << 32) | stream);
}

Draw draw_number(std::uint32_t index, std::uint64_t seed) {
  const auto [a, b, c, d] = owen_sobol(index, seed);
  return {a, b, c, d, static_cast<float>(mix(seed + index) >> 40) * 0x1p-24f};
}

/// Sums of F V over the samples of one patch, light and replicate.
struct Factors {
  float unblocked = 0;                    ///< moving surfaces left out
  bool any_blocked = false;               ///< does `blocked` hold anything?
  std::array<float, kWindowMax> blocked;  ///< what moving surfaces take away, [slot]

  void block(float factor, const SlotMask& mask, Slots slots) {
    if ((mask.bits[0] | mask.bits[1]) == 0) return;
    if (!any_blocked) std::fill(blocked.data() + slots.begin, blocked.data() + slots.end, 0.0f);
    any_blocked = true;
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      if (mask.test(slot)) blocked[slot] += factor;
  }
};

}  // namespace

/// The lighting of one patch.
class WindowLighter::Work {
 public:
  Work(const WindowLighter& of, PatchSums& sums) : of_(of), sums_(sums) {}

  void add_lights(const Receiver& receiver) {
    for (const WindowLight& light : of_.lights_.lights) {
      if (light.facet == receiver.facet) continue;  // flat: rounding alone puts it in its own sight
      for (const LightPose& pose : light.poses) add_light(receiver, light, pose);
    }
  }

  std::uint64_t rays() const { return rays_; }

 private:
  void add_light(const Receiver& receiver, const WindowLight& light, const LightPose& pose) {
    const Brightness& brightness = of_.lights_.brightness[light.brightness];
    const Slots slots = narrow_to_lit(brightness.lit, overlap(receiver.slots, pose.slots));
    const bool rests = of_.with_rest_ && receiver.is_static && light.is_static;
    if (slots.empty() && !rests) return;
    const Arrivals arrivals(receiver, pose, of_.reach_m_);
    if (!arrivals.possible()) return;

    const std::uint32_t count = rays_per_replicate();
    const float share = 1.0f / static_cast<float>(count);
    for (std::uint32_t r = 0; r < sums_.replicates(); ++r) {
      const std::uint64_t seed = seed_of(of_.options_, r, receiver.patch, light.stream);
      Factors factors;
      for (std::uint32_t s = 0; s < count; ++s) {
        const Arrival arrival = arrivals.draw(draw_number(s, seed));
        if (arrival.factor <= 0 || !passes_static(arrival.shadow)) continue;
        factors.unblocked += arrival.factor;
        factors.block(arrival.factor, blocked_slots(arrival.shadow, slots), slots);
      }
      if (factors.unblocked == 0) continue;
      add(factors, share, brightness, slots, sums_.of(r));
      if (rests) sums_.at_rest(r) += brightness.mean * (factors.unblocked * share);
    }
  }

  static void add(const Factors& factors, float share, const Brightness& brightness, Slots slots, Rgb* row) {
    const Rgb* of_slot = brightness.of_slot.data();
    if (!factors.any_blocked) {
      const float factor = factors.unblocked * share;
      for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) row[slot] += of_slot[slot] * factor;
      return;
    }
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      row[slot] += of_slot[slot] * (std::max(0.0f, factors.unblocked - factors.blocked[slot]) * share);
  }

  bool passes_static(const Ray& ray) {
    ++rays_;
    return !of_.static_rays_.occluded(ray);
  }

  SlotMask blocked_slots(const Ray& ray, Slots slots) const {
    if (slots.empty()) return {};
    if (slots.begin + 1 < slots.end) return of_.moving_rays_->blocked(ray);
    SlotMask mask;
    if (of_.moving_rays_->occluded(ray, slots.begin)) mask.set(slots.begin, slots.begin);
    return mask;
  }

  std::uint32_t rays_per_replicate() const {
    return std::max(1u, of_.options_.samples_per_light / sums_.replicates());
  }

  const WindowLighter& of_;
  PatchSums& sums_;
  std::uint64_t rays_ = 0;
};

WindowLighter::WindowLighter(const Patches& patches, const Animation& animation, const Emission& emission,
                             const StaticRays& static_rays, std::span<const FrameIndex> frames,
                             const DirectOptions& options, bool with_rest)
    : patches_(patches),
      animation_(animation),
      static_rays_(static_rays),
      frames_(frames),
      options_(options),
      with_rest_(with_rest),
      reach_m_(scene_reach_m(patches, animation)),
      lights_(place_window_lights(patches, animation, emission, frames)),
      moving_rays_(frames.empty() ? nullptr : new MovingRays(patches, animation, frames)) {}

std::uint64_t WindowLighter::light_patch(PatchId patch, PatchSums& sums) const {
  Work work(*this, sums);
  for (const Receiver& receiver : place_receiver(patches_, animation_, patch, frames_))
    work.add_lights(receiver);
  return work.rays();
}

}  // namespace engine
