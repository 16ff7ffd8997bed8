// Samples with weights know what share of the light something takes.
#include "engine/direct/shadow_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/statistics.h"

namespace engine {
namespace {

constexpr std::size_t kLanes = RayLanes::kCount;

/// Sixteen points, each from a seed of its own.
SobolPoints numbers_of(std::uint64_t seed) {
  SobolBits bits;
  SobolSeeds seeds;
  for (std::size_t k = 0; k < kLanes; ++k) {
    bits.set(k, 0);
    seeds[k] = stream_seed(seed, k);
  }
  const SobolBits* all = &bits;
  SobolPoints points;
  scramble(&all, &seeds, 1, &points);
  return points;
}

TEST(Spread, IsAsDenseAsItSays) {
  const Spread over{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, false, {1, 3, 2, 6}};
  constexpr double kMean = 3;  // of the density
  tests::Sample mean, x, y;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    const SobolPoints numbers = numbers_of(seed);
    SpreadPoints points;
    spread(&over, &numbers, 0, 1, &points);
    for (std::size_t k = 0; k < kLanes; ++k) {
      EXPECT_NEAR(points.density[k],
                  (1 - points.x[k]) * (1 - points.y[k]) + 3 * points.x[k] * (1 - points.y[k]) +
                      2 * (1 - points.x[k]) * points.y[k] + 6 * points.x[k] * points.y[k],
                  1e-5);
      mean.add(kMean / points.density[k]);  // 1 for points by area
      x.add(kMean / points.density[k] * points.x[k]);
      y.add(kMean / points.density[k] * points.y[k]);
    }
  }
  EXPECT_TRUE(tests::agrees(mean, 1, 1e-6));
  EXPECT_TRUE(tests::agrees(x, 0.5, 1e-6));
  EXPECT_TRUE(tests::agrees(y, 0.5, 1e-6));
}

TEST(Spread, OverATriangleIsEvenAndStaysInIt) {
  const Spread over{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, true, {1, 1, 1, 1}};
  tests::Sample x, y;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const SobolPoints numbers = numbers_of(seed);
    SpreadPoints points;
    spread(&over, &numbers, 2, 1, &points);
    for (std::size_t k = 0; k < kLanes; ++k) {
      ASSERT_LE(points.x[k] + points.y[k], 1.000001f);
      x.add(points.x[k]);
      y.add(points.y[k]);
    }
  }
  EXPECT_TRUE(tests::agrees(x, 1.0 / 3, 1e-6));
  EXPECT_TRUE(tests::agrees(y, 1.0 / 3, 1e-6));
}

// Two unit squares that face each other at a distance of 1: their form factor is 0.19982.
TEST(Join, WeighsRaysAsTheirLightArrives) {
  const Spread here{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, false, {1, 2, 3, 4}};
  const Spread there{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, false, {4, 2, 2, 1}};
  const RayEnds ends{{0, 0, 1}, {0, 0, -1}, {0, 0, 0.01f}, {0, 0, -0.02f}};
  tests::Sample factor;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    const SobolPoints numbers = numbers_of(seed);
    SpreadPoints from, to;
    spread(&here, &numbers, 0, 1, &from);
    spread(&there, &numbers, 2, 1, &to);
    RayLanes rays;
    SampleLanes weights;
    join(ends, &from, &to, 1, &rays, &weights);
    for (std::size_t k = 0; k < kLanes; ++k) {
      factor.add(weights[k] * 2.5 * 2.25 / std::numbers::pi);  // means of the densities
      EXPECT_NEAR(rays.oz[k], 0.01, 1e-6);
      EXPECT_NEAR(rays.oz[k] + rays.dz[k], 0.98, 1e-6);
    }
  }
  EXPECT_TRUE(tests::agrees(factor, 0.19982489569838746, 1e-6));
}

TEST(SumBlocked, AddsTheWeightsOfRaysThatAreBlockedInEachSlot) {
  SampleLanes weights;
  for (std::size_t k = 0; k < kLanes; ++k) weights[k] = static_cast<float>(k + 1);
  std::vector<std::uint32_t> moving(37);
  for (std::uint32_t s = 0; s < moving.size(); ++s) moving[s] = s * 0x9e37u & 0xffffu;
  const std::uint32_t at_rest = 0x0104u, set = 0xffefu;
  std::vector<float> sums(moving.size(), 0.5f);
  sum_blocked(moving.data(), at_rest, set, weights, 3, 14, moving.size(), sums.data());
  for (std::size_t s = 0; s < moving.size(); ++s) {
    float expected = 0.5f;
    for (std::size_t k = 3; k < 14; ++k)
      if ((((moving[s] | at_rest) & set) >> k & 1) != 0) expected += weights[k];
    EXPECT_EQ(sums[s], expected) << s;
  }
}

}  // namespace
}  // namespace engine
