#include "engine/bench/cost_fit.h"

#include <gtest/gtest.h>

#include <vector>

namespace engine {
namespace {

TEST(CostFit, FindsTheLineThroughPointsThatLieOnOne) {
  const CostFit fit = fit_cost(std::vector<CostPoint>{{39, 2 + 0.5 * 39}, {75, 2 + 0.5 * 75}, {120, 62}});
  EXPECT_NEAR(fit.once_s, 2, 1e-9);
  EXPECT_NEAR(fit.per_frame_s, 0.5, 1e-12);
  EXPECT_NEAR(fit.deviation, 0, 1e-12);
  EXPECT_NEAR(fit.largest_speed_up(120), 31, 1e-9);
}

// Minutes of Besuievsky & Pueyo's Table 2; the line by hand: sum of dk dC / sum of dk^2 = 1584 / 3294.
TEST(CostFit, SaysOfThePapersRunsThatKeyFramesAloneGainLessThanFiveTimes) {
  const CostFit fit = fit_cost(std::vector<CostPoint>{{39, 34}, {75, 52}, {120, 73}});
  EXPECT_NEAR(fit.per_frame_s, 1584.0 / 3294, 1e-9);
  EXPECT_NEAR(fit.once_s, 53 - 78 * 1584.0 / 3294, 1e-9);
  EXPECT_GT(fit.largest_speed_up(120), 4.5);
  EXPECT_LT(fit.largest_speed_up(120), 5);
  EXPECT_GT(fit.deviation, 0);
}

TEST(CostFit, OneFrameCountTellsNothing) {
  const CostFit fit = fit_cost(std::vector<CostPoint>{{120, 73}, {120, 71}});
  EXPECT_EQ(fit.once_s, 0);
  EXPECT_EQ(fit.per_frame_s, 0);
  EXPECT_EQ(fit.largest_speed_up(120), 0);
}

}  // namespace
}  // namespace engine
