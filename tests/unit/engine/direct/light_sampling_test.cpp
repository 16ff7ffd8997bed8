#include "engine/direct/light_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/base/sobol.h"
#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

/// A light of one polygon that faces down.
PlacedLight light_of(std::initializer_list<Vec3> corners, const Pose& pose = {}) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, corners);
  const auto patches = mesh_into_patches(scene, 100);
  const Facet& facet = patches->facets.at(0);
  return place_light(facet, place(facet, pose));
}

PlacedLight square_light(float half, float z) {
  return light_of({{-half, half, z}, {half, half, z}, {half, -half, z}, {-half, -half, z}});
}

TEST(PlaceLight, HasTheCornersOfItsFacetInOrder) {
  const PlacedLight square = light_of({{0, 0, 0}, {0, 2, 0}, {1, 2, 0}, {1, 0, 0}}, tests::moved_to(0, 0, 3));
  ASSERT_EQ(square.polygon().size(), 4u);
  EXPECT_EQ(square.polygon()[2], (Vec3{1, 2, 3}));
  const PlacedLight triangle = light_of({{0, 0, 0}, {0, 3, 0}, {4, 0, 0}});
  ASSERT_EQ(triangle.polygon().size(), 3u);
}

TEST(FindLights, AreTheFacetsWhoseMaterialEmitsInSomeFrame) {
  Scene scene = tests::scene_with(1, 3);
  for (std::uint32_t m = 0; m < 3; ++m) tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0, m);
  Animation animation = tests::still(scene, 3);
  animation.emission.exitance_w_m2[1] = {{}, {}, {0, 0, 0.1f}};
  animation.emission.exitance_w_m2[2] = {{}, {}, {}};
  const auto patches = mesh_into_patches(scene, 1);
  const auto lights = find_lights(*patches, animation.emission);
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0].facet, 1u);
}

// Near and far, square and triangle: a point is origin + u edge_u + v edge_v with (u, v) on the facet.
TEST(SampleLight, PointsLieOnTheLight) {
  for (const PlacedLight& light : {square_light(0.5f, 2), light_of({{0, 0, 2}, {0, 1, 2}, {1, 0, 2}})})
    for (const float distance : {0.1f, 1.0f, 100.0f}) {
      const Vec3 point{0.2f, 0.1f, 2 - distance};
      Vec3 low{9, 9, 9}, high{-9, -9, -9};
      for (std::uint32_t k = 0; k < 2'000; ++k) {
        const auto [a, b, c, d] = owen_sobol(k, 3);
        const Vec3 off = sample_light(light, point, {0, 0, 1}, a, b, c) - light.placed.origin;
        const Vec3 u = light.placed.edge_u, v = light.placed.edge_v;
        const float along_u = dot(off, u) / dot(u, u),
                    along_v = dot(off, v) / dot(v, v);  // u, v perpendicular
        ASSERT_NEAR(length(off - along_u * u - along_v * v), 0, 1e-5);
        ASSERT_GE(along_u, -1e-6f);
        ASSERT_GE(along_v, -1e-6f);
        ASSERT_LE(light.is_triangle ? along_u + along_v : std::max(along_u, along_v), 1 + 1e-6f);
        low = min(low, {along_u, along_v, 0});
        high = max(high, {along_u, along_v, 0});
      }
      if (distance < 1) continue;  // so near, its far end hardly matters
      EXPECT_LT(low.x, 0.05f);     // all of it is reached
      EXPECT_LT(low.y, 0.05f);
      EXPECT_GT(high.x, 0.9f);
      EXPECT_GT(high.y, 0.9f);
    }
}

TEST(SampleLight, IsAFunctionOfItsNumbers) {
  const PlacedLight light = square_light(0.5f, 2);
  EXPECT_EQ(sample_light(light, {0, 0, 1}, {0, 0, 1}, 0.3f, 0.6f, 0.9f),
            sample_light(light, {0, 0, 1}, {0, 0, 1}, 0.3f, 0.6f, 0.9f));
}

// Far away: uniform by area, but for one in a thousand. 2^14 Sobol points fill 8 x 8 boxes evenly: 256 each;
// 6 in 100 are drawn again at random: five standard deviations of their number.
TEST(SampleLight, FarLightsAreSampledUniformly) {
  const PlacedLight light = square_light(0.5f, 50);
  std::vector<int> counts(64, 0);
  for (std::uint32_t k = 0; k < (1u << 14); ++k) {
    const auto [a, b, c, d] = owen_sobol(k, 3);
    const Vec3 at = sample_light(light, {0, 0, 0}, {0, 0, 1}, a, b, c);
    const auto bin = [](float x) { return std::min(static_cast<int>((x + 0.5f) * 8), 7); };
    ++counts[bin(at.x) * 8 + bin(at.y)];
  }
  for (const int count : counts) EXPECT_NEAR(count, 256, 5 * std::sqrt(0.06 * 256));
}

// Strips 0.2 m wide that begin `from` m from a point and `height` over it. What a part of one gets is its
// share of cos cos / r^2, which for level strips is 1 / r^4. Five standard deviations of independent draws;
// these are more even. The first is halved often, the second, 3 of its lengths away, not at all.
TEST(SampleLight, IsInProportionToWhatEachPointContributes) {
  struct Strip {
    float from, length, height;
  };
  for (const auto& [from, length, height] : {Strip{0, 4, 0.3f}, Strip{2.8f, 1, 0.8f}}) {
    const float to = from + length;
    const PlacedLight light =
        light_of({{from, 0.1f, height}, {to, 0.1f, height}, {to, -0.1f, height}, {from, -0.1f, height}});
    constexpr int kParts = 4, kPoints = 1 << 14, kSteps = 4'000, kAcross = 20;
    double share[kParts] = {}, total = 0, drawn[kParts] = {};
    for (int step = 0; step < kSteps; ++step)
      for (int across = 0; across < kAcross; ++across) {
        const double x = from + length * (step + 0.5) / kSteps, y = 0.1 * (across + 0.5) / kAcross;
        const double contribution = std::pow(x * x + y * y + height * height, -2);
        share[step * kParts / kSteps] += contribution;
        total += contribution;
      }
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const auto [a, b, c, d] = owen_sobol(k, 3);
      const Vec3 at = sample_light(light, {0, 0, 0}, {0, 0, 1}, a, b, c);
      drawn[std::clamp(static_cast<int>((at.x - from) / length * kParts), 0, kParts - 1)] += 1.0 / kPoints;
    }
    for (int part = 0; part < kParts; ++part) {
      const double p = share[part] / total;
      EXPECT_NEAR(drawn[part], p, 5 * std::sqrt(p * (1 - p) / kPoints)) << part << " from " << from;
    }
    EXPECT_GT(share[0], 1.5 * share[kParts - 1]) << "too even to tell";
  }
}

}  // namespace
}  // namespace engine
