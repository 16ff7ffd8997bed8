#include "engine/base/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace engine {
namespace {

/// How many of the 2^m points from `first` on fall into each box of 2^-bits_a x 2^-bits_b of two dimensions.
std::vector<int> counts_in_boxes(std::uint32_t first, int m, std::uint64_t seed, int a, int bits_a, int b,
                                 int bits_b) {
  std::vector<int> counts(std::size_t{1} << (bits_a + bits_b), 0);
  for (std::uint32_t k = 0; k < (1u << m); ++k) {
    const auto point = owen_sobol(first + k, seed);
    const auto i = static_cast<std::size_t>(std::ldexp(point[a], bits_a));
    const auto j = static_cast<std::size_t>(std::ldexp(point[b], bits_b));
    ++counts[(i << bits_b) + j];
  }
  return counts;
}

bool all_are(const std::vector<int>& counts, int value) {
  return std::all_of(counts.begin(), counts.end(), [&](int count) { return count == value; });
}

TEST(OwenSobol, EachDimensionHasOnePointInEveryStratum) {
  for (const std::uint64_t seed : {0ull, 1ull, 0xdeadbeefcafeull})
    for (int m = 0; m <= 12; ++m)
      for (const std::uint32_t block : {0u, 1u, 5u})
        for (int d = 0; d < 4; ++d)
          EXPECT_TRUE(all_are(counts_in_boxes(block << m, m, seed, d, m, d == 0 ? 1 : 0, 0), 1))
              << "seed " << seed << " m " << m << " block " << block << " dimension " << d;
}

// A (t, m, 2)-net: every box of volume 2^(t - m) holds 2^t points. t is the sum of the degrees of the two
// dimensions' polynomials less one each (Sobol 1967); the degrees are 1, 1, 2, 3 (the first counts as 1).
TEST(OwenSobol, PairsOfDimensionsAreNetsOfTheQualityThatTheirPolynomialsGive) {
  constexpr int kDegree[4] = {1, 1, 2, 3};
  for (int a = 0; a < 4; ++a)
    for (int b = a + 1; b < 4; ++b) {
      const int t = kDegree[a] - 1 + kDegree[b] - 1;
      for (const int m : {4, 7, 10})
        for (const std::uint64_t seed : {1ull, 77ull})
          for (int bits_a = 0; bits_a <= m - t; ++bits_a)
            EXPECT_TRUE(all_are(counts_in_boxes(3u << m, m, seed, a, bits_a, b, m - t - bits_a), 1 << t))
                << "dimensions " << a << ", " << b << " m " << m << " bits " << bits_a;
    }
}

TEST(OwenSobol, AllFourDimensionsTogetherAreStratified) {
  constexpr int kBits = 3, kQuality = 3;  // boxes of 2^-12 in 2^15 points
  for (const std::uint64_t seed : {1ull, 2ull}) {
    std::vector<int> counts(1u << (4 * kBits), 0);
    for (std::uint32_t k = 0; k < (1u << (4 * kBits + kQuality)); ++k) {
      std::size_t box = 0;
      for (const float x : owen_sobol(k, seed)) box = (box << kBits) + static_cast<std::size_t>(x * 8.0f);
      ++counts[box];
    }
    EXPECT_TRUE(all_are(counts, 1 << kQuality));
  }
}

TEST(OwenSobol, PointsLieInTheHalfOpenUnitCube) {
  float largest = 0;
  for (std::uint32_t k = 0; k < 100'000; ++k)
    for (const float x : owen_sobol(k * 42'949u, 9)) {
      ASSERT_GE(x, 0.0f);
      ASSERT_LT(x, 1.0f);
      largest = std::max(largest, x);
    }
  EXPECT_GT(largest, 0.9999f);
}

TEST(OwenSobol, ThePointIsAFunctionOfIndexAndSeedAlone) {
  for (std::uint32_t k : {0u, 1u, 4096u, 0xffffffffu})
    for (const std::uint64_t seed : {0ull, 5ull, ~0ull}) EXPECT_EQ(owen_sobol(k, seed), owen_sobol(k, seed));
}

TEST(OwenSobol, SeedsThatDifferInOneBitGiveOtherPoints) {
  const auto point = owen_sobol(1234, 1);
  for (int bit = 0; bit < 64; ++bit) {
    const auto other = owen_sobol(1234, 1ull ^ (1ull << bit));
    for (int d = 0; d < 4; ++d) EXPECT_NE(point[d], other[d]) << "bit " << bit << " dimension " << d;
  }
}

TEST(OwenSobol, PointsOfOneSeedDiffer) {
  std::set<std::array<float, 4>> seen;
  for (std::uint32_t k = 0; k < 4096; ++k) seen.insert(owen_sobol(k, 3));
  EXPECT_EQ(seen.size(), 4096u);
}

// Moments of 2^14 stratified points: one point per stratum of width h = 2^-14 moves the mean by h / 2 at
// most, and the mean square by h.
TEST(OwenSobol, MeanAndVarianceAreThoseOfTheUniformDistribution) {
  constexpr int kPoints = 1 << 14;
  for (int d = 0; d < 4; ++d) {
    double sum = 0, squares = 0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const double x = owen_sobol(k, 11)[d];
      sum += x;
      squares += x * x;
    }
    EXPECT_NEAR(sum / kPoints, 0.5, 0.5 / kPoints) << d;
    EXPECT_NEAR(squares / kPoints, 1.0 / 3.0, 1.0 / kPoints) << d;
  }
}

// Over 4,096 seeds one point is uniform: chi-square with 15 degrees of freedom exceeds 50.5 by chance once in
// 10^5; 12 of them, fixed seeds.
TEST(OwenSobol, OnePointIsUniformOverTheSeeds) {
  constexpr int kSeeds = 4096, kBins = 16;
  for (const std::uint32_t index : {0u, 1u, 1'000'003u})
    for (int d = 0; d < 4; ++d) {
      std::vector<int> counts(kBins, 0);
      for (std::uint64_t seed = 0; seed < kSeeds; ++seed)
        ++counts[static_cast<std::size_t>(owen_sobol(index, stream_seed(seed, 0))[d] * kBins)];
      double chi_square = 0;
      for (const int count : counts) chi_square += std::pow(count - kSeeds / kBins, 2) / (kSeeds / kBins);
      EXPECT_LT(chi_square, 50.5) << "index " << index << " dimension " << d;
    }
}

// Without the shuffle the first bits of two seeds' points would be equal or opposite throughout. With it each
// of the 512 pairs agrees by chance: 5 standard deviations, sqrt(n) / 2 each.
TEST(OwenSobol, SeedsPairTheirPointsDifferently) {
  constexpr int kPoints = 512;
  for (std::uint64_t pair = 0; pair < 8; ++pair) {
    int agreed = 0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const bool first = owen_sobol(k, stream_seed(pair, 1))[0] < 0.5f;
      const bool second = owen_sobol(k, stream_seed(pair, 2))[0] < 0.5f;
      agreed += first == second ? 1 : 0;
    }
    EXPECT_NEAR(agreed, kPoints / 2, 5 * std::sqrt(kPoints) / 2) << "pair " << pair;
  }
}

TEST(StreamSeed, StreamsAndSeedsNeverMeet) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 64; ++seed)
    for (std::uint64_t stream = 0; stream < 64; ++stream) seen.insert(stream_seed(seed, stream));
  EXPECT_EQ(seen.size(), 64u * 64u);
}

// Half of 64 bits change, give or take sqrt(64) / 2 = 4; the mean of 64 of them within 5 standard errors.
TEST(Mix, EveryInputBitChangesHalfOfTheOutputBits) {
  double changed = 0;
  for (int bit = 0; bit < 64; ++bit)
    changed += __builtin_popcountll(mix(0x0123456789abcdefull) ^ mix(0x0123456789abcdefull ^ (1ull << bit)));
  EXPECT_NEAR(changed / 64, 32.0, 5 * 4.0 / 8.0);
}

// Each of sixteen points in a cell of its own, whichever way 16 cells are cut from a pair of dimensions that
// are a net.
TEST(ScrambledLanes, AreStratifiedAndEvenOverAllSeeds) {
  SobolBits bits;
  for (std::uint32_t k = 0; k < SobolBits::kCount; ++k) bits.set(k, k);
  const SobolBits* all = &bits;
  double sum[4] = {};
  constexpr int kSeeds = 3000;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SobolSeeds seeds;
    seeds.fill(stream_seed(11, seed));
    SobolPoints points;
    scramble(&all, &seeds, 1, &points);
    for (std::size_t d = 0; d < 4; ++d) {
      std::uint32_t cells = 0, squares = 0;
      for (std::size_t k = 0; k < SobolBits::kCount; ++k) {
        const float x = points.of[d][k];
        ASSERT_TRUE(x >= 0 && x < 1);
        cells |= 1u << static_cast<int>(16 * x);
        squares |= 1u << (4 * static_cast<int>(4 * points.of[0][k]) + static_cast<int>(4 * points.of[1][k]));
      }
      ASSERT_EQ(cells, 0xffffu) << "dimension " << d;
      ASSERT_EQ(squares, 0xffffu);
      sum[d] += points.of[d][3];
    }
  }
  for (const double s : sum) EXPECT_NEAR(s / kSeeds, 0.5, 5 * std::sqrt(1.0 / 12 / kSeeds));
}

TEST(ScrambledLanes, OfDifferentSeedsDiffer) {
  SobolBits bits;
  for (std::uint32_t k = 0; k < SobolBits::kCount; ++k) bits.set(k, 5);
  const SobolBits* all = &bits;
  SobolSeeds seeds;
  for (std::uint64_t k = 0; k < SobolBits::kCount; ++k) seeds[k] = stream_seed(3, k);
  SobolPoints points;
  scramble(&all, &seeds, 1, &points);
  for (std::size_t d = 0; d < 4; ++d)
    for (std::size_t k = 1; k < SobolBits::kCount; ++k) EXPECT_NE(points.of[d][k], points.of[d][k - 1]);
}

}  // namespace
}  // namespace engine
