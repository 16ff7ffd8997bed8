// When iterations end.
#include "engine/lighting/convergence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engine {
namespace {

/// Iterations until the test says that it may end, with changes change(iteration)
/// and always the same correction due.
template <class Change>
Convergence run(const Scale& scale, Change&& change, double correction = 0) {
  ConvergenceTest test;
  Convergence state;
  do {
    test.add(change(state.iterations), correction, scale, state);
  } while (!test.may_end(state));
  return state;
}

TEST(ConvergenceTest, EndsWhereWhatIsLeftIsSmallBesideTheMean) {
  const Convergence state = run({1, 1, 0.5}, [](std::uint32_t k) { return std::pow(0.5, k); });
  EXPECT_TRUE(state.converged);
  EXPECT_LE(state.error_left, kIterationError);
  EXPECT_NEAR(state.iterations, std::log2(1 / kIterationError), 2);
}

TEST(ConvergenceTest, GoesOnWhileCorrectionsAreDue) {
  const auto halves = [](std::uint32_t k) { return std::pow(0.5, k); };
  const std::uint32_t without = run({1, 1, 0.9}, halves).iterations;
  EXPECT_LE(run({1, 1, 0.9}, halves, 0.1 * kIterationError).iterations, without + 1);
  EXPECT_GT(run({1, 1, 0.9}, halves, 2 * kIterationError).iterations, without);
}

// One patch beside a lamp is 100 times as bright as the mean: its last place is 1e-5 of that.
TEST(ConvergenceTest, EndsWhereRoundingOfTheBrightestGoesRoundInCircles) {
  const Convergence state = run(
      {1, 100, 0.8}, [](std::uint32_t k) { return std::max(std::pow(0.5, k), k % 2 == 0 ? 3e-5 : 2e-5); });
  EXPECT_TRUE(state.converged);
  EXPECT_LT(state.iterations, 40u);
}

// As slow as the reflectance allows.
TEST(ConvergenceTest, DoesNotTakeSlowProgressForRounding) {
  for (const double rho : {0.9, 0.99, 0.995}) {
    const Convergence state = run({1, 100, rho}, [&](std::uint32_t k) { return 1e-4 * std::pow(rho, k); });
    EXPECT_TRUE(state.converged) << rho;
    EXPECT_LE(state.error_left, kIterationError) << rho;
  }
}

TEST(ConvergenceTest, LightThatHardlyDiesIsNoRounding) {
  const Convergence state = run({1, 100, 0.9999}, [](std::uint32_t k) { return 1e-4 * std::pow(0.9999, k); });
  EXPECT_FALSE(state.converged);
  EXPECT_EQ(state.iterations, kIterationsMax);
}

TEST(ConvergenceTest, CirclesThatAreNotOfRoundingAreNoEnd) {
  const Convergence state = run({1, 100, 0.5}, [](std::uint32_t) { return 1e-2; });
  EXPECT_FALSE(state.converged);
  EXPECT_EQ(state.iterations, kIterationsMax);
}

}  // namespace
}  // namespace engine
