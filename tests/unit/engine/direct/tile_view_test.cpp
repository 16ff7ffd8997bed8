// What a cell gets by its rule is right where the rule is used.
#include "engine/direct/tile_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/engine/direct/lighting_runs.h"

namespace engine {
namespace {

/// A cell about the origin that looks up, as a tile of its own.
struct OneCell {
  Patches patches;
  std::vector<Tile> tiles;
  TileLayout layout;
  PlacedTile placed;

  explicit OneCell(bool is_triangle) {
    Scene scene = tests::scene_with(1, 1);
    if (is_triangle)
      tests::add_polygon(scene, {{-0.1f, -0.1f, 0}, {0.13f, -0.06f, 0}, {-0.03f, 0.16f, 0}});
    else
      tests::add_polygon(scene, {{-0.1f, -0.1f, 0}, {0.1f, -0.1f, 0}, {0.1f, 0.1f, 0}, {-0.1f, 0.1f, 0}});
    patches = *mesh_into_patches(scene, 10);
    add_tiles(patches, 0, 1, 64, tiles);
    lay_out(patches, tiles[0], layout);
    placed.place(patches, tiles[0], layout, {}, {0, 1}, true);
  }

  /// Mean of f over the cell by the midpoint rule.
  template <class F>
  double mean(const F& f) const {
    constexpr int kSteps = 40;
    const CellEdges edges = cell_edges(placed.facet().placed, layout.cells[0]);
    const bool folded = layout.cells[0].count == 3;
    double sum = 0;
    int count = 0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j) {
        // Of a triangle, the middles of both halves of each small parallelogram.
        for (const float third : folded ? std::vector<float>{1.0f / 3, 2.0f / 3} : std::vector<float>{0.5f}) {
          const float a = (static_cast<float>(i) + third) / kSteps;
          const float b = (static_cast<float>(j) + third) / kSteps;
          if (folded && a + b > 1) continue;
          sum += f(edges.corner + a * edges.edge_u + b * edges.edge_v);
          ++count;
        }
      }
    return sum / count;
  }
};

LightPose square_light(Vec3 middle, Vec3 u, Vec3 v) {
  PlacedFacet placed;
  placed.origin = middle - 0.5f * (u + v);
  placed.edge_u = u;
  placed.edge_v = v;
  placed.normal = normalized(cross(u, v));
  const Vec3 o = placed.origin;
  placed.corners = {o, o + u, o + u + v, o + v};
  LightPose light;
  light.slots = {0, 1};
  light.facet = place_light(Facet{}, placed);
  light.ball.middle = middle;
  light.ball.normal = placed.normal;
  light.ball.radius_m = 0.5f * std::max(length(u + v), length(u - v));
  return light;
}

TEST(TileView, TheRuleOfACellIsExactToOneInTenThousandWhereItIsUsed) {
  std::mt19937 random(3);
  const auto number = [&](float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
  };
  for (const bool is_triangle : {false, true}) {
    const OneCell cell(is_triangle);
    int apart = 0, close = 0;
    for (int k = 0; k < 400; ++k) {
      const Vec3 middle{number(-2, 2), number(-2, 2), number(-0.2f, 2)};
      Vec3 u{number(-1, 1), number(-1, 1), number(-1, 1)};
      const Vec3 v = number(0.1f, 1) * normalized(cross(u, {number(-1, 1), number(-1, 1), 1}));
      if (dot(cross(u, v), -middle) < 0) u = -u;
      const LightPose light = square_light(middle, u, v);
      TileView view;
      if (!view.look(cell.placed, light, 100)) continue;
      close += view.of(0) == View::close ? 1 : 0;
      if (view.of(0) != View::apart) continue;
      ++apart;
      const double exact = cell.mean([&](Vec3 at) {
        return point_to_polygon_form_factor(at, {0, 0, 1}, light.facet.polygon());
      });
      EXPECT_NEAR(view.factor(0), exact, 1e-4 * exact + 1e-6) << k;  // 1e-6: of a single factor
    }
    EXPECT_GT(apart, 100) << is_triangle;
    EXPECT_GT(close, 5) << is_triangle;
  }
}

TEST(TileView, OfAPointLightTheRuleIsExactToOneInTenThousand) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> number(-1.5f, 1.5f);
  SourceMotion source;
  source.type = api::LightType::point;
  const OneCell cell(false);
  int apart = 0;
  for (int k = 0; k < 300; ++k) {
    LightPose light;
    light.slots = {0, 1};
    light.source = &source;
    light.position = {number(random), number(random), 0.05f + std::abs(number(random))};
    TileView view;
    if (!view.look(cell.placed, light, 100) || view.of(0) != View::apart) continue;
    ++apart;
    const double exact = cell.mean([&](Vec3 at) {
      const Vec3 way = light.position - at;
      return way.z / std::pow(double{dot(way, way)}, 1.5);
    });
    EXPECT_NEAR(view.factor(0), exact, 1.5e-4 * exact) << k;
  }
  EXPECT_GT(apart, 100);
}

TEST(TileView, ACellThatReachesBehindALightIsMeasuredBySamples) {
  const OneCell cell(false);
  TileView view;
  // A wall lamp whose plane cuts the cell, far to the side.
  const LightPose across = square_light({0.02f, 3, 2}, {0, 0, 1}, {0, 1, 0});
  ASSERT_TRUE(view.look(cell.placed, across, 100));
  EXPECT_EQ(view.of(0), View::close);
  const LightPose behind = square_light({-2, 0, 2}, {0, 1, 0.9f}, {0, 0, 1});
  const bool may = view.look(cell.placed, behind, 100);
  EXPECT_TRUE(!may || view.of(0) == View::dark || view.of(0) == View::apart);
}

TEST(TileView, ASpotIsApartOnlyWhereItDoesNotFallOffAcrossTheCell) {
  SourceMotion spot;
  spot.type = api::LightType::spot;
  spot.inner_cosine = std::cos(0.3);
  spot.outer_cosine = std::cos(0.5);
  LightPose light;
  light.slots = {0, 1};
  light.source = &spot;
  light.direction = {0, 0, -1};
  const OneCell cell(false);
  TileView view;
  const auto seen_at = [&](float angle) {
    light.position = {3 * std::tan(angle), 0, 3};
    return view.look(cell.placed, light, 100) ? view.of(0) : View::dark;
  };
  EXPECT_EQ(seen_at(0.1f), View::apart);
  EXPECT_EQ(seen_at(0.3f), View::close);
  EXPECT_EQ(seen_at(0.5f), View::close);
  EXPECT_EQ(seen_at(0.7f), View::dark);
}

}  // namespace
}  // namespace engine
