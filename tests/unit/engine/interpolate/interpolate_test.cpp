#include "engine/interpolate/interpolate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace engine {
namespace {

using api::FrameIndex;

void expect_between(std::vector<FrameIndex> solved, FrameIndex frame, Between expected) {
  const Between at = between(solved, frame);
  EXPECT_EQ(at.before, expected.before) << frame;
  EXPECT_EQ(at.after, expected.after) << frame;
  EXPECT_FLOAT_EQ(at.weight, expected.weight) << frame;
}

TEST(Between, SolvedFramesAreThemselves) {
  expect_between({2, 5, 9}, 2, {0, 0, 0});
  expect_between({2, 5, 9}, 5, {1, 1, 0});
  expect_between({2, 5, 9}, 9, {2, 2, 0});
}

TEST(Between, OthersLieBetweenTheirNeighbours) {
  expect_between({2, 5, 9}, 3, {0, 1, 1.0f / 3});
  expect_between({2, 5, 9}, 8, {1, 2, 0.75f});
}

TEST(Between, BeforeTheFirstAndAfterTheLastIsHeld) {
  expect_between({2, 5, 9}, 0, {0, 0, 0});
  expect_between({2, 5, 9}, 100, {2, 2, 0});
  expect_between({7}, 3, {0, 0, 0});
  expect_between({7}, 7, {0, 0, 0});
  expect_between({7}, 8, {0, 0, 0});
}

// 3,000 patches, more than one task of patches; every channel by itself.
TEST(InterpolateLinear, EveryPatchFrameAndChannelIsOnItsLine) {
  constexpr std::uint32_t kPatches = 3'000;
  const std::vector<FrameIndex> solved{0, 4, 6};
  PatchSeries known(kPatches, 3);
  for (PatchId p = 0; p < kPatches; ++p)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto frame = static_cast<float>(solved[k]);
      known.at(p, k) = {frame * static_cast<float>(p), 1 - frame, k == 1 ? 8.0f : 0.0f};
    }
  const PatchSeries all = interpolate_linear(known, solved, 8);
  ASSERT_EQ(all.patch_count, kPatches);
  ASSERT_EQ(all.frame_count, 8u);
  constexpr float kBlue[8] = {0, 2, 4, 6, 8, 4, 0, 0};
  for (PatchId p = 0; p < kPatches; ++p)
    for (FrameIndex f = 0; f < 8; ++f) {
      const auto frame = static_cast<float>(std::min(f, 6u));
      ASSERT_FLOAT_EQ(all.at(p, f).r, frame * static_cast<float>(p));
      ASSERT_FLOAT_EQ(all.at(p, f).g, 1 - frame);
      ASSERT_FLOAT_EQ(all.at(p, f).b, kBlue[f]);
    }
}

TEST(InterpolateLinear, SolvedFramesKeepTheirBytes) {
  PatchSeries known(1, 2);
  known.at(0, 0) = {0.1f, 1e-30f, 3e20f};
  known.at(0, 1) = {0.7f, 0, 0.3f};
  const std::vector<FrameIndex> solved{1, 3};
  const PatchSeries all = interpolate_linear(known, solved, 5);
  EXPECT_EQ(all.at(0, 1), known.at(0, 0));
  EXPECT_EQ(all.at(0, 3), known.at(0, 1));
  EXPECT_EQ(all.at(0, 0), known.at(0, 0));
  EXPECT_EQ(all.at(0, 4), known.at(0, 1));
}

}  // namespace
}  // namespace engine
