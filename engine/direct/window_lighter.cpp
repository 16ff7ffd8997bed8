#include "engine/direct/window_lighter.h"

#include <algorithm>
#include <array>

#include "engine/base/sobol.h"
#include "engine/direct/light_choice.h"
#include "engine/direct/scene_reach.h"

namespace engine {
namespace {

std::uint64_t seed_of(const DirectOptions& options, std::uint32_t replicate, PatchId patch,
                      std::uint32_t stream) {
  return stream_seed(stream_seed(options.seed, replicate), (std::uint64_t{patch} << 32) | stream);
}

/// Streams of the draws among many lights, beside those of single lights.
constexpr std::uint32_t kStaticStream = 0xffffffffu, kMovingStream = 0xfffffffeu;

/// Uniform in [0, 1): where in part `index` of the row of probabilities a light is drawn.
double place_in_part(std::uint32_t index, std::uint64_t seed) {
  return static_cast<double>(mix(~seed + index) >> 11) * 0x1p-53;
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

/// Points [first, end) of a set, and what each counts.
struct WindowLighter::SampleSet {
  std::uint64_t seed = 0;
  std::uint32_t first = 0, end = 0;
  float weight = 1;
};

/// The lighting of one patch.
class WindowLighter::Work {
 public:
  Work(const WindowLighter& of, PatchSums& sums) : of_(of), sums_(sums) {}

  void add_lights(const Receiver& receiver) {
    const std::span<const WindowLight> all = of_.lights_.lights;
    add_lights(receiver, all.first(of_.lights_.static_count), kStaticStream);
    add_lights(receiver, all.subspan(of_.lights_.static_count), kMovingStream);
  }

  std::uint64_t rays() const { return rays_; }

 private:
  void add_lights(const Receiver& receiver, std::span<const WindowLight> lights, std::uint32_t stream) {
    if (lights.empty()) return;
    const LightChoice choice = choose_lights(receiver, lights, of_.lights_.brightness);
    const std::uint32_t count = rays_per_replicate(1);
    for (const std::uint32_t l : choice.each)
      for (std::uint32_t r = 0; r < sums_.replicates(); ++r)
        add_light(receiver, lights[l], r,
                  {seed_of(of_.options_, r, receiver.patch, lights[l].stream), 0, count,
                   1.0f / static_cast<float>(count)});
    if (choice.drawn.empty()) return;
    for (std::uint32_t r = 0; r < sums_.replicates(); ++r)
      add_drawn(receiver, lights, choice, r, seed_of(of_.options_, r, receiver.patch, stream));
  }

  /// One draw in each of n equal parts of the row of probabilities: a light of p gets n p draws, one more or
  /// less, and all of its draws follow one another.
  void add_drawn(const Receiver& receiver, std::span<const WindowLight> lights, const LightChoice& choice,
                 std::uint32_t replicate, std::uint64_t seed) {
    const std::uint32_t count = rays_per_replicate(choice.shared_lights);
    const auto n = static_cast<double>(count);
    double below = 0;  // probability of the lights before
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < choice.drawn.size() && next < count; ++k) {
      const DrawnLight& drawn = choice.drawn[k];
      below += drawn.probability;
      const std::uint32_t first = next;
      const bool is_last = k + 1 == choice.drawn.size();  // takes what rounding leaves
      while (next < count && (is_last || next + place_in_part(next, seed) < n * below)) ++next;
      if (next == first) continue;
      add_light(receiver, lights[drawn.light], replicate,
                {seed, first, next, static_cast<float>(1.0 / (n * drawn.probability))});
    }
  }

  /// In all of its poses that meet the receiver's slots.
  void add_light(const Receiver& receiver, const WindowLight& light, std::uint32_t replicate,
                 const SampleSet& samples) {
    if (light.facet == receiver.facet) return;  // flat: rounding alone puts it in its own sight
    const Brightness& brightness = of_.lights_.brightness.of[light.brightness];
    const bool rests = of_.with_rest_ && receiver.is_static && light.is_static;
    for (const LightPose& pose : light.poses) {
      const Slots slots = narrow_to_lit(brightness.lit, overlap(receiver.slots, pose.slots));
      if (slots.empty() && !rests) continue;
      const Arrivals arrivals(receiver, pose, of_.reach_m_);
      if (!arrivals.possible()) continue;
      Factors factors;
      for (std::uint32_t s = samples.first; s < samples.end; ++s) {
        const Arrival arrival = arrivals.draw(draw_number(s, samples.seed));
        if (arrival.factor <= 0 || !passes_static(arrival.shadow)) continue;
        factors.unblocked += arrival.factor;
        factors.block(arrival.factor, blocked_slots(arrival.shadow, slots), slots);
      }
      if (factors.unblocked == 0) continue;
      add(factors, samples.weight, brightness, slots, sums_.of(replicate));
      if (rests) sums_.at_rest(replicate) += brightness.mean * (factors.unblocked * samples.weight);
    }
  }

  static void add(const Factors& factors, float weight, const Brightness& brightness, Slots slots, Rgb* row) {
    const Rgb* of_slot = brightness.of_slot.data();
    if (!factors.any_blocked) {
      const float factor = factors.unblocked * weight;
      for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) row[slot] += of_slot[slot] * factor;
      return;
    }
    for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot)
      row[slot] += of_slot[slot] * (std::max(0.0f, factors.unblocked - factors.blocked[slot]) * weight);
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

  /// For as many as `lights` lights.
  std::uint32_t rays_per_replicate(float lights) const {
    const float all = lights * static_cast<float>(of_.options_.samples_per_light);
    return std::max(1u, static_cast<std::uint32_t>(all / static_cast<float>(sums_.replicates())));
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
