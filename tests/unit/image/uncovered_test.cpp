#include "engine/image/uncovered.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

/// A floor of 1 m patches, 6 m x 6 m, its front up, and a box of which the corner x, y = 2.5 m is in the
/// middle of a patch.
struct FloorWithBox {
  Scene scene = tests::scene_with(2, 2);
  Animation animation;
  Patches patches;

  explicit FloorWithBox(float gap_m = 0, std::uint32_t floor_material = 0) {
    tests::add_polygon(scene, {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}}, 0, floor_material);
    tests::add_box(scene, {2.5f, 2.5f, gap_m}, {4, 4, 1}, false, 1);
    animation = tests::still(scene, 2);
    animation.emission.exitance_w_m2[1] = {{1, 1, 1}};
    patches = *mesh_into_patches(scene, 1);
  }
  Uncovered uncovered() const {
    return find_uncovered(patches, animation, StaticRays(patches, animation), build_shading_mesh(patches));
  }
};

PatchId floor_patch(int i, int j) {
  return static_cast<PatchId>(6 * j + i);
}

TEST(Uncovered, IsTheShareOfAPatchThatNothingStandsOn) {
  const FloorWithBox room;
  const Uncovered found = room.uncovered();
  ASSERT_EQ(found.share.size(), room.patches.count());
  // 16 x 16 points.
  EXPECT_EQ(found.share[floor_patch(2, 2)], 0.75f);
  EXPECT_EQ(found.share[floor_patch(3, 2)], 0.5f);
  EXPECT_EQ(found.share[floor_patch(3, 3)], 0);
  EXPECT_EQ(found.share[floor_patch(4, 4)], 1);
  EXPECT_EQ(found.share[floor_patch(1, 2)], 1);
}

TEST(Uncovered, AGapOfAnyUseToLightCoversNothing) {
  EXPECT_EQ(FloorWithBox(0.04f).uncovered().share[floor_patch(3, 3)], 0) << "a twentieth of a patch";
  EXPECT_TRUE(FloorWithBox(0.1f).uncovered().nodes.empty());
}

TEST(Uncovered, WhatMovesCoversNothingAndALampIsNeverCovered) {
  FloorWithBox moving;
  moving.animation.objects[1].spans = {{0, 0, {}}, {1, 1, tests::moved_to(1, 0, 0)}};
  EXPECT_TRUE(moving.uncovered().nodes.empty());
  EXPECT_TRUE(FloorWithBox(0, 1).uncovered().nodes.empty());
}

TEST(Uncovered, ABareRoomHasNone) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_box(scene, {0, 0, 0}, {4, 3, 2}, true);
  const Patches patches = *mesh_into_patches(scene, 0.3);
  const Animation animation = tests::still(scene, 1);
  const Uncovered found =
      find_uncovered(patches, animation, StaticRays(patches, animation), build_shading_mesh(patches));
  EXPECT_TRUE(found.nodes.empty());
  EXPECT_TRUE(found.share.empty());
}

// A ball of triangles and trapezoids (cut into triangles in one plane): they touch along their edges, and no
// point of one is on another.
TEST(Uncovered, PiecesOfOneSurfaceDoNotCoverEachOther) {
  Scene scene = tests::scene_with(1, 1);
  constexpr int kAround = 12, kDown = 6;
  const auto at = [](int i, int j) {
    const double around = 2 * 3.14159265358979 * i / kAround, down = 3.14159265358979 * j / kDown;
    return Vec3{static_cast<float>(std::sin(down) * std::cos(around)),
                static_cast<float>(std::sin(down) * std::sin(around)), static_cast<float>(std::cos(down))};
  };
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAround; ++i) {
      if (j == 0)
        tests::add_polygon(scene, {at(i, 0), at(i, 1), at(i + 1, 1)});
      else if (j == kDown - 1)
        tests::add_polygon(scene, {at(i, j), at(i, kDown), at(i + 1, j)});
      else
        tests::add_polygon(scene, {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
    }
  for (const double edge_m : {0.1, 0.25, 1.0}) {
    const Patches patches = *mesh_into_patches(scene, edge_m);
    const Animation animation = tests::still(scene, 1);
    const Uncovered found =
        find_uncovered(patches, animation, StaticRays(patches, animation), build_shading_mesh(patches));
    EXPECT_TRUE(found.nodes.empty()) << edge_m << ": " << found.nodes.size();
  }
}

// The floor reflects 4 W/m^2 wherever light gets to it, so a patch has 4 times its bare share. Whatever of it
// can be seen is to show 4, without a rim.
TEST(Uncovered, EvenLightIsEvenUpToWhatStandsInIt) {
  const FloorWithBox room;
  const ShadingMesh mesh = build_shading_mesh(room.patches);
  const Uncovered found = room.uncovered();
  PatchSeries light(room.patches.count(), 2);
  for (PatchId patch = 0; patch < light.patch_count; ++patch)
    light.at(patch, 1) = 4 * found.share[patch] * Rgb{1, 2, 0.5f};
  std::vector<std::vector<Rgb>> nodes(1);
  const auto on_floor = [&](float x, float y) {
    const NodeBlend blend = blend_at(mesh, room.patches, 0, x / 6, y / 6, true);
    Rgb sum;
    for (std::uint32_t c = 0; c < blend.count; ++c)
      sum += blend.nodes[c].weight * nodes[0][blend.nodes[c].node];
    return sum;
  };
  ASSERT_TRUE(node_radiosity(
      mesh, room.patches, light, 1, [] { return false; }, nodes));
  EXPECT_LT(on_floor(2.4f, 3).r, 3) << "the rim without it";
  show_uncovered(
      found, mesh, room.patches, light, 1,
      [](PatchId) {
        return Rgb{1, 1, 1};
      },
      nodes);
  for (float x = 0.1f; x < 6; x += 0.2f)
    for (float y = 0.1f; y < 6; y += 0.2f) {
      const bool hidden = x > 2.5f && x < 4 && y > 2.5f && y < 4;
      if (hidden) continue;
      EXPECT_NEAR(on_floor(x, y).r, 4, 1e-5f) << x << ' ' << y;
      EXPECT_NEAR(on_floor(x, y).g, 8, 1e-5f) << x << ' ' << y;
    }
}

}  // namespace
}  // namespace engine
