#include "engine/direct/patch_lighter.h"

#include <algorithm>
#include <numeric>

#include "engine/base/sobol.h"
#include "engine/direct/form_factor.h"

namespace engine {
namespace {

std::uint64_t seed_of(const DirectOptions& options, std::uint32_t replicate, PatchId patch,
                      std::uint32_t stream) {
  return stream_seed(stream_seed(options.seed, replicate), (std::uint64_t{patch} << 32) | stream);
}

/// Streams of the draws among many lights, beside those of single lights.
constexpr std::uint32_t kStaticStream = 0xffffffffu, kMovingStream = 0xfffffffeu;

/// A ray asks a tree in the time it takes to look at about so many facets, sixteen rays at once.
constexpr std::size_t kFacetsPerRay = 4;

/// Uniform in [0, 1): where in part `index` of the row of probabilities a light is drawn.
double place_in_part(std::uint32_t index, std::uint64_t seed) {
  return static_cast<double>(mix(~seed + index) >> 11) * 0x1p-53;
}

/// row[slot] += brightness of the slot * factor
void add(const Brightness& brightness, float factor, Slots slots, Rgb* row) {
  const Rgb* of_slot = brightness.of_slot.data();
  for (std::uint32_t slot = slots.begin; slot < slots.end; ++slot) row[slot] += of_slot[slot] * factor;
}

ShaftEnd end_at(const Receiver& receiver, const Roughness& there) {
  ShaftEnd end;
  end.count = receiver.cell.count;
  for (std::uint32_t c = 0; c < end.count; ++c)
    end.corners[c] = point_at(receiver.placed, receiver.cell.u[c], receiver.cell.v[c]);
  end.normal = receiver.placed.normal;
  end.slack_m = clearance_m(receiver.roughness, there);
  return end;
}

ShaftEnd end_at(const LightPose& light, const ShaftEnd& receiver, const Roughness& there, float reach_m) {
  ShaftEnd end;
  end.slack_m = clearance_m(light.roughness, there);
  if (!light.source) {
    const auto polygon = light.facet.polygon();
    end.count = static_cast<std::uint32_t>(polygon.size());
    std::copy(polygon.begin(), polygon.end(), end.corners.begin());
    end.normal = light.facet.placed.normal;
  } else if (light.source->type == api::LightType::directional) {
    end.count = receiver.count;
    for (std::uint32_t c = 0; c < end.count; ++c)
      end.corners[c] = receiver.corners[c] - reach_m * light.direction;
  } else {
    end.count = 1;
    end.corners[0] = light.position;
  }
  return end;
}

}  // namespace

void PatchLighter::Samples::resize(std::size_t count) {
  for (auto* of : {&x, &y, &z, &light_a, &light_b, &piece, &factor}) of->resize(count);
}

void PatchLighter::Samples::place(std::size_t k, const Receiver& receiver, std::uint32_t index,
                                  std::uint64_t seed) {
  const auto [a, b, c, d] = owen_sobol(index, seed);
  const Vec3 at = receiver.at(a, b);
  x[k] = at.x;
  y[k] = at.y;
  z[k] = at.z;
  light_a[k] = c;
  light_b[k] = d;
  piece[k] = static_cast<float>(mix(seed + index) >> 40) * 0x1p-24f;
}

void PatchLighter::add_lights(const Receiver& receiver) {
  const std::span<const WindowLight> all = window_.lights->lights;
  add_lights(receiver, all.first(window_.lights->static_count), kStaticStream);
  add_lights(receiver, all.subspan(window_.lights->static_count), kMovingStream);
}

void PatchLighter::add_lights(const Receiver& receiver, std::span<const WindowLight> lights,
                              std::uint32_t stream) {
  if (lights.empty()) return;
  const LightChoice choice = choose_lights(receiver, lights, window_.lights->brightness);
  for (const std::uint32_t l : choice.each) add_own(receiver, lights[l]);
  if (choice.drawn.empty()) return;
  for (std::uint32_t r = 0; r < sums_.replicates(); ++r)
    add_drawn(receiver, lights, choice, r, seed_of(window_.options, r, receiver.patch, stream));
}

/// A light with samples of its own.
void PatchLighter::add_own(const Receiver& receiver, const WindowLight& light) {
  if (light.facet == receiver.facet) return;  // flat: rounding alone puts it in its own sight
  const std::uint32_t count = samples_per_replicate(1);
  bool placed = false;
  for_each_pose(receiver, light, [&](const Sight& sight) {
    if (!placed) {
      samples_.resize(std::size_t{sums_.replicates()} * count);
      for (std::uint32_t r = 0; r < sums_.replicates(); ++r) {
        const std::uint64_t seed = seed_of(window_.options, r, receiver.patch, light.stream);
        for (std::uint32_t s = 0; s < count; ++s)
          samples_.place(std::size_t{r} * count + s, receiver, s, seed);
      }
      placed = true;
    }
    add_samples(sight, 0, count, 1.0f / static_cast<float>(count));
  });
}

/// One draw in each of n equal parts of the row of probabilities: a light of p gets n p draws, one more or
/// less, and all of its draws follow one another.
void PatchLighter::add_drawn(const Receiver& receiver, std::span<const WindowLight> lights,
                             const LightChoice& choice, std::uint32_t replicate, std::uint64_t seed) {
  const std::uint32_t count = samples_per_replicate(choice.shared_lights);
  const auto n = static_cast<double>(count);
  double below = 0;  // probability of the lights before
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < choice.drawn.size() && next < count; ++k) {
    const DrawnLight& drawn = choice.drawn[k];
    below += drawn.probability;
    const std::uint32_t first = next;
    const bool is_last = k + 1 == choice.drawn.size();  // takes what rounding leaves
    while (next < count && (is_last || next + place_in_part(next, seed) < n * below)) ++next;
    const WindowLight& light = lights[drawn.light];
    if (next == first || light.facet == receiver.facet) continue;
    samples_.resize(next - first);
    for (std::uint32_t s = first; s < next; ++s) samples_.place(s - first, receiver, s, seed);
    for_each_pose(receiver, light, [&](const Sight& sight) {
      add_samples(sight, replicate, next - first, static_cast<float>(1.0 / (n * drawn.probability)));
    });
  }
}

/// Calls use(Sight) for the poses of the light that may shine on the patch.
template <class Use>
void PatchLighter::for_each_pose(const Receiver& receiver, const WindowLight& light, Use&& use) {
  const Brightness& brightness = window_.lights->brightness.of[light.brightness];
  const bool rests = window_.with_rest && receiver.is_static && light.is_static;
  for (const LightPose& pose : light.poses) {
    const Slots slots = narrow_to_lit(brightness.lit, overlap(receiver.slots, pose.slots));
    if (slots.empty() && !rests) continue;
    const Sight sight{receiver, pose, Arrivals(receiver, pose, window_.reach_m), brightness, slots, rests};
    if (sight.arrivals.possible()) use(sight);
  }
}

void PatchLighter::find_factors(const Sight& sight) {
  const PointArrays points{samples_.x.data(), samples_.y.data(), samples_.z.data(), samples_.x.size()};
  if (!sight.pose.source) {
    const PlacedFacet &at = sight.receiver.placed, &light = sight.pose.facet.placed;
    PolygonOverPlane(at.origin, at.normal, sight.pose.facet.polygon(), light.normal)
        .form_factors(points, samples_.factor.data());
    return;
  }
  for (std::size_t k = 0; k < points.count; ++k)
    samples_.factor[k] = sight.arrivals.source_factor(samples_.point(k));
}

/// All samples there are, `count` of each replicate from `first_replicate` on.
void PatchLighter::add_samples(const Sight& sight, std::uint32_t first_replicate, std::uint32_t count,
                               float weight) {
  samples_taken_ += samples_.factor.size();
  find_factors(sight);
  look_between(sight);
  if (!shadows_.none()) cast_shadows(sight, count);
  const auto replicates = static_cast<std::uint32_t>(samples_.factor.size() / count);
  for (std::uint32_t r = 0; r < replicates; ++r) {
    const float* of_replicate = samples_.factor.data() + std::size_t{r} * count;
    const float unblocked = std::accumulate(of_replicate, of_replicate + count, 0.0f) * weight;
    if (unblocked == 0) continue;
    Rgb* row = sums_.of(first_replicate + r);
    if (sight.rests) sums_.at_rest(first_replicate + r) += sight.brightness.mean * unblocked;
    if (shadows_.contents.none_moving()) {
      add(sight.brightness, unblocked, sight.slots, row);
      continue;
    }
    const float* blocked = blocked_.data() + std::size_t{r} * kWindowMax;
    for (std::uint32_t slot = sight.slots.begin; slot < sight.slots.end; ++slot)
      row[slot] += sight.brightness.of_slot[slot] * std::max(0.0f, unblocked - blocked[slot] * weight);
  }
}

/// Finds what may stand between the patch and the light.
void PatchLighter::look_between(const Sight& sight) {
  const ShaftEnd here = end_at(sight.receiver, sight.pose.roughness);
  const Shaft shaft(here, end_at(sight.pose, here, sight.receiver.roughness, window_.reach_m));
  shadows_.contents.clear();
  window_.static_occluders->collect(shaft, kFacetsPerRay * samples_.factor.size(), shadows_.contents);
  if (!sight.slots.empty())
    window_.moving_occluders->collect(shaft, sight.receiver.is_static, sight.slots.begin, sight.slots.end - 1,
                                      shadows_.contents);
}

/// Clears the factors of samples that what rests blocks, and sums those that what moves blocks in a slot.
void PatchLighter::cast_shadows(const Sight& sight, std::uint32_t count) {
  std::vector<float>& factor = samples_.factor;
  shadows_.begin(factor.size());
  for (std::size_t k = 0; k < factor.size(); ++k) {
    if (factor[k] <= 0) continue;
    ++rays_;
    shadows_.set(k, sight.arrivals.shadow(samples_.point(k),
                                          {samples_.light_a[k], samples_.light_b[k], samples_.piece[k]}));
  }
  shadows_.cast(sight.slots);
  for (std::size_t k = 0; k < factor.size(); ++k)
    if (shadows_.blocked_at_rest(k)) factor[k] = 0;
  if (shadows_.contents.none_moving()) return;
  blocked_.assign(factor.size() / count * kWindowMax, 0.0f);
  shadows_.each_blocked(sight.slots, [&](std::size_t k, std::uint32_t slot) {
    blocked_[k / count * kWindowMax + slot] += factor[k];
  });
}

/// For as many as `lights` lights.
std::uint32_t PatchLighter::samples_per_replicate(float lights) const {
  const float all = lights * static_cast<float>(window_.options.samples_per_light);
  return std::max(1u, static_cast<std::uint32_t>(all / static_cast<float>(sums_.replicates())));
}

}  // namespace engine
