#include "engine/lighting/replicate_mean.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace engine {
namespace {

constexpr std::uint32_t kPatches = 50, kFrames = 7, kReplicates = 9;

std::vector<PatchSeries> random_replicates() {
  std::mt19937 random(1);
  std::normal_distribution<float> normal(100, 0.5f);
  std::vector<PatchSeries> all(kReplicates, PatchSeries(kPatches, kFrames));
  for (PatchSeries& series : all)
    for (Rgb& value : series.values) value = {normal(random), normal(random) * 2, 5};
  return all;
}

PatchSeries columns(const PatchSeries& of, std::uint32_t first, std::uint32_t end) {
  PatchSeries part(of.patch_count, end - first);
  for (PatchId p = 0; p < of.patch_count; ++p)
    for (std::uint32_t f = first; f < end; ++f) part.at(p, f - first) = of.at(p, f);
  return part;
}

/// Mean and variance of the mean in two passes of doubles. Floats around 100 (200) are rounded by 4e-6
/// (8e-6), and as many times over as there are replicates.
void expect_two_pass(const ReplicateMean& found, const std::vector<PatchSeries>& all) {
  const PatchSeries variance = found.variance();
  for (std::size_t k = 0; k < all[0].values.size(); ++k) {
    double sum = 0, squares = 0;
    for (const PatchSeries& series : all) sum += double{series.values[k].g} / kReplicates;
    for (const PatchSeries& series : all) squares += std::pow(series.values[k].g - sum, 2);
    ASSERT_NEAR(found.mean().values[k].g, sum, 1e-4);
    const double expected = squares / (kReplicates * (kReplicates - 1));
    ASSERT_NEAR(variance.values[k].g, expected, 1e-3 * expected);
    ASSERT_EQ(found.mean().values[k].b, 5);
    ASSERT_EQ(variance.values[k].b, 0);
  }
}

TEST(ReplicateMean, HasTheMeanAndTheVarianceOfTheMean) {
  const auto all = random_replicates();
  ReplicateMean mean(kPatches, kFrames);
  for (const PatchSeries& series : all) {
    mean.begin();
    mean.add(series, 0, 0);
  }
  EXPECT_EQ(mean.count(), kReplicates);
  expect_two_pass(mean, all);
}

// Frames 0 .. 3, then 3 .. 6 of which the first was there before.
TEST(ReplicateMean, TakesAReplicateInPartsThatShareAFrame) {
  const auto all = random_replicates();
  ReplicateMean mean(kPatches, kFrames);
  for (const PatchSeries& series : all) {
    mean.begin();
    mean.add(columns(series, 0, 4), 0, 0);
    mean.add(columns(series, 3, 7), 1, 4);
  }
  expect_two_pass(mean, all);
}

TEST(ReplicateMean, OfEqualReplicatesHasNoVariance) {
  PatchSeries one(1, 1);
  one.values[0] = {0.1f, 3, 1e-8f};
  ReplicateMean mean(1, 1);
  for (int r = 0; r < 8; ++r) {
    mean.begin();
    mean.add(one, 0, 0);
  }
  EXPECT_EQ(mean.mean().values[0], one.values[0]);
  EXPECT_EQ(mean.variance().values[0], Rgb{});
}

TEST(ReplicateMean, GoesOnFromWhatWasSavedToTheSameBytes) {
  const auto all = random_replicates();
  ReplicateMean whole(kPatches, kFrames), first(kPatches, kFrames), second(kPatches, kFrames);
  for (std::uint32_t r = 0; r < kReplicates; ++r) {
    whole.begin();
    whole.add(all[r], 0, 0);
    ReplicateMean& now = r < 4 ? first : second;
    if (r == 4) {
      second.mean_values() = first.mean();
      second.squares() = first.squares();
      second.set_count(first.count());
    }
    now.begin();
    now.add(all[r], 0, 0);
  }
  EXPECT_EQ(second.mean().values, whole.mean().values);
  EXPECT_EQ(second.variance().values, whole.variance().values);
}

}  // namespace
}  // namespace engine
