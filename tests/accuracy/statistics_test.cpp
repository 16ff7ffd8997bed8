// The yardstick itself: t-tests that pass what is right and refuse what is wrong.
#include "tests/support/statistics.h"

#include <cmath>

#include "engine/base/sobol.h"

namespace tests {
namespace {

/// 24 nearly normal numbers of variance 1: sums of 12 uniform ones.
Sample noise(std::uint64_t seed, double mean) {
  Sample sample;
  for (std::uint64_t k = 0; k < 24; ++k) {
    double sum = mean - 6;
    for (std::uint64_t j = 0; j < 12; ++j)
      sum += static_cast<double>(engine::stream_seed(seed, 12 * k + j) >> 11) * 0x1p-53;
    sample.add(sum);
  }
  return sample;
}

}  // namespace

// Values from a table of Student's t, four digits or more.
TEST(Statistics, ProbabilitiesOfStudentsT) {
  EXPECT_NEAR(two_sided_p(12.706, 1), 0.05, 1e-5);
  EXPECT_NEAR(two_sided_p(2.228, 10), 0.05, 2e-5);
  EXPECT_NEAR(two_sided_p(3.169, 10), 0.01, 1e-5);
  EXPECT_NEAR(two_sided_p(1.962339, 1000), 0.05, 2e-5);
  EXPECT_NEAR(two_sided_p(0, 7), 1.0, 1e-12);
}

// From a table of chi-square: 5 % and .1 %.
TEST(Statistics, ProbabilitiesOfChiSquare) {
  EXPECT_NEAR(chi_square_p(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_p(30.144, 19), 0.05, 1e-5);
  EXPECT_NEAR(chi_square_p(43.820, 19), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_p(124.342, 100), 0.05, 1e-5);
}

// (1 - x)^m = 1 - family.
TEST(Statistics, ManyTestsTogetherRefuseAsOftenAsTheirFamilyMay) {
  EXPECT_NEAR(std::pow(1 - sidak(1e-3, 500), 500), 1 - 1e-3, 1e-12);
  EXPECT_DOUBLE_EQ(sidak(0.05, 1), 0.05);
}

// Of 2,000 tests of a true mean at 5 % about 100 are refused, with a spread of 9.7; 5 of them allowed: a
// correct t-test fails here for one choice of seeds in a million.
TEST(Statistics, FalseAlarmsComeAsOftenAsStated) {
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) refused += !agrees(noise(seed, 3.0), 3.0, 0.05);
  EXPECT_NEAR(refused, 100, 49);
}

TEST(Statistics, AMeanOffByTwoDeviationsIsRefused) {
  EXPECT_FALSE(agrees(noise(1, 5.0), 3.0, 1e-4));
  EXPECT_TRUE(agrees(noise(1, 5.0), 3.0, 1e-4, 2.0)) << "unless the difference is allowed for";
}

TEST(Statistics, ASampleWithoutSpreadMustBeExact) {
  Sample constant;
  for (int k = 0; k < 5; ++k) constant.add(1.25);
  EXPECT_TRUE(agrees(constant, 1.25, 1e-4));
  EXPECT_FALSE(agrees(constant, 1.250001, 1e-4));
}

}  // namespace tests
