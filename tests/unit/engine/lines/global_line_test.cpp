#include "engine/lines/global_line.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/sobol.h"
#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::World;

const LineBox kBox{{-1, 2, 0}, {3, 5, 2}};  // 4 x 3 x 2 m
constexpr double kSurface = 52, kVolume = 24;

/// Line `k` of many that are independent of each other: a seed each. What is said of them is a fixed fact
/// once it has been computed; "by chance" is over the choice of this test's first seed.
Ray independent_line(const LineBox& box, std::uint64_t k) {
  return global_line(box, 0, stream_seed(2024, k));
}

/// Where the line leaves the box.
double chord(const LineBox& box, const Ray& ray) {
  double far = 1e30;
  const auto slab = [&](float origin, float direction, float lower, float upper) {
    if (direction == 0) return;
    far = std::min(far, (double{direction > 0 ? upper : lower} - origin) / direction);
  };
  slab(ray.origin.x, ray.direction.x, box.lower.x, box.upper.x);
  slab(ray.origin.y, ray.direction.y, box.lower.y, box.upper.y);
  slab(ray.origin.z, ray.direction.z, box.lower.z, box.upper.z);
  return far;
}

/// 0 .. 5: the face that a point of the box's surface lies on, -1 inside. `inwards` is the direction's
/// component.
int face_of(const LineBox& box, const Ray& ray, float& inwards) {
  const float lower[3] = {box.lower.x, box.lower.y, box.lower.z},
              upper[3] = {box.upper.x, box.upper.y, box.upper.z};
  const float origin[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
  const float direction[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_upper : {false, true})
      if (origin[axis] == (is_upper ? upper : lower)[axis]) {
        inwards = is_upper ? -direction[axis] : direction[axis];
        return 2 * axis + (is_upper ? 1 : 0);
      }
  return -1;
}

TEST(GlobalLine, SurfaceOfABox) {
  EXPECT_DOUBLE_EQ(surface_m2(kBox), kSurface);
}

TEST(GlobalLine, StartsOnTheBoxPointsInwardsAndReachesBeyondIt) {
  for (std::uint32_t k = 0; k < 20'000; ++k) {
    const Ray ray = global_line(kBox, k, 5);
    float inwards = 0;
    ASSERT_GE(face_of(kBox, ray, inwards), 0) << k;
    ASSERT_GE(inwards, 0) << k;
    ASSERT_NEAR(length(ray.direction), 1, 1e-6) << k;
    for (const float off : {ray.origin.x + 1, ray.origin.y - 2, ray.origin.z}) ASSERT_GE(off, 0) << k;
    for (const float off : {3 - ray.origin.x, 5 - ray.origin.y, 2 - ray.origin.z}) ASSERT_GE(off, 0) << k;
    ASSERT_EQ(ray.near, 0);
    ASSERT_GT(ray.far, chord(kBox, ray));
  }
}

TEST(GlobalLine, IsTheSameForOneNumberAndSeedAndAnotherForOthers) {
  const Ray line = global_line(kBox, 17, 3);
  EXPECT_EQ(line.origin, global_line(kBox, 17, 3).origin);
  EXPECT_EQ(line.direction, global_line(kBox, 17, 3).direction);
  EXPECT_FALSE(line.origin == global_line(kBox, 18, 3).origin);
  EXPECT_FALSE(line.origin == global_line(kBox, 17, 4).origin);
}

// Cauchy: the mean chord of a convex body is 4 V / S. Its standard error is measured beside it. Five of them:
// false alarm for one seed in 1.7 million.
TEST(GlobalLine, TheMeanChordIsFourTimesVolumeBySurface) {
  constexpr int kLines = 100'000;
  double sum = 0, squares = 0;
  for (std::uint64_t k = 0; k < kLines; ++k) {
    const double length_m = chord(kBox, independent_line(kBox, k));
    sum += length_m;
    squares += length_m * length_m;
  }
  const double mean = sum / kLines;
  const double error = std::sqrt((squares / kLines - mean * mean) / kLines);
  EXPECT_LT(error, 0.005);
  EXPECT_NEAR(mean, 4 * kVolume / kSurface, 5 * error);
}

double chi_square(const std::vector<double>& counts, const std::vector<double>& expected) {
  double sum = 0;
  for (std::size_t k = 0; k < counts.size(); ++k)
    sum += (counts[k] - expected[k]) * (counts[k] - expected[k]) / expected[k];
  return sum;
}

// cos theta has the density 2 cos theta, so its square is uniform: 20 bins, 19 degrees of freedom,
// beyond 56.4 by chance once in 80,000 seeds, for each of the six faces. The azimuth is uniform: 20 bins too.
TEST(GlobalLine, DirectionsFollowTheCosineOnEveryFace) {
  constexpr int kBins = 20, kLines = 60'000;
  std::vector<std::vector<double>> cosines(6, std::vector<double>(kBins, 0)), azimuths = cosines;
  std::vector<double> on_face(6, 0);
  for (std::uint64_t k = 0; k < kLines; ++k) {
    const Ray ray = independent_line(kBox, k);
    float inwards = 0;
    const int face = face_of(kBox, ray, inwards);
    ASSERT_GE(face, 0);
    const float d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    const double azimuth =
        (std::atan2(double{d[(face / 2 + 1) % 3]}, double{d[(face / 2 + 2) % 3]}) / M_PI + 1) / 2;
    const auto bin = [](double x) { return std::min(static_cast<int>(x * kBins), kBins - 1); };
    ++cosines[face][bin(double{inwards} * inwards)];
    ++azimuths[face][bin(azimuth)];
    ++on_face[face];
  }
  for (int face = 0; face < 6; ++face) {
    const std::vector<double> expected(kBins, on_face[face] / kBins);
    EXPECT_LT(chi_square(cosines[face], expected), 56.4) << face;
    EXPECT_LT(chi_square(azimuths[face], expected), 56.4) << face;
  }
}

// Six faces, five degrees of freedom: beyond 31 by chance once in 100,000 seeds. Within a face: 4 x 4 bins,
// 15 degrees, beyond 50.5 once in 100,000.
TEST(GlobalLine, OriginsAreUniformOnTheSurface) {
  constexpr int kLines = 60'000;
  const double areas[3] = {6, 8, 12};
  std::vector<double> on_face(6, 0), expected(6);
  std::vector<std::vector<double>> within(6, std::vector<double>(16, 0));
  for (int face = 0; face < 6; ++face) expected[face] = kLines * areas[face / 2] / kSurface;
  for (std::uint64_t k = 0; k < kLines; ++k) {
    const Ray ray = independent_line(kBox, k);
    float inwards = 0;
    const int face = face_of(kBox, ray, inwards);
    ++on_face[face];
    const float unit[3] = {(ray.origin.x + 1) / 4, (ray.origin.y - 2) / 3, ray.origin.z / 2};
    const auto bin = [&](int axis) { return std::min(static_cast<int>(unit[axis % 3] * 4), 3); };
    ++within[face][bin(face / 2 + 1) * 4 + bin(face / 2 + 2)];
  }
  EXPECT_LT(chi_square(on_face, expected), 31);
  for (int face = 0; face < 6; ++face)
    EXPECT_LT(chi_square(within[face], std::vector<double>(16, on_face[face] / 16)), 50.5) << face;
}

TEST(ExpectedCrossings, AWholeFaceOfTheBoxIsMetByItsShareOfLinesTwice) {
  EXPECT_DOUBLE_EQ(expected_crossings(1'000'000, 12, kSurface), 2e6 * 12 / 52);
  EXPECT_DOUBLE_EQ(expected_crossings(4'000'000'000, 0.5, 2), 2e9);
}

// A line meets a flat patch once at most, so counts are binomial. 24 patches of every size and tilt inside
// the box, 5 standard deviations each: false alarm for one seed in 70,000.
TEST(ExpectedCrossings, PatchesAreMetThatOftenWithinTheBinomialLimits) {
  Scene scene = tests::scene_with(1, 1);
  tests::RandomRays random(0.9f, 4);
  for (int k = 0; k < 24; ++k) {
    const Vec3 centre{1, 3.5f, 1};
    tests::add_polygon(scene, {centre + random.point(), centre + random.point(), centre + random.point()});
  }
  const World world(scene, tests::still(scene, 1), 100);
  ASSERT_EQ(world.patches.count(), 24u);
  constexpr int kLines = 50'000;
  std::vector<int> met(world.patches.count(), 0);
  std::vector<SurfaceHit> hits;
  for (std::uint64_t k = 0; k < kLines; ++k) {
    world.static_rays.all_hits(independent_line(kBox, k), hits);
    for (const SurfaceHit& hit : hits) ++met[hit.facet];
  }
  for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
    const double expected = expected_crossings(kLines, world.patches.area_m2[patch], kSurface);
    EXPECT_NEAR(met[patch], expected, 5 * std::sqrt(expected * (1 - expected / kLines))) << patch;
  }
}

TEST(LineBox, HoldsEveryPoseOfTheAnimationWithALittleRoom) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}}, 1);
  Animation animation = tests::still(scene, 5);
  animation.objects[1].spans = {{1, 1, tests::moved_to(-7, 0, 0)}, {4, 4, tests::moved_to(0, 9, 2)}};
  const World world(scene, animation, 1.0);
  const LineBox box = line_box(world.patches, animation);
  const float margin = 1e-3f * length(Vec3{8, 10, 3});
  EXPECT_FLOAT_EQ(box.lower.x, -7 - margin);
  EXPECT_FLOAT_EQ(box.lower.y, -margin);
  EXPECT_FLOAT_EQ(box.lower.z, -margin);
  EXPECT_FLOAT_EQ(box.upper.x, 1 + margin);
  EXPECT_FLOAT_EQ(box.upper.y, 10 + margin);
  EXPECT_FLOAT_EQ(box.upper.z, 3 + margin);
}

TEST(LineBox, HasASurfaceForAFlatSceneAndForOneThatIsNeverThere) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  Animation animation = tests::still(scene, 2);
  const auto patches = mesh_into_patches(scene, 1.0);
  EXPECT_GT(surface_m2(line_box(*patches, animation)), 2.0);
  animation.objects[0].spans.clear();
  const double surface = surface_m2(line_box(*patches, animation));
  EXPECT_TRUE(std::isfinite(surface) && surface > 0) << surface;
}

}  // namespace
}  // namespace engine
