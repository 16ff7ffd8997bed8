#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/interpolate/interpolate.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using tests::LitRoom;
using tests::SolvedRoom;

constexpr FrameIndex kFrames = 10;
constexpr LineOptions kLines{10'000, 7};

PatchSeries filled(const SolvedRoom& room, const std::vector<std::uint32_t>& slots,
                   api::Interpolation interpolation = api::Interpolation::linear) {
  const Columns columns = tests::columns_of(slots, room.lines.slot_count);
  auto all = fill_between(room.window(), columns, room.solve(columns), interpolation, Progress{});
  EXPECT_TRUE(all);
  return std::move(*all);
}

TEST(FillBetween, WithEveryFrameSolvedNothingChanges) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kLines, kLines);
  EXPECT_EQ(filled(solved, Columns::every(kFrames).slots()).values, solved.solve().irradiance_w_m2.values);
}

TEST(FillBetween, SolvedFramesAreWhatWasSolved) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kLines, kLines);
  const std::vector<std::uint32_t> slots{0, 3, 4, 9};
  const DifferenceLight some = solved.solve(tests::columns_of(slots, kFrames));
  for (const auto kind : {api::Interpolation::linear, api::Interpolation::monotone_cubic}) {
    const PatchSeries all = filled(solved, slots, kind);
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      for (std::uint32_t c = 0; c < slots.size(); ++c)
        ASSERT_NEAR(all.at(patch, slots[c]).g, some.irradiance_w_m2.at(patch, c).g, 4 * kIterationError);
  }
}

// Light is linear in what emits: under a lamp that is turned up steadily the frames between are known from
// the first and the last, as long as nothing moves.
TEST(FillBetween, IsExactWhereALampIsTurnedUpSteadilyAndNothingMoves) {
  LitRoom room(kFrames);
  for (ObjectMotion& motion : room.animation.objects) motion.spans = {{0, kFrames - 1, {}}};
  room.animation.emission.exitance_w_m2[1].clear();
  for (FrameIndex f = 0; f < kFrames; ++f)
    room.animation.emission.exitance_w_m2[1].push_back(Rgb{2, 1, 3} * static_cast<float>(f));
  const tests::World world(room.scene, room.animation, 1.0);
  const SolvedRoom solved(world, {&world.animation.emission}, kLines, kLines);
  const DifferenceLight every = solved.solve();
  double largest = 0;
  for (const Rgb value : every.irradiance_w_m2.values) largest = std::max(largest, std::abs(double{value.b}));
  ASSERT_GT(largest, 0.5);
  for (const auto kind : {api::Interpolation::linear, api::Interpolation::monotone_cubic})
    for (const std::vector<std::uint32_t>& slots : {std::vector<std::uint32_t>{0, 9}, {0, 2, 9}}) {
      const PatchSeries all = filled(solved, slots, kind);
      for (std::size_t k = 0; k < all.values.size(); ++k) {
        ASSERT_NEAR(all.values[k].b, every.irradiance_w_m2.values[k].b, 2e-5 * largest);
        ASSERT_NEAR(all.values[k].g, every.irradiance_w_m2.values[k].g, 2e-5 * largest);
      }
    }
}

/// Root mean square of a - b, green, over the patches that move or not, and the frames.
double difference(const LitRoom& room, const PatchSeries& a, const PatchSeries& b, bool of_moving) {
  double squares = 0, count = 0;
  for (PatchId patch = 0; patch < a.patch_count; ++patch)
    for (FrameIndex f = 0; f < kFrames; ++f) {
      if (room.lit().at_rest(patch) == of_moving) continue;
      const double by = double{a.at(patch, f).g} - b.at(patch, f).g;
      squares += by * by;
      count += 1;
    }
  return std::sqrt(squares / count);
}

/// From four frames, and against all of them solved: filling must leave at most `share` of the error that
/// interpolating has.
void expect_better_than_interpolated(const LitRoom& room, const SolvedRoom& solved, double share) {
  const DifferenceLight every = solved.solve();
  const std::vector<std::uint32_t> slots{0, 3, 6, 9};
  const DifferenceLight some = solved.solve(tests::columns_of(slots, kFrames));
  const PatchSeries interpolated = interpolate(
      some.irradiance_w_m2,
      Interpolator(std::vector<FrameIndex>{0, 3, 6, 9}, room.all_frames(), api::Interpolation::linear));
  const PatchSeries all = filled(solved, slots);
  for (const bool of_moving : {true, false})
    EXPECT_LT(difference(room, all, every.irradiance_w_m2, of_moving),
              share * difference(room, interpolated, every.irradiance_w_m2, of_moving))
        << of_moving;
}

// A box that goes round under a lamp: what arrives at it, and its shadow, differ from frame to frame.
// Interpolated from four frames they are far off; gathered in every frame they are nearly right.
TEST(FillBetween, GathersWhatMovesInEveryFrame) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kLines, kLines);
  expect_better_than_interpolated(room, solved, 0.2);
}

// Direct light that is another in every frame, as under a shadow that passes: its first bounce is known in
// every frame, and a random second bounce is small where the walls reflect a half.
TEST(FillBetween, GathersTheFirstBounceOfDirectLightInEveryFrame) {
  const LitRoom room(kFrames);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  DirectLight direct;
  direct.irradiance_w_m2 = PatchSeries(room.patches.count(), kFrames);
  direct.at_rest_w_m2.resize(room.patches.count());
  for (Rgb& value : direct.irradiance_w_m2.values)
    value = Rgb{1, 1, 1} * (uniform(random) < 0.2f ? 5.0f : 0.0f);
  const SolvedRoom solved(room, {&room.animation.emission, &direct}, kLines, kLines);
  expect_better_than_interpolated(room, solved, 0.5);
}

TEST(FillBetween, StopsWhenToldTo) {
  const LitRoom room(kFrames);
  const SolvedRoom solved(room, {&room.animation.emission}, kLines, kLines);
  const Columns columns = tests::columns_of({0, 9}, kFrames);
  Progress progress;
  progress.stop_requested = [] { return true; };
  const auto all =
      fill_between(solved.window(), columns, solved.solve(columns), api::Interpolation::linear, progress);
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().fault, api::Fault::stopped);
}

}  // namespace
}  // namespace engine
