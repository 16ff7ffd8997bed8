// Which setting of a ladder wins, and what lies between the points of a curve.
#include "engine/bench/limit_choice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engine {
namespace {

TEST(LimitChoice, TheCheapestThatMeetsTheBarWins) {
  const std::vector<Measured> runs{{1, .05}, {3, .02}, {2, .025}, {9, .01}};
  EXPECT_EQ(cheapest(runs, .025), 2u);
  EXPECT_EQ(cheapest(runs, .02), 1u);
  EXPECT_EQ(cheapest(runs, .005), std::nullopt);
  EXPECT_EQ(cheapest({}, .1), std::nullopt);
}

TEST(LimitChoice, ContendersAreCloseToTheCheapestInOrderOfTime) {
  const std::vector<Measured> runs{{2.4, .01}, {1, .5}, {2, .02}, {2.5, .02}, {2.61, .01}, {2.2, .02}};
  EXPECT_EQ(contenders(runs, .02, 1.3, 9), (std::vector<std::size_t>{2, 5, 0, 3}));
  EXPECT_EQ(contenders(runs, .02, 1.3, 2), (std::vector<std::size_t>{2, 5}));
  EXPECT_TRUE(contenders(runs, .001, 1.3, 2).empty());
}

TEST(LimitChoice, TheClimbEndsOnceTheBarIsMetAndWhatComesIsFarTooDear) {
  std::vector<Measured> runs{{1, .05}, {8, .03}};
  EXPECT_FALSE(is_high_enough(runs, .02, 2)) << "the bar is not met yet";
  runs.push_back({4, .02});
  EXPECT_FALSE(is_high_enough(runs, .02, 2)) << "the last is the cheapest itself";
  runs.push_back({7.9, .01});
  EXPECT_FALSE(is_high_enough(runs, .02, 2));
  runs.push_back({8.1, .01});
  EXPECT_TRUE(is_high_enough(runs, .02, 2));
}

// seconds = 4e-4 rmse^-2 is a straight line on logarithmic axes: the interpolation is exact on it.
TEST(SecondsAt, IsExactOnAPowerLawBetweenAndBeyondTheRuns) {
  const auto law = [](double rmse) { return 4e-4 / (rmse * rmse); };
  const std::vector<Measured> runs{{law(.01), .01}, {law(.08), .08}, {law(.03), .03}};
  for (const double rmse : {.079, .05, .03, .02, .01}) {
    const auto at = seconds_at(runs, rmse);
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->seconds, law(rmse), 1e-9 * law(rmse));
    EXPECT_FALSE(at->outside) << rmse;
  }
  for (const double rmse : {.2, .004}) {
    const auto at = seconds_at(runs, rmse);
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->seconds, law(rmse), 1e-9 * law(rmse));
    EXPECT_TRUE(at->outside) << rmse;
  }
}

TEST(SecondsAt, HalfWayOnBothAxesIsTheGeometricMean) {
  const auto at = seconds_at(std::vector<Measured>{{1, .04}, {100, .01}}, .02);
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->seconds, 10, 1e-9);
}

TEST(SecondsAt, RunsThatOthersBeatDoNotCount) {
  const std::vector<Measured> runs{{1, .04}, {50, .03}, {2, .02}, {3, .025}};
  const auto at = seconds_at(runs, .03);
  ASSERT_TRUE(at);
  EXPECT_LT(at->seconds, 2);
  EXPECT_GT(at->seconds, 1);
  EXPECT_FALSE(seconds_at({}, .1).has_value());
}

}  // namespace
}  // namespace engine
