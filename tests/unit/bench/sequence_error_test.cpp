// Errors of small sequences, written as jobs write theirs and read back.
#include "engine/bench/sequence_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "engine/bench/radiosity_file.h"
#include "engine/output/artefacts.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

/// Patches of one value in all channels: [patch][frame].
PatchSeries grey(const std::vector<std::vector<float>>& values) {
  PatchSeries series(static_cast<std::uint32_t>(values.size()), static_cast<std::uint32_t>(values[0].size()));
  for (std::uint32_t patch = 0; patch < series.patch_count; ++patch)
    for (std::uint32_t frame = 0; frame < series.frame_count; ++frame) {
      const float value = values[patch][frame];
      series.at(patch, frame) = {value, value, value};
    }
  return series;
}

class SequenceErrors : public testing::Test {
 protected:
  std::filesystem::path written(const char* name, const PatchSeries& series) {
    const auto path = folder_.path() / name;
    EXPECT_TRUE(write_radiosity_npy(path, series));
    return path;
  }
  tests::TemporaryFolder folder_;
};

TEST_F(SequenceErrors, AreWeightedByAreaAndAveragedOverFrames) {
  const auto reference = written("full.npy", grey({{1, 1}, {3, 3}}));
  const auto values = written("some.npy", grey({{1, 1.5f}, {3, 3}}));
  const auto error = sequence_error({3, 1}, values, reference, 0.05);
  ASSERT_TRUE(error) << error.error().message;
  const double second = std::sqrt(3 * 0.25 / 4);
  ASSERT_EQ(error->rmse_w_m2.size(), 2u);
  EXPECT_EQ(error->rmse_w_m2[0], 0);
  EXPECT_NEAR(error->rmse_w_m2[1], second, 1e-7);
  EXPECT_NEAR(error->rmse_average_w_m2, second / 2, 1e-7);
  EXPECT_NEAR(error->mean_radiosity_w_m2, 1.5, 1e-7);
  EXPECT_NEAR(error->largest, 0.5, 1e-7);
  EXPECT_NEAR(error->share_beyond, 0.25, 1e-12);
}

TEST_F(SequenceErrors, LeaveOutPatchesWithoutWeight) {
  const auto reference = written("full.npy", grey({{1}, {100}}));
  const auto values = written("some.npy", grey({{1}, {50}}));
  const auto error = sequence_error({1, 0}, values, reference, 0.05);
  ASSERT_TRUE(error) << error.error().message;
  EXPECT_EQ(error->rmse_average_w_m2, 0);
  EXPECT_EQ(error->mean_radiosity_w_m2, 1);
  EXPECT_EQ(error->largest, 0);
}

TEST_F(SequenceErrors, OfSetsOfPatchesAreOfTheFramesThatArePaired) {
  const auto reference = written("full.npy", grey({{1, 2, 5}, {3, 4, 6}}));
  const auto values = written("some.npy", grey({{5, 1}, {7, 3}}));  // frames 2 and 0, one off by 1
  const std::vector<PatchWeights> sets{{1, 3}, {1, 0}, {0, 3}};
  const std::vector<FramePair> frames{{0, 2}, {1, 0}};
  const auto sums = compare_sequences(sets, values, reference, frames);
  ASSERT_TRUE(sums) << sums.error().message;
  EXPECT_NEAR((*sums)[0].rmse_w_m2(), std::sqrt(3.0 / 8), 1e-7);
  EXPECT_NEAR((*sums)[0].mean_w_m2(), (5 + 1 + 3 * 6 + 3 * 3) / 8.0, 1e-7);
  EXPECT_EQ((*sums)[1].rmse_w_m2(), 0);
  EXPECT_NEAR((*sums)[2].rmse_w_m2(), std::sqrt(0.5), 1e-7);
  EXPECT_FALSE(compare_sequences(sets, values, reference, std::vector<FramePair>{{0, 3}}));
}

TEST_F(SequenceErrors, OfTheMeanOfTwoIsHalfTheirDifference) {
  const auto one = written("one.npy", grey({{1, 2}, {3, 4}})),
             other = written("other.npy", grey({{3, 2}, {3, 8}}));
  const auto mean = folder_.path() / "mean.npy";
  ASSERT_TRUE(write_mean(one, other, mean));
  const std::vector<PatchWeights> all{{1, 1}};
  for (const auto& half : {one, other}) {
    const auto sums = compare_sequences(all, half, mean);
    ASSERT_TRUE(sums) << sums.error().message;
    EXPECT_NEAR((*sums)[0].squares, 1 + 4, 1e-6);
    EXPECT_NEAR((*sums)[0].radiosity, 2 + 2 + 3 + 6, 1e-6);
  }
}

TEST_F(SequenceErrors, RefuseSequencesOfOtherPatches) {
  const auto reference = written("full.npy", grey({{1}, {2}}));
  const auto other = written("other.npy", grey({{1}, {2}, {3}}));
  EXPECT_FALSE(sequence_error({1, 1}, other, reference, 0.05));
  EXPECT_FALSE(sequence_error({1, 1, 1}, reference, reference, 0.05));
  EXPECT_FALSE(sequence_error({1, 1}, folder_.path() / "missing.npy", reference, 0.05));
}

TEST(RelativeError, IsOfTheWorstChannelAndOfTheFloorInTheDark) {
  EXPECT_NEAR(relative_error({1.1f, 2, 3}, {1, 2, 4}, 0.1), 0.25, 1e-7);
  EXPECT_NEAR(relative_error({0.2f, 0, 0}, {0, 0, 0}, 0.5), 0.4, 1e-7);
}

TEST_F(SequenceErrors, OfAFileThatIsNoneAreRefused) {
  const auto path = folder_.path() / "text.npy";
  std::ofstream(path) << "not an array";
  EXPECT_FALSE(RadiosityFile::open(path));
  std::filesystem::resize_file(written("short.npy", grey({{1, 2}, {3, 4}})), 140);
  auto cut = RadiosityFile::open(folder_.path() / "short.npy");
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->frame_count(), 2u);
  EXPECT_FALSE(cut->read(1));
}

}  // namespace
}  // namespace engine
