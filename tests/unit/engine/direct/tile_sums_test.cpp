#include "engine/direct/tile_sums.h"

#include <gtest/gtest.h>

namespace engine {
namespace {

Brightness brightness_of(std::vector<Rgb> of_slot) {
  Brightness brightness;
  brightness.of_slot = std::move(of_slot);
  brightness.mean = {1, 2, 3};
  return brightness;
}

TEST(TileSums, LeaveExactlyNothingWhereEverythingIsBlocked) {
  TileSums sums(1, 3, 2);
  sums.begin(2);
  for (const float factor : {0.1f, 0.7f, 1e-6f, 0.3333f}) {
    sums.add_lit(1, 0, factor);
    sums.dark(1, 0)[2] += factor;
    sums.dark_at_rest(1, 0) += factor;
  }
  sums.end_group(brightness_of({{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}), {0, 3}, true);
  EXPECT_GT(sums.mean(1, 1).g, sums.mean(1, 0).g);
  EXPECT_EQ(sums.mean(1, 2), Rgb{});
  EXPECT_EQ(sums.mean_at_rest(1), Rgb{});
  EXPECT_EQ(sums.mean(0, 0), Rgb{});
}

TEST(TileSums, KnowTheMeanAndItsVarianceOfReplicatesThatDiffer) {
  TileSums sums(3, 2, 1);
  sums.begin(1);
  for (std::uint32_t r = 0; r < 3; ++r) sums.add_lit(0, r, 1);
  sums.end_group(brightness_of({{1, 2, 4}, {1, 2, 4}}), {0, 2}, false);
  for (std::uint32_t r = 0; r < 3; ++r) {
    sums.add_lit(0, r, 6);
    sums.dark(0, r)[1] = static_cast<float>(r);
  }
  sums.end_group(brightness_of({{1, 0, 0}, {1, 0, 0}}), {0, 2}, false);
  EXPECT_EQ(sums.mean(0, 0), (Rgb{7, 2, 4}));
  EXPECT_EQ(sums.variance(0, 0), Rgb{});
  EXPECT_FLOAT_EQ(sums.mean(0, 1).r, 6);  // 7, 6, 5
  EXPECT_FLOAT_EQ(sums.variance(0, 1).r, 2.0f / 6);
  EXPECT_EQ(sums.variance(0, 1).g, 0);
}

// Whether replicates differ elsewhere must not show: a frame alone is the frame beside others.
TEST(TileSums, ReplicatesThatAreEqualHaveTheirValueForMeanBitForBit) {
  for (const std::uint32_t replicates : {3u, 7u, 8u}) {
    TileSums sums(replicates, 2, 1);
    sums.begin(1);
    for (std::uint32_t r = 0; r < replicates; ++r) {
      sums.add_lit(0, r, 0.1f);
      sums.dark(0, r)[1] = 0.01f * static_cast<float>(r);
    }
    sums.end_group(brightness_of({{0.7f, 0.3f, 1}, {1, 1, 1}}), {0, 2}, true);
    EXPECT_EQ(sums.mean(0, 0), (Rgb{0.7f * 0.1f, 0.3f * 0.1f, 0.1f}));
    EXPECT_EQ(sums.mean_at_rest(0), (Rgb{0.1f, 0.2f, 0.1f * 3}));
  }
}

TEST(TileSums, BeginAnew) {
  TileSums sums(2, 1, 2);
  for (int k = 0; k < 2; ++k) {
    sums.begin(2);
    EXPECT_EQ(sums.mean(0, 0), Rgb{});
    sums.add_lit(0, 0, 1);
    sums.add_lit(0, 1, 3);
    sums.end_group(brightness_of({{1, 1, 1}}), {0, 1}, false);
    EXPECT_EQ(sums.mean(0, 0), (Rgb{2, 2, 2}));
  }
}

}  // namespace
}  // namespace engine
