#include "engine/image/corner_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/image/shading_mesh.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

constexpr int kSides = 12;

Vec3 on_cylinder(int k, float z) {
  const double angle = 2 * std::numbers::pi * k / kSides;
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), z};
}

/// The wall of a cylinder of radius 1, height 2: its front is outside.
struct Cylinder {
  Patches patches;
  std::vector<CornerNormals> smooth;

  Cylinder() {
    Scene scene = tests::scene_with(1, 1);
    for (int k = 0; k < kSides; ++k)
      tests::add_polygon(
          scene, {on_cylinder(k, 0), on_cylinder(k + 1, 0), on_cylinder(k + 1, 2), on_cylinder(k, 2)});
    patches = *mesh_into_patches(scene, 0.3);
    for (const Facet& facet : patches.facets) {
      CornerNormals normals;
      for (int c = 0; c < 4; ++c) normals[c] = {facet.corners[c].x, facet.corners[c].y, 0};
      smooth.push_back(normals);
    }
  }

  /// The largest difference of what two neighbouring facets show on their common edge, where each facet glows
  /// with its number.
  float largest_step(const ShadingMesh& mesh) const {
    std::vector<std::vector<Rgb>> nodes(1);
    const auto glow = tests::series_of(patches, 1, [&](PatchId patch, Vec3) {
      const auto b = static_cast<float>(patches.facet_of[patch]);
      return Rgb{b, b, b};
    });
    node_radiosity(
        mesh, patches, glow, 0, [] { return false; }, nodes);
    const auto shown = [&](std::uint32_t facet, float u, float v) {
      const NodeBlend blend = blend_at(mesh, patches, facet, u, v, true);
      float sum = 0;
      for (std::uint32_t c = 0; c < blend.count; ++c)
        sum += blend.nodes[c].weight * nodes[0][blend.nodes[c].node].r;
      return sum;
    };
    float largest = 0;
    for (std::uint32_t f = 0; f < kSides; ++f)
      for (float v = 0; v <= 1; v += 0.07f)
        largest = std::max(largest, std::abs(shown(f, 1, v) - shown((f + 1) % kSides, 0, v)));
    return largest;
  }
};

TEST(CornerNormals, AnEdgeWhoseNormalsAgreeShowsNoStepAndOneWhoseNormalsDifferDoes) {
  const Cylinder cylinder;
  ASSERT_EQ(cylinder.patches.facets.size(), std::size_t{kSides});
  EXPECT_EQ(cylinder.largest_step(build_shading_mesh(cylinder.patches, cylinder.smooth)), 0);
  EXPECT_EQ(cylinder.largest_step(build_shading_mesh(cylinder.patches)), kSides - 1);
}

TEST(CornerNormals, ACreaseBetweenSmoothFacesStays) {
  Cylinder cylinder;
  for (int c = 0; c < 4; ++c) cylinder.smooth[3][c] = cylinder.patches.facets[3].normal;  // one flat strip
  EXPECT_GT(cylinder.largest_step(build_shading_mesh(cylinder.patches, cylinder.smooth)), 0.5f);
}

TEST(CornerNormals, TurnFromCornerToCorner) {
  const Cylinder cylinder;
  for (const float u : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const Vec3 normal = shading_normal(cylinder.patches, cylinder.smooth, 0, u, 0.3f);
    EXPECT_NEAR(length(normal), 1, 1e-6f);
    // The chord is divided evenly, the angle nearly so.
    EXPECT_NEAR(std::atan2(normal.y, normal.x), u * 2 * std::numbers::pi / kSides, 0.003) << u;
  }
  EXPECT_EQ(shading_normal(cylinder.patches, {}, 0, 0.5f, 0.5f), cylinder.patches.facets[0].normal);
}

TEST(CornerNormals, OppositeNormalsLeaveTheFacetsOwnWhereTheyCancel) {
  Cylinder cylinder;
  cylinder.smooth[0] = {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{0, 0, -1}, Vec3{0, 0, 1}};
  EXPECT_EQ(shading_normal(cylinder.patches, cylinder.smooth, 0, 0.5f, 0.5f),
            cylinder.patches.facets[0].normal);
}

TEST(CornerNormals, AreThoseOfTheFileTurnedToTheFront) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5f, 1.5f, 0}, {0, 1, 0}});
  tests::add_polygon(scene, {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}});
  EXPECT_TRUE(corner_normals(scene, *mesh_into_patches(scene, 1)).empty()) << "the file has none";
  // Each corner leans outwards; the third is written upside down. The second polygon has none.
  scene.normals = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {-0.6f, 0, -0.8f}, {0, 0.6f, 0.8f}, {-0.8f, 0, 0.6f}};
  scene.corner_normals = {0, 1, 2, 3, 4, kNoIndex, kNoIndex, kNoIndex, kNoIndex};
  const Patches patches = *mesh_into_patches(scene, 1);
  const auto normals = corner_normals(scene, patches);
  ASSERT_EQ(normals.size(), patches.facets.size());
  const Vec3 expected[] = {scene.normals[0], scene.normals[1], -scene.normals[2], scene.normals[3],
                           scene.normals[4]};
  int compared = 0;
  for (std::size_t f = 0; f < patches.facets.size(); ++f)
    for (int c = 0; c < (patches.facets[f].is_triangle ? 3 : 4); ++c)
      for (std::uint32_t k = 0; k < 9; ++k)
        if (scene.vertices[scene.corners[k]] == patches.facets[f].corners[c]) {
          EXPECT_EQ(normals[f][c], k < 5 ? expected[k] : patches.facets[f].normal) << f << ' ' << c;
          ++compared;
        }
  EXPECT_EQ(compared, 3 * 3 + 4);
}

}  // namespace
}  // namespace engine
