// The furnace: where everything emits and reflects alike, every patch has B = E / (1 - rho), whatever closed
// things move or appear inside.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

constexpr FrameIndex kFrames = 12;
constexpr Rgb kReflectance{0.5f, 0.3f, 0.1f};
constexpr Rgb kExitance{1.0f, 1.0f, 1.0f};
constexpr Rgb kExact{1.0f / (1.0f - 0.5f), 1.0f / (1.0f - 0.3f), 1.0f / (1.0f - 0.1f)};

/// A room with a box at rest, one that moves, one that turns as it moves, and one that is there in some
/// frames only. They never touch.
SceneBuilder furnace() {
  SceneBuilder built(kFrames);
  const auto paint = built.add_material(kReflectance, kExitance);
  built.add_box({0, 0, 0}, {4, 3, 2.5f}, true, paint);
  built.add_box({0.3f, 0.3f, 0.2f}, {0.9f, 1.1f, 0.7f}, false, paint);
  engine::ObjectMotion gliding, turning;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    gliding.spans.push_back({f, f, turned_and_moved(0, 1.4 + 0.15 * f, 2.2, 1.9)});
    turning.spans.push_back({f, f, turned_and_moved(0.23 * f, 1.7 + 0.1 * f, 1.0, 0.6)});
  }
  const auto glider = built.add_object(gliding), turner = built.add_object(turning);
  const auto guest = built.add_object({{{3, 4, {}}, {8, 9, {}}}});
  built.add_box({-0.3f, -0.2f, -0.25f}, {0.3f, 0.2f, 0.25f}, false, paint, glider);
  built.add_box({-0.35f, -0.3f, -0.3f}, {0.35f, 0.3f, 0.3f}, false, paint, turner);
  built.add_box({0.4f, 1.6f, 0.5f}, {0.8f, 2.0f, 1.3f}, false, paint, guest);
  return built;
}

bool is_there(const ReadyScene& ready, PatchId patch, FrameIndex frame) {
  for (const auto& span :
       ready.animation.objects[ready.patches.facets[ready.patches.facet_of[patch]].object].spans)
    if (span.first <= frame && frame <= span.last) return true;
  return false;
}

double largest_relative_error(Rgb value, Rgb exact) {
  return std::max({std::abs(double{value.r} / exact.r - 1), std::abs(double{value.g} / exact.g - 1),
                   std::abs(double{value.b} / exact.b - 1)});
}

}  // namespace

// No chance in it: rows are divided by their actual crossings, so each row of the operator sums to one and B
// is exact for any lines. What is left is the iteration, which stops when a step is below 1e-5 of E and so
// within 1e-5 rho of B (half of the tolerance), and the rounding of sums in single precision (the other
// half). One lost hit would show: rows have hundreds of crossings, so a single one is over 1e-4.
TEST(Furnace, EveryPatchAndFrameIsExactWhenAllLightTravelsByLines) {
  const ReadyScene ready(furnace(), 0.5);
  api::LightingOptions options;
  options.direct = api::DirectLight::pure;
  options.line_count = 200'000;
  for (const std::uint64_t seed : {1, 2, 3}) {
    options.seed = seed;
    const LitFrames lit = light_frames(ready, every_frame(ready.animation), options);
    double worst = 0;
    for (PatchId patch = 0; patch < ready.patches.count(); ++patch)
      for (FrameIndex f = 0; f < kFrames; ++f) {
        const Rgb found = lit.radiosity.at(patch, f);
        if (is_there(ready, patch, f))
          worst = std::max(worst, largest_relative_error(found, kExact));
        else
          ASSERT_EQ(found, Rgb{}) << "patch " << patch << " is not there in frame " << f;
      }
    EXPECT_LT(worst, 1e-5) << "seed " << seed;
  }
}

// Direct light is sampled: each patch is within chance of the exact value, and so is the mean of those at
// rest and of those that move. One false alarm in 10,000 choices of seeds, over the red (the
// highest reflectance) of all patches in two frames.
TEST(Furnace, IsExactInTheMeanWhenDirectLightIsApart) {
  const ReadyScene ready(furnace(), 0.5);
  const std::vector<FrameIndex> frames{4, 8};  // all boxes are there
  std::vector<PatchId> resting, moving;
  for (PatchId p = 0; p < ready.patches.count(); ++p) (ready.moves(p) ? moving : resting).push_back(p);
  Sample of_resting[2], of_moving[2];
  std::vector<Sample> of_patch(2 * ready.patches.count());
  api::LightingOptions options;
  options.line_count = 100'000;
  options.samples_per_light = 32;
  for (options.seed = 1; options.seed <= 24; ++options.seed) {
    const LitFrames lit = light_frames(ready, frames, options);
    for (std::uint32_t k = 0; k < 2; ++k) {
      of_resting[k].add(mean_over(ready, lit.radiosity, resting, k).r);
      of_moving[k].add(mean_over(ready, lit.radiosity, moving, k).r);
      for (PatchId p = 0; p < ready.patches.count(); ++p) of_patch[2 * p + k].add(lit.radiosity.at(p, k).r);
    }
  }
  const double false_alarm = 1e-4 / static_cast<double>(of_patch.size() + 4);
  constexpr double kIteration = 1e-5;  // where it stops, as above
  for (std::uint32_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(agrees(of_resting[k], 2.0, false_alarm, kIteration));
    EXPECT_TRUE(agrees(of_moving[k], 2.0, false_alarm, kIteration));
    EXPECT_LT(of_resting[k].standard_error(), 1e-3);
    EXPECT_LT(of_moving[k].standard_error(), 1e-3);
  }
  for (std::size_t k = 0; k < of_patch.size(); ++k)
    EXPECT_TRUE(agrees(of_patch[k], 2.0, false_alarm, kIteration))
        << "patch " << k / 2 << ", frame " << frames[k % 2];
}

}  // namespace tests
