// Shadow rays neither meet the surfaces they start and end on, nor pass what stands close to them.
#include "engine/direct/clearance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/direct/direct_light.h"
#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::World;

constexpr std::uint32_t kSamples = 64;

/// Turns about (1, 2, 3), scales and moves.
Pose placed_at(double degrees, double scale, Vec3 to) {
  const double angle = degrees * 3.14159265358979 / 180, s = std::sin(angle), c = std::cos(angle);
  const double root = std::sqrt(14.0), x = 1 / root, y = 2 / root, z = 3 / root, t = 1 - c;
  Pose pose;
  pose.m = {{{t * x * x + c, t * x * y - s * z, t * x * z + s * y, to.x},
             {t * x * y + s * z, t * y * y + c, t * y * z - s * x, to.y},
             {t * x * z - s * y, t * y * z + s * x, t * z * z + c, to.z}}};
  for (auto& row : pose.m)
    for (int k = 0; k < 3; ++k) row[k] *= scale;
  return pose;
}

/// A unit square (quad or two triangles) and one that emits, at right angles, whose nearest edges are `gap`
/// off the line in which their planes meet. Their vertices are already where `pose` puts them, rounded.
Scene corner_of_two_squares(const Pose& pose, bool triangles, float gap = 0) {
  Scene scene = tests::scene_with(2, 2);
  const auto at = [&](float x, float y, float z) { return transform_point(pose, {x, y, z}); };
  const auto add = [&](Vec3 a, Vec3 b, Vec3 c, Vec3 d, std::uint32_t material) {
    if (!triangles) return add_polygon(scene, {a, b, c, d}, 0, material);
    add_polygon(scene, {a, b, c}, 0, material);
    add_polygon(scene, {a, c, d}, 0, material);
  };
  add(at(0, gap, 0), at(1, gap, 0), at(1, 1, 0), at(0, 1, 0), 0);
  add(at(0, 0, gap), at(0, 0, 1), at(1, 0, 1), at(1, 0, gap), 1);
  return scene;
}

Animation with_light(const Scene& scene) {
  Animation animation = tests::still(scene, 2);
  animation.emission.exitance_w_m2[1] = {{1, 1, 1}};
  return animation;
}

/// Adds a thing of the scene's size as object 1, which park() puts 100 km away.
void add_thing(Scene& scene, double scale) {
  const auto size = static_cast<float>(scale);
  add_polygon(scene, {{0, 0, 0}, {0, size, 0}, {0, 0, size}}, 1, 0);
}

void park(Animation& animation) {
  animation.objects[1].spans[0].pose = tests::moved_to(1e5, 0, 0);
}

/// By area, over the patches of material 0, in frame 0.
double mean_irradiance(const World& world) {
  const auto lit = direct_light(world.patches, world.animation, world.animation.emission, world.static_rays,
                                std::vector<FrameIndex>{0}, {kSamples}, {});
  EXPECT_TRUE(lit);
  double sum = 0, area = 0;
  for (PatchId patch = 0; patch < world.patches.count(); ++patch) {
    if (world.patches.facets[world.patches.facet_of[patch]].material != 0) continue;
    sum += double{world.patches.area_m2[patch]} * lit->irradiance_w_m2.at(patch, 0).r;
    area += world.patches.area_m2[patch];
  }
  return sum / area;
}

struct Place {
  double scale;
  Vec3 to;
};
// About the origin, and as far from it as leaves a float some thousand steps in the length of the scene.
const Place kPlaces[] = {{1e-3, {}}, {1e-3, {0.3f, 2, -1}}, {1, {}}, {1, {12, -7, 31}}, {1, {1e3, -700, 20}},
                         {1e3, {}},  {1e3, {5e3, 2e4, 300}}};

// No ray between the two meets anything but them, so without visibility the same points give the same bits.
// The gap is wider than what rounding can do to either: where they touch, points may come to lie behind the
// other's plane.
TEST(Clearance, TwoSquaresThatSeeOneAnotherDoNotShadeThemselves) {
  for (const auto& [scale, to] : kPlaces)
    for (const bool triangles : {false, true})
      for (const double degrees : {0.0, 13.0, 45.0, 90.0, 131.0, 222.0}) {
        const Scene scene = corner_of_two_squares(placed_at(degrees, scale, to), triangles, 0.02f);
        const World world(scene, with_light(scene), 0.25 * scale);
        Animation apart = with_light(scene);  // nothing static to meet, nothing there that moves in frame 1
        const StaticRays nothing(world.patches, [&] {
          for (auto& object : apart.objects) object.spans = {{0, 0, {}}, {1, 1, tests::moved_to(0, 0, 1)}};
          return apart;
        }());
        const auto frames = std::vector<FrameIndex>{0};
        const auto shaded = direct_light(world.patches, world.animation, world.animation.emission,
                                         world.static_rays, frames, {kSamples}, {});
        const auto clear = direct_light(world.patches, world.animation, world.animation.emission, nothing,
                                        frames, {kSamples}, {});
        ASSERT_TRUE(shaded && clear);
        std::size_t differ = 0;
        for (std::size_t k = 0; k < clear->irradiance_w_m2.values.size(); ++k)
          differ += shaded->irradiance_w_m2.values[k] == clear->irradiance_w_m2.values[k] ? 0 : 1;
        EXPECT_EQ(differ, 0u) << "of " << clear->irradiance_w_m2.values.size() << " scale " << scale << " at "
                              << to.x << " turned " << degrees << (triangles ? " triangles" : " quads");
      }
}

// Two perpendicular unit squares with a common edge: F = 0.20004 (Hottel, 1931).
TEST(Clearance, ACornerIsLitAlikeAtEveryScale) {
  for (const auto& [scale, to] : kPlaces) {
    const Scene scene = corner_of_two_squares(placed_at(31, scale, to), false);
    EXPECT_NEAR(mean_irradiance(World(scene, with_light(scene), 0.25 * scale)), 0.20004, 0.002) << scale;
  }
}

/// The corner with a sheet close in front of the emitting square: everything is dark.
Scene covered_corner(double scale, float gap, bool with_parked_object) {
  const Pose pose = placed_at(0, scale, {});
  Scene scene = corner_of_two_squares(pose, false);
  const auto at = [&](float x, float y, float z) { return transform_point(pose, {x, y, z}); };
  add_polygon(scene, {at(-1, gap, -1), at(-1, gap, 2), at(2, gap, 2), at(2, gap, -1)}, 0, 0);
  if (with_parked_object) add_thing(scene, scale);
  return scene;
}

TEST(Clearance, ASheetCloseToALightHidesItWhateverIsParkedFarAway) {
  for (const double scale : {1e-3, 1.0, 1e3})
    for (const bool parked : {false, true}) {
      const Scene scene = covered_corner(scale, 2e-4f, parked);
      Animation animation = with_light(scene);
      park(animation);
      const World world(scene, animation, scale);
      const auto lit = direct_light(world.patches, world.animation, world.animation.emission,
                                    world.static_rays, std::vector<FrameIndex>{0}, {kSamples}, {});
      ASSERT_TRUE(lit);
      // What of the floor lies between the light and the sheet: a strip of 2e-4, at most as bright as the
      // light.
      EXPECT_LE(lit->irradiance_w_m2.at(0, 0).r, 0.005) << scale << parked;
    }
}

TEST(Clearance, WhatIsParkedFarAwayChangesNoBit) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Scene alone = corner_of_two_squares(placed_at(31, scale, {}), false);
    Scene beside = alone;
    add_thing(beside, scale);
    Animation animation = with_light(beside);
    park(animation);
    const World one(alone, with_light(alone), 0.25 * scale), two(beside, animation, 0.25 * scale);
    const auto frames = std::vector<FrameIndex>{0};
    const auto a =
        direct_light(one.patches, one.animation, one.animation.emission, one.static_rays, frames, {8}, {});
    const auto b =
        direct_light(two.patches, two.animation, two.animation.emission, two.static_rays, frames, {8}, {});
    ASSERT_TRUE(a && b);
    for (PatchId patch = 0; patch < one.patches.count(); ++patch)
      ASSERT_EQ(a->irradiance_w_m2.at(patch, 0), b->irradiance_w_m2.at(patch, 0))
          << patch << " scale " << scale;
  }
}

// A parallelogram within the tolerance of one, but bent: half of it is off the plane that its points are on.
TEST(Clearance, AParallelogramThatIsBentALittleDoesNotShadeItself) {
  const float bend = 2e-5f;
  Scene scene = tests::scene_with(2, 2);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, bend}, {0, 1, 0}}, 0, 0);
  add_polygon(scene, {{0, 1, 3}, {1, 1, 3}, {1, 0, 3}, {0, 0, 3}}, 0, 1);
  const World world(scene, with_light(scene), 10);
  ASSERT_FALSE(world.patches.facets[0].is_triangle);
  EXPECT_GE(roughness_of(place(world.patches.facets[0], {}), false).bend_m, 0.9f * bend);
  const double bent = mean_irradiance(world);
  scene.vertices[2].z = 0;
  const double flat = mean_irradiance(World(scene, with_light(scene), 10));
  EXPECT_NEAR(bent, flat, 1e-4 * flat);
}

}  // namespace
}  // namespace engine
