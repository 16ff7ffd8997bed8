// Many frames at once are the same as each alone; nothing depends on which frames are solved beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/pipeline/solve_sequence.h"
#include "tests/support/lit.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

/// The garage on 2 m patches: small, but with all that moves in it.
const ReadyScene& garage() {
  static const Example example = load_example("garage");
  static const ReadyScene ready(example.scene, example.animation, 2.0);
  return ready;
}

api::LightingOptions few_lines() {
  api::LightingOptions options;
  options.line_count = 200'000;
  return options;
}

/// Largest difference of two irradiances, each iterated to within 1e-5 rho / (1 - rho) of the mean source:
/// 2.4e-5 for the garage's ceiling of .7, so 5e-5 for two of them. The source is reflected direct light, less
/// than the mean radiosity of .12 W/m^2. Single precision rounds sums of about 1,000 terms, in another order
/// where other frames share the window: 1e-5 of the largest of them.
double allowed_w_m2(const engine::PatchSeries& irradiance) {
  float largest = 0;
  for (const Rgb value : irradiance.values) largest = std::max(largest, engine::max_channel(value));
  return 5e-5 * 0.12 + 1e-5 * double{largest};
}

double difference(Rgb a, Rgb b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

/// Position `k` of `one` against position `l` of `other`.
void expect_equal_frames(const LitFrames& one, std::uint32_t k, const LitFrames& other, std::uint32_t l) {
  double worst = 0;
  std::uint32_t direct_differs = 0;
  for (PatchId p = 0; p < one.direct.patch_count; ++p) {
    direct_differs += !(one.direct.at(p, k) == other.direct.at(p, l));
    worst = std::max(worst, difference(one.indirect.at(p, k), other.indirect.at(p, l)));
  }
  EXPECT_EQ(direct_differs, 0u) << "direct light must be the same bit for bit";
  EXPECT_LE(worst, allowed_w_m2(one.indirect));
}

/// The same animation backwards.
engine::Animation reversed(engine::Animation animation) {
  const FrameIndex last = animation.frame_count - 1;
  for (engine::ObjectMotion& motion : animation.objects) {
    std::reverse(motion.spans.begin(), motion.spans.end());
    for (engine::PoseSpan& span : motion.spans) span = {last - span.last, last - span.first, span.pose};
  }
  for (auto& series : animation.emission.exitance_w_m2) std::reverse(series.begin(), series.end());
  return animation;
}

}  // namespace

TEST(MultiFrame, EveryFrameEqualsTheSameFrameSolvedAlone) {
  const std::vector<FrameIndex> frames = every_frame(garage().animation);
  const LitFrames together = light_frames(garage(), frames, few_lines());
  for (const FrameIndex frame : {0u, 17u, 60u, 61u, 119u}) {
    SCOPED_TRACE("frame " + std::to_string(frame));
    expect_equal_frames(light_frames(garage(), {frame}, few_lines()), 0, together, frame);
  }
}

TEST(MultiFrame, AFrameDoesNotDependOnTheFramesBesideIt) {
  const LitFrames some = light_frames(garage(), {3, 60, 100}, few_lines());
  const LitFrames others = light_frames(garage(), {59, 60, 61, 62, 63}, few_lines());
  expect_equal_frames(some, 1, others, 1);
}

TEST(MultiFrame, BackwardsIsTheSameFramesInTheOtherOrder) {
  const ReadyScene backwards(garage().scene, reversed(garage().animation), 2.0);
  const LitFrames forth = light_frames(garage(), {5, 40, 90}, few_lines());
  const LitFrames back = light_frames(backwards, {29, 79, 114}, few_lines());
  for (std::uint32_t k = 0; k < 3; ++k) expect_equal_frames(forth, k, back, 2 - k);
}

TEST(MultiFrame, FramesInWhichTheSceneDiffersDoDiffer) {
  const LitFrames lit = light_frames(garage(), {20, 60}, few_lines());
  double worst = 0;
  for (PatchId p = 0; p < lit.indirect.patch_count; ++p)
    worst = std::max(worst, difference(lit.indirect.at(p, 0), lit.indirect.at(p, 1)));
  EXPECT_GT(worst, 20 * allowed_w_m2(lit.indirect)) << "else the tests above would show nothing";
}

TEST(StaticScene, HasEqualFramesAndItsFirstAndLastFrameAsKeys) {
  SceneBuilder built(30);
  const auto wall = built.add_material({0.5f, 0.6f, 0.7f}), lamp = built.add_material({}, {5, 4, 3});
  built.add_box({0, 0, 0}, {4, 3, 2}, true, wall);
  built.add_box({1, 1, 0.2f}, {2, 2, 0.9f}, false, wall);
  built.add_polygon({{2, 1, 1.9f}, {2, 2, 1.9f}, {3, 2, 1.9f}, {3, 1, 1.9f}}, lamp);
  const ReadyScene ready(built, 0.5);
  for (const auto mode : {api::LightingMode::standard, api::LightingMode::paper,
                          api::LightingMode::paper_literal, api::LightingMode::reference}) {
    SCOPED_TRACE(static_cast<int>(mode));
    api::LightingOptions options = few_lines();
    options.mode = mode;
    api::JobReport report;
    const engine::RunHooks hooks;
    engine::StageClock clock(hooks, report);
    const auto solved = engine::solve_sequence(ready.lit, options, clock, report);
    ASSERT_TRUE(solved);
    for (PatchId p = 0; p < ready.patches.count(); ++p)
      for (FrameIndex f = 1; f < 30; ++f)
        // Between keys a + (b - a) w with a = b is a within two roundings.
        ASSERT_LE(difference(solved->radiosity_w_m2.at(p, f), solved->radiosity_w_m2.at(p, 0)),
                  3e-7 * engine::max_channel(solved->radiosity_w_m2.at(p, 0)));
    if (mode == api::LightingMode::reference) continue;
    for (const api::FrameRecord& record : solved->key_frames.frames)
      EXPECT_EQ(record.kind == api::FrameKind::key, record.frame == 0 || record.frame == 29)
          << "frame " << record.frame;
  }
}

}  // namespace tests
