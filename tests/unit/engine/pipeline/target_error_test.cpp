// How many replicates a target error asks for.
#include "engine/pipeline/target_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engine {
namespace {

/// The noise of n replicates whose squared error is fixed + scattered / n; of the fixed part `known` is the
/// direct light's own.
LinesSpent spent(std::uint32_t n, double fixed, double scattered, double known) {
  const double whole = fixed + scattered / n;
  return {n, {std::sqrt(whole), std::sqrt(whole - known)}};
}

TEST(ReplicatesFor, AddsNoneWhereTheTargetIsMet) {
  EXPECT_EQ(replicates_for(0.0101, {}, spent(8, 0, 8e-4, 0)), 8u);
}

TEST(ReplicatesFor, AsksForAsManyAsTheTargetNeedsAndATwentiethMore) {
  // From 1e-4 to 1e-5 takes ten times the lines.
  EXPECT_EQ(replicates_for(std::sqrt(1e-5), {}, spent(8, 0, 8e-4, 0)), 84u);
}

TEST(ReplicatesFor, LeavesOutWhatIsTheDirectLightsOwn) {
  // Of 2e-4, 1e-4 is the direct light's: lines may have 1e-4 of a target of 2e-4, half of what they have.
  const auto wanted = replicates_for(std::sqrt(2e-4), {}, spent(8, 1e-4, 16e-4, 1e-4));
  EXPECT_EQ(wanted, 17u);
}

TEST(ReplicatesFor, LearnsFromTheRoundBeforeWhatLinesCannotReduce) {
  // Nothing of the fixed part is known to be so, but 8 and 16 replicates show it.
  const auto blind = replicates_for(std::sqrt(1.5e-4), {}, spent(16, 1e-4, 16e-4, 0));
  const auto wise = replicates_for(std::sqrt(1.5e-4), spent(8, 1e-4, 16e-4, 0), spent(16, 1e-4, 16e-4, 0));
  EXPECT_EQ(blind, 23u);
  EXPECT_EQ(wise, 34u);  // 1.05 x 32
}

TEST(ReplicatesFor, AddsNoneWhereLinesWouldNotHelp) {
  EXPECT_EQ(replicates_for(0.009, {}, spent(8, 1e-4, 1e-4, 1e-4)), 8u);
  EXPECT_EQ(replicates_for(0.009, spent(8, 1e-4, 1e-4, 0), spent(16, 1e-4, 1e-4, 0)), 16u);
}

}  // namespace
}  // namespace engine
