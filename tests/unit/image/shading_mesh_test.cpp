#include "engine/image/shading_mesh.h"

#include <gtest/gtest.h>

#include "tests/unit/engine/patches/random_trees.h"
#include "tests/unit/image/rooms.h"

namespace {

using engine::Rgb;
using engine::Vec3;
using tests::add_polygon;

const auto never = [] { return false; };

struct Shaded {
  engine::Patches patches;
  engine::ShadingMesh mesh;
  std::vector<Rgb> nodes;

  /// Radiosity that a ray would see on a facet.
  Rgb at(std::uint32_t facet, float u, float v, bool front = true) const {
    const auto blend = engine::blend_at(mesh, patches, facet, u, v, front);
    Rgb sum;
    for (std::uint32_t c = 0; c < blend.count; ++c) sum += blend.nodes[c].weight * nodes[blend.nodes[c].node];
    return sum;
  }
  /// The same at a point in the facet's plane.
  Rgb at_point(std::uint32_t facet_index, Vec3 p) const {
    const engine::Facet& facet = patches.facets[facet_index];
    const Vec3 offset = p - facet.origin, u = facet.edge_u, v = facet.edge_v;
    const float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ou = dot(offset, u), ov = dot(offset, v);
    const float determinant = uu * vv - uv * uv;
    return at(facet_index, (ou * vv - ov * uv) / determinant, (ov * uu - ou * uv) / determinant);
  }
};

Shaded shade(const engine::Patches& patches, const std::function<Rgb(engine::PatchId, Vec3)>& field) {
  Shaded shaded{patches, engine::build_shading_mesh(patches), {}};
  std::vector<std::vector<Rgb>> values(1);
  engine::node_radiosity(shaded.mesh, shaded.patches, tests::series_of(shaded.patches, 1, field), 0, never,
                         values);
  shaded.nodes = values[0];
  return shaded;
}

Shaded shade(const engine::Scene& scene, double edge_m,
             const std::function<Rgb(engine::PatchId, Vec3)>& field) {
  auto patches = engine::mesh_into_patches(scene, edge_m);
  EXPECT_TRUE(patches);
  return shade(*patches, field);
}

/// The same with cells quartered at random.
Shaded shade_quartered(const engine::Scene& scene, double edge_m, unsigned seed,
                       const std::function<Rgb(engine::PatchId, Vec3)>& field) {
  auto patches = engine::mesh_into_patches(scene, edge_m);
  EXPECT_TRUE(patches);
  std::mt19937 random(seed);
  tests::quarter_at_random(*patches, 3, 0.5, random);
  return shade(*patches, field);
}

/// Anything but smooth.
Rgb rough(engine::PatchId patch, Vec3) {
  return {static_cast<float>(patch * 2654435761u % 1000u) / 1000, 0, 0};
}

Rgb linear_in_x(engine::PatchId, Vec3 p) {
  return {1 + p.x, 2 * p.x, 3};
}

TEST(ShadingMesh, ALinearFieldIsReproducedAwayFromTheRimAndAcrossAWeldedSeam) {
  auto scene = tests::scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  add_polygon(scene, {{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}});
  const Shaded shaded = shade(scene, 0.1, linear_in_x);
  for (float x = 0.1f; x < 1.9f; x += 0.013f)
    for (const float y : {0.15f, 0.5f, 0.72f}) {
      const std::uint32_t facet = x < 1 ? 0 : 1;
      EXPECT_NEAR(shaded.at(facet, x - static_cast<float>(facet), y).r, 1 + x, 1e-5f) << "x = " << x;
    }
  for (float y = 0; y <= 1; y += 0.01f) EXPECT_EQ(shaded.at(0, 1, y), shaded.at(1, 0, y)) << "y = " << y;
}

// Five corners: triangles of different size, so that they cut their common edges differently (8 against 10
// parts, for example). The field has slope 1 and h = 0.1 m cells; a seam that is left open steps by about
// h/2 = 0.05, one that is closed by the second difference along it only.
TEST(ShadingMesh, TheTrianglesOfAPentagonShowNoStep) {
  auto scene = tests::scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {1, -0.2f, 0}, {1.3f, 0.5f, 0}, {0.9f, 1.1f, 0}, {-0.1f, 0.8f, 0}});
  const Shaded shaded = shade(scene, 0.1, linear_in_x);
  ASSERT_EQ(shaded.patches.facets.size(), 3u);
  EXPECT_FALSE(shaded.mesh.seams.empty()) << "all grids match: nothing is tested";
  int seams = 0;
  for (std::uint32_t a = 0; a < 3; ++a)
    for (std::uint32_t b = a + 1; b < 3; ++b)
      for (int edge = 0; edge < 3; ++edge) {
        const engine::Facet& facet = shaded.patches.facets[a];
        const Vec3 corners[3] = {facet.origin, facet.origin + facet.edge_u, facet.origin + facet.edge_v};
        const Vec3 from = corners[edge], to = corners[(edge + 1) % 3];
        const engine::Facet& other = shaded.patches.facets[b];
        const Vec3 others[3] = {other.origin, other.origin + other.edge_u, other.origin + other.edge_v};
        int shared = 0;
        for (const Vec3 p : others) shared += length(p - from) < 1e-5f || length(p - to) < 1e-5f;
        if (shared != 2) continue;
        ++seams;
        for (float t = 0; t <= 1; t += 0.01f) {
          const Vec3 p = from + t * (to - from);
          EXPECT_NEAR(shaded.at_point(a, p).r, shaded.at_point(b, p).r, 0.01f) << "t = " << t;
        }
      }
  EXPECT_EQ(seams, 2);
}

TEST(ShadingMesh, InsideATriangleALinearFieldIsReproduced) {
  auto scene = tests::scene_with(1, 1);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const Shaded shaded = shade(scene, 0.1, linear_in_x);  // 15 parts per edge
  for (float u = 0.1f; u < 0.8f; u += 0.017f)
    for (float v = 0.1f; u + v < 0.9f; v += 0.019f)
      EXPECT_NEAR(shaded.at(0, u, v).r, 1 + u, 1e-5f) << u << ' ' << v;
}

/// A triangle and a square above it, both sides.
engine::Scene triangle_and_square() {
  auto scene = tests::scene_with(1, 1, true);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  add_polygon(scene, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  return scene;
}

/// At points of both facets `step` apart in u and v, a hair beyond their edges too.
void expect_weights_sum_to_one(const Shaded& shaded, float step) {
  for (const std::uint32_t facet : {0u, 1u})
    for (float u = -1e-6f; u <= 1.000001f; u += step)
      for (float v = 0; v <= 1.000001f; v += step) {
        if (facet == 0 && u + v > 1.000002f) continue;
        const auto blend = engine::blend_at(shaded.mesh, shaded.patches, facet, u, v, false);
        float sum = 0;
        for (std::uint32_t c = 0; c < blend.count; ++c) {
          EXPECT_GE(blend.nodes[c].weight, 0);
          sum += blend.nodes[c].weight;
        }
        EXPECT_NEAR(sum, 1, 1e-6f);
      }
}

TEST(ShadingMesh, WeightsSumToOneOnEveryPointOfEveryFacet) {
  expect_weights_sum_to_one(shade(triangle_and_square(), 0.3, linear_in_x), 0.05f);
}

TEST(ShadingMesh, FrontAndBackDoNotMix) {
  auto scene = tests::scene_with(1, 1, true);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const std::uint32_t cells = 25;
  const Shaded shaded = shade(scene, 0.2, [&](engine::PatchId patch, Vec3) {
    return patch < cells ? Rgb{1, 1, 1} : Rgb{5, 5, 5};
  });
  for (float u = 0; u <= 1; u += 0.05f)
    for (float v = 0; v <= 1; v += 0.05f) {
      EXPECT_FLOAT_EQ(shaded.at(0, u, v, true).r, 1);
      EXPECT_FLOAT_EQ(shaded.at(0, u, v, false).r, 5);
    }
}

TEST(ShadingMesh, TheBackOfAOneSidedFacetIsBlack) {
  auto scene = tests::scene_with(1, 1, false);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  const Shaded shaded = shade(scene, 0.2, linear_in_x);
  EXPECT_EQ(engine::blend_at(shaded.mesh, shaded.patches, 0, 0.5f, 0.5f, false).count, 0u);
}

/// Two unit squares that share the edge x = 1; how their value at the middle of the edge differs when one
/// glows with 1 and the other with 3.
float step_at_edge(std::uint32_t object, std::uint32_t material, Vec3 far_low, Vec3 far_high) {
  auto scene = tests::scene_with(2, 2);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  add_polygon(scene, {{1, 0, 0}, far_low, far_high, {1, 1, 0}}, object, material);
  const Shaded shaded = shade(scene, 0.25, [](engine::PatchId patch, Vec3) {
    return patch < 16 ? Rgb{1, 1, 1} : Rgb{3, 3, 3};
  });
  return shaded.at(1, 0, 0.5f).r - shaded.at(0, 1, 0.5f).r;
}

TEST(ShadingMesh, OnlyTheSameObjectMaterialAndDirectionAreWelded) {
  EXPECT_FLOAT_EQ(step_at_edge(0, 0, {2, 0, 0}, {2, 1, 0}), 0) << "coplanar";
  EXPECT_FLOAT_EQ(step_at_edge(1, 0, {2, 0, 0}, {2, 1, 0}), 2) << "another object";
  EXPECT_FLOAT_EQ(step_at_edge(0, 1, {2, 0, 0}, {2, 1, 0}), 2) << "another material";
  EXPECT_FLOAT_EQ(step_at_edge(0, 0, {1, 0, 1}, {1, 1, 1}), 2) << "a corner of 90 degrees";
  EXPECT_FLOAT_EQ(step_at_edge(0, 0, {2, 0, 0.1f}, {2, 1, 0.1f}), 2) << "a bend of 5.7 degrees";
}

TEST(ShadingMesh, BlocksOfFramesGiveTheValuesOfSingleFrames) {
  auto scene = tests::scene_with(1, 1, true);
  tests::add_box(scene, {0, 0, 0}, {1, 2, 3}, true);
  const auto patches = engine::mesh_into_patches(scene, 0.3);
  ASSERT_TRUE(patches);
  const auto mesh = engine::build_shading_mesh(*patches);
  auto series = tests::series_of(*patches, 5, linear_in_x);
  for (engine::PatchId p = 0; p < patches->count(); ++p)
    for (std::uint32_t f = 0; f < 5; ++f) series.at(p, f).g = static_cast<float>(p % 7 + 10 * f);
  std::vector<std::vector<Rgb>> block(4), one(1);
  engine::node_radiosity(mesh, *patches, series, 1, never, block);
  for (std::uint32_t f = 1; f < 5; ++f) {
    engine::node_radiosity(mesh, *patches, series, f, never, one);
    EXPECT_EQ(one[0], block[f - 1]) << "frame " << f;
  }
}

// Patches of sizes from 1 to 64 with values that have nothing to do with each other: across the borders
// between them the picture goes on without a step. The slope of a picture of the smallest cells is at most 1
// per 1/32 of the facet; a step would be a fraction of 1.
TEST(ShadingMesh, NoStepWhereQuartersMeetLargerCells) {
  for (const bool is_triangle : {false, true})
    for (unsigned seed = 0; seed < 10; ++seed) {
      auto scene = tests::scene_with(1, 1);
      if (is_triangle)
        add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {0.5f, 0.8f, 0}});
      else
        add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
      const Shaded shaded = shade_quartered(scene, 0.25, seed, rough);
      ASSERT_FALSE(shaded.mesh.hanging.empty());
      const engine::Facet& facet = shaded.patches.facets[0];
      constexpr float kHair = 1e-5f;
      float largest = 0;
      for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
        const auto corners = engine::cell_corners(facet, cell);
        for (std::uint32_t c = 0; c < corners.count; ++c)
          for (float t = 0.03f; t < 1; t += 0.04f) {
            const std::uint32_t next = (c + 1) % corners.count;
            const float u = corners.u[c] + t * (corners.u[next] - corners.u[c]);
            const float v = corners.v[c] + t * (corners.v[next] - corners.v[c]);
            const float across_u = corners.v[next] - corners.v[c], across_v = corners.u[c] - corners.u[next];
            const float size = std::max(std::abs(across_u), std::abs(across_v));
            const float du = across_u / size * kHair, dv = across_v / size * kHair;
            if (u + du < 0 || v + dv < 0 || u + du > 1 || v + dv > 1) continue;
            if (is_triangle && u + v + du + dv > 1) continue;
            largest =
                std::max(largest, std::abs(shaded.at(0, u + du, v + dv).r - shaded.at(0, u - du, v - dv).r));
          }
      }
      EXPECT_LT(largest, 4 * 32 * kHair);
    }
}

TEST(ShadingMesh, ALinearFieldIsReproducedWhateverSizesMeet) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    auto scene = tests::scene_with(1, 1);
    add_polygon(scene, {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}});
    const Shaded shaded = shade_quartered(scene, 1, seed, linear_in_x);
    for (float u = 0.26f; u < 0.74f; u += 0.013f)  // the cells on the rim know one side of it only
      for (float v = 0.26f; v < 0.74f; v += 0.017f)
        EXPECT_NEAR(shaded.at(0, u, v).r, 1 + 4 * u, 1e-4f) << u << ' ' << v << " seed " << seed;
  }
}

TEST(ShadingMesh, WeightsSumToOneInQuarters) {
  expect_weights_sum_to_one(shade_quartered(triangle_and_square(), 0.5, 1, linear_in_x), 0.01f);
}

// Squares and triangles side by side, each quartered in its own way.
TEST(ShadingMesh, NoStepBetweenFacetsThatAreQuarteredDifferently) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    auto scene = tests::scene_with(1, 1);
    add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    add_polygon(scene, {{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}});
    add_polygon(scene, {{2, 0, 0}, {2.5f, 0.5f, 0}, {2, 1, 0}});
    const Shaded shaded = shade_quartered(scene, 0.25, seed, rough);
    for (float y = 0; y <= 1; y += 0.003f) {
      EXPECT_NEAR(shaded.at_point(0, {1, y, 0}).r, shaded.at_point(1, {1, y, 0}).r, 1e-4f) << y;
      EXPECT_NEAR(shaded.at_point(1, {2, y, 0}).r, shaded.at_point(2, {2, y, 0}).r, 1e-4f) << y;
    }
  }
}

}  // namespace
