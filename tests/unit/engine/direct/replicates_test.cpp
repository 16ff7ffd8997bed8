// The mean is right, and the variance that is reported is that of the mean.
#include "tests/unit/engine/direct/light_ceiling.h"
#include "tests/unit/engine/direct/penumbra.h"

namespace engine {
namespace {

using tests::agrees;
using tests::channel;
using tests::kFloor;
using tests::light_directly;
using tests::Sample;
using tests::World;

constexpr int kSeeds = 64;
constexpr std::uint32_t kReplicates = 8;
constexpr double kFamily = 1e-5;  // false alarms of one test, all its comparisons together

/// Of one patch, frame and channel over the seeds.
struct Series {
  Sample light, variance;
};

/// [patch of `patches`][frame][channel]
std::vector<Series> over_seeds(const World& world, const std::vector<PatchId>& patches,
                               std::uint32_t samples) {
  const auto frames = world.all_frames();
  std::vector<Series> series(patches.size() * frames.size() * 3);
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const DirectLight lit = light_directly(world, frames, {samples, kReplicates, seed});
    auto to = series.begin();
    for (const PatchId patch : patches)
      for (std::uint32_t frame = 0; frame < frames.size(); ++frame)
        for (int c = 0; c < 3; ++c, ++to) {
          to->light.add(channel(lit.irradiance_w_m2.at(patch, frame), c));
          to->variance.add(channel(lit.variance.at(patch, frame), c));
        }
  }
  return series;
}

/// The scatter over the seeds by the mean of the reported variances is F distributed with 63 and 64 (R - 1)
/// degrees of freedom, or nearly chi square with the harmonic sum of both.
void expect_variance_is_the_scatter(const std::vector<Series>& series) {
  constexpr double kScatter = kSeeds - 1, kReported = kSeeds * (kReplicates - 1);
  constexpr double kDegrees = kScatter * kReported / (kScatter + kReported);
  std::size_t noisy = 0;
  for (const Series& s : series) noisy += s.light.standard_error() > 1e-5 * s.light.mean() ? 1 : 0;
  EXPECT_GT(2 * noisy, series.size());
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double error = series[k].light.standard_error(), scatter = kSeeds * error * error;
    if (!(error > 1e-5 * series[k].light.mean())) continue;  // rounding, not chance
    const double ratio = scatter / series[k].variance.mean();
    const double above = tests::chi_square_p(kDegrees * ratio, kDegrees);
    EXPECT_GT(std::min(above, 1 - above), tests::sidak(kFamily, noisy) / 2) << k << " ratio " << ratio;
  }
}

/// The floor and a blocker whose edge is at x = `low`, with the penumbra across the floor; both may move.
struct Penumbra {
  std::vector<float> low, floor_x;  ///< [frame], or one
  std::size_t frames() const { return std::max(low.size(), floor_x.size()); }
  float low_in(std::size_t frame) const { return low[low.size() == 1 ? 0 : frame]; }
  float floor_in(std::size_t frame) const { return floor_x[floor_x.size() == 1 ? 0 : frame]; }

  World world() const {
    Scene scene = tests::floor_and_light();
    scene.objects.resize(3);
    if (floor_x.size() > 1) scene.polygons[0].object = 2;
    tests::add_blocker(scene, low.size() == 1 ? low[0] : 0);
    Animation animation = tests::lit_from_above(scene, static_cast<FrameIndex>(frames()));
    const auto move = [&](ObjectMotion& motion, const std::vector<float>& x) {
      motion.spans.clear();
      for (FrameIndex f = 0; f < x.size(); ++f) motion.spans.push_back({f, f, tests::moved_to(x[f], 0, 0)});
    };
    if (low.size() > 1) move(animation.objects[1], low);
    if (floor_x.size() > 1) move(animation.objects[2], floor_x);
    return World(std::move(scene), std::move(animation), 10);
  }
};

void expect_exact_and_honest(const Penumbra& penumbra) {
  const auto series = over_seeds(penumbra.world(), {kFloor}, 256);
  ASSERT_EQ(series.size(), 3 * penumbra.frames());
  for (std::size_t frame = 0; frame < penumbra.frames(); ++frame) {
    const Sample& light = series[3 * frame].light;
    const double expected =
        tests::kExitance.r * tests::mean_visible_factor(penumbra.low_in(frame), penumbra.floor_in(frame));
    EXPECT_TRUE(agrees(light, expected, tests::sidak(kFamily, penumbra.frames()), 1e-6 * expected)) << frame;
    EXPECT_LT(light.standard_error(), 0.005 * tests::kExitance.r * tests::mean_visible_factor(9))
        << "too noisy to mean anything";
  }
  expect_variance_is_the_scatter(series);
}

TEST(Replicates, InAPenumbraAtRestTheMeanIsExactAndTheVarianceIsThatOfTheMean) {
  for (const float low : {-0.2f, -0.05f, 0.0f, 0.15f}) expect_exact_and_honest({{low}, {0}});
}

TEST(Replicates, UnderABlockerThatMovesTheMeanIsExactAndTheVarianceIsThatOfTheMean) {
  expect_exact_and_honest({{-0.2f, -0.1f, 0.0f, 0.1f}, {0}});
}

TEST(Replicates, OnAPatchThatMovesTheMeanIsExactAndTheVarianceIsThatOfTheMean) {
  expect_exact_and_honest({{0.05f}, {-0.2f, 0.0f, 0.1f, 0.3f}});
}

TEST(Replicates, WhereBothMoveTheMeanIsExactAndTheVarianceIsThatOfTheMean) {
  expect_exact_and_honest({{-0.1f, 0.0f, 0.1f}, {0.3f, 0.1f, -0.2f}});
}

TEST(Replicates, OfManyLightsTheVarianceIsThatOfTheMean) {
  const World world =
      tests::ceiling({.lights = 160, .materials = 5, .moving_card = true, .take_turns = true});
  std::vector<PatchId> floor;
  for (const PatchId patch : tests::patches_of(world, tests::kPaint))
    if (world.patches.facet_of[patch] == 0) floor.push_back(patch);
  expect_variance_is_the_scatter(over_seeds(world, floor, 32));
}

TEST(Replicates, OfOneNoVarianceIsKnown) {
  const World world = Penumbra{{0}, {0}}.world();
  const DirectLight lit = light_directly(world, {0}, {16, 1, 1});
  EXPECT_TRUE(lit.variance.values.empty());
  EXPECT_FALSE(lit.irradiance_w_m2.values.empty());
}

TEST(Replicates, DealOutTheSamplesAndHaveOneAtLeast) {
  const World world = Penumbra{{9}, {0}}.world();
  const auto taken = [&](std::uint32_t samples, std::uint32_t replicates) {
    return light_directly(world, {0}, {samples, replicates, 1}).counts.light_samples;
  };
  EXPECT_EQ(taken(16, 1), 16u);
  EXPECT_EQ(taken(16, 8), 16u);
  EXPECT_EQ(taken(17, 4), 16u);
  EXPECT_EQ(taken(2, 8), 8u);
}

}  // namespace
}  // namespace engine
