#include "engine/direct/form_factor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace engine {
namespace {

constexpr Vec3 kUp{0, 0, 1};
/// Of sums of a few dozen floats near 1.
constexpr double kRounding = 2e-6;

std::vector<Vec3> rectangle(Vec3 corner, Vec3 u, Vec3 v) {
  return {corner, corner + u, corner + u + v, corner + v};
}

/// Element below the corner of a parallel rectangle a x b at distance 1 (Howell's catalogue, B-3).
double under_a_corner(double a, double b) {
  const double x = std::sqrt(1 + a * a), y = std::sqrt(1 + b * b);
  return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * std::numbers::pi);
}

TEST(PointToPolygon, BelowTheCentreOfAParallelSquare) {
  for (const float half : {0.1f, 0.5f, 1.0f, 3.0f, 30.0f}) {
    const auto square = rectangle({-half, -half, 1}, {2 * half, 0, 0}, {0, 2 * half, 0});
    EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, kUp, square), 4 * under_a_corner(half, half),
                kRounding);
  }
}

TEST(PointToPolygon, BelowACornerOfAParallelRectangle) {
  const auto rect = rectangle({2, -1, 4}, {1.5f, 0, 0}, {0, 6, 0});
  EXPECT_NEAR(point_to_polygon_form_factor({2, -1, 3}, kUp, rect), under_a_corner(1.5, 6), kRounding);
}

// Element in the plane that is perpendicular to a rectangle, on the normal through its corner at distance 1;
// width w along the common direction, height h (Howell's catalogue, B-4).
TEST(PointToPolygon, BesideAPerpendicularRectangle) {
  for (const auto& [w, h] : {std::pair{1.0, 2.0}, {0.5, 0.3}, {8.0, 9.0}}) {
    const double slant = std::sqrt(1 + h * h);
    const double expected = (std::atan(w) - std::atan(w / slant) / slant) / (2 * std::numbers::pi);
    const auto wall = rectangle({0, 1, 0}, {static_cast<float>(w), 0, 0}, {0, 0, static_cast<float>(h)});
    EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, kUp, wall), expected, kRounding);
  }
}

TEST(PointToPolygon, WhatIsBelowTheHorizonDoesNotCount) {
  const auto above = rectangle({-1, 1, 0}, {2, 0, 0}, {0, 0, 1});
  const auto both = rectangle({-1, 1, -5}, {2, 0, 0}, {0, 0, 6});
  const auto below = rectangle({-1, 1, -5}, {2, 0, 0}, {0, 0, 4.5f});
  const double expected = point_to_polygon_form_factor({0, 0, 0}, kUp, above);
  EXPECT_GT(expected, 0.05);
  EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, kUp, both), expected, kRounding);
  EXPECT_EQ(point_to_polygon_form_factor({0, 0, 0}, kUp, below), 0);
}

TEST(PointToPolygon, ClippingMayLeaveATriangleOrAPentagon) {
  // A square on its corner, its centre at height z: cut below the middle it is a pentagon, above a triangle.
  for (const float z : {-0.5f, 0.5f}) {
    const std::vector<Vec3> diamond{{0, 2, z - 1}, {1, 2, z}, {0, 2, z + 1}, {-1, 2, z}};
    const std::vector<Vec3> triangle{{0.5f, 2, 0}, {0, 2, 0.5f}, {-0.5f, 2, 0}};
    const std::vector<Vec3> pentagon{{0.5f, 2, 0}, {1, 2, 0.5f}, {0, 2, 1.5f}, {-1, 2, 0.5f}, {-0.5f, 2, 0}};
    EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, kUp, diamond),
                point_to_polygon_form_factor({0, 0, 0}, kUp, z < 0 ? triangle : pentagon), kRounding);
  }
}

TEST(PointToPolygon, BothSidesAndTurnsOfThePolygonCountAlike) {
  auto square = rectangle({-1, -1, 1}, {2, 0, 0}, {0, 2, 0});
  const float factor = point_to_polygon_form_factor({0.3f, 0.1f, 0}, kUp, square);
  std::reverse(square.begin(), square.end());
  EXPECT_FLOAT_EQ(point_to_polygon_form_factor({0.3f, 0.1f, 0}, kUp, square), factor);
}

TEST(PointToPolygon, APointInThePlaneOfThePolygonSeesNothingOfIt) {
  const auto beside = rectangle({1, 1, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(point_to_polygon_form_factor({0, 0, 0}, kUp, beside), 0);
  EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, {1, 0, 0}, beside), 0, kRounding);
  EXPECT_TRUE(std::isfinite(point_to_polygon_form_factor({1, 1, 0}, {1, 0, 0}, beside)));  // on a corner
}

// Whatever the point and normal, the six faces of a box around it fill its view.
TEST(PointToPolygon, TheFacesOfABoxAroundThePointAddUpToOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-0.95f, 0.95f);
  for (int k = 0; k < 500; ++k) {
    const Vec3 point{uniform(random), uniform(random), uniform(random)};
    const Vec3 normal = normalized({uniform(random), uniform(random), uniform(random) + 1});
    double sum = 0;
    for (const float side : {-1.0f, 1.0f}) {
      sum += point_to_polygon_form_factor(point, normal, rectangle({side, -1, -1}, {0, 2, 0}, {0, 0, 2}));
      sum += point_to_polygon_form_factor(point, normal, rectangle({-1, side, -1}, {2, 0, 0}, {0, 0, 2}));
      sum += point_to_polygon_form_factor(point, normal, rectangle({-1, -1, side}, {2, 0, 0}, {0, 2, 0}));
    }
    ASSERT_NEAR(sum, 1, 4 * kRounding);
  }
}

TEST(PointToPolygon, AnOctagonIsTheSumOfItsTriangles) {
  std::vector<Vec3> octagon;
  for (int k = 0; k < 8; ++k) {
    const float angle = std::numbers::pi_v<float> * static_cast<float>(k) / 4;
    octagon.push_back({2 + std::cos(angle), std::sin(angle), 0.5f + std::sin(angle)});  // partly below
  }
  double sum = 0;
  for (int k = 1; k < 7; ++k)
    sum += point_to_polygon_form_factor({0, 0, 0}, kUp, std::array{octagon[0], octagon[k], octagon[k + 1]});
  EXPECT_NEAR(point_to_polygon_form_factor({0, 0, 0}, kUp, octagon), sum, 2 * kRounding);
}

/// Mean over a rectangle by the midpoint rule.
double mean_factor(Vec3 corner, Vec3 u, Vec3 v, Vec3 normal, const std::vector<Vec3>& to) {
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const float s = (static_cast<float>(i) + 0.5f) / kSteps, t = (static_cast<float>(j) + 0.5f) / kSteps;
      sum += point_to_polygon_form_factor(corner + s * u + t * v, normal, to);
    }
  return sum / (kSteps * kSteps);
}

// Between polygons: closed forms, to the 1 / 200^2 of the midpoint rule (its factor is the curvature, about
// 1).
TEST(PointToPolygon, ItsMeanOverARectangleIsTheFormFactorBetweenRectangles) {
  constexpr double kMidpoint = 1.0 / (200 * 200);
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  EXPECT_NEAR(mean_factor({}, x, y, z, rectangle(z, x, y)), 0.19982489569838746, kMidpoint);
  EXPECT_NEAR(mean_factor({}, x, y, z, rectangle({}, x, z)), 0.20004377607540316, kMidpoint);
  EXPECT_NEAR(mean_factor({}, 2 * x, y, z, rectangle(0.5f * z, 2 * x, y)), 0.5089886690414376, kMidpoint);
  EXPECT_NEAR(mean_factor({}, x, y, z, rectangle({}, x, 2 * z)), 0.2328526027953619, kMidpoint);
  EXPECT_NEAR(mean_factor({}, x, 2 * y, z, rectangle({}, x, 0.5f * z)), 0.07865027050598078, kMidpoint);
}

// 30 x 18 x 4 m. Cells are 0.15 m, a 27th of the height; the factor of the midpoint error grows with that.
TEST(PointToPolygon, FormFactorsOfTheGarage) {
  const double midpoint = 0.5 * std::pow(0.15 / 4, 2);
  const Vec3 x{30, 0, 0}, y{0, 18, 0}, z{0, 0, 4};
  const double ceiling = mean_factor({}, x, y, kUp, rectangle(z, x, y));
  const double long_wall = mean_factor({}, x, y, kUp, rectangle({}, x, z));
  const double short_wall = mean_factor({}, x, y, kUp, rectangle({}, y, z));
  EXPECT_NEAR(ceiling, 0.7173088414555596, midpoint);
  EXPECT_NEAR(long_wall, 0.08966181554560064, midpoint);
  EXPECT_NEAR(short_wall, 0.051683763726619515, midpoint);
  EXPECT_NEAR(ceiling + 2 * long_wall + 2 * short_wall, 1, kRounding);
}

// Lambert's formula is known to some 1e-7 of each corner's angle in either way of computing it.
TEST(PolygonOverPlane, AgreesWithPointsOneByOne) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto point = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  for (int scene = 0; scene < 200; ++scene) {
    const Vec3 origin = point(), s = normalized(point()), normal = normalized(cross(s, point()));
    const Vec3 t = cross(normal, s), u = point(), v = point();
    std::vector<Vec3> polygon = rectangle(origin + point(), u, v);
    if (scene % 3 == 0) polygon.pop_back();
    std::vector<float> x, y, z, factors(37);
    for (std::size_t k = 0; k < factors.size(); ++k) {
      const Vec3 at = origin + uniform(random) * s + uniform(random) * t;
      x.push_back(at.x), y.push_back(at.y), z.push_back(at.z);
    }
    const Vec3 front = normalized(cross(u, v));
    PolygonOverPlane(origin, normal, polygon, front)
        .form_factors({x.data(), y.data(), z.data(), x.size()}, factors.data());
    for (std::size_t k = 0; k < factors.size(); ++k) {
      const Vec3 at{x[k], y[k], z[k]};
      const bool behind = dot(front, at - polygon[0]) <= 0;
      const float expected = behind ? 0.0f : point_to_polygon_form_factor(at, normal, polygon);
      ASSERT_NEAR(factors[k], expected, 3e-6) << scene << " " << k;
    }
  }
}

// Panels that lie in a ceiling are in the plane of its patches, and a turned room rounds their corners to
// either side of it: nothing of them is seen, however often their outline seems to cross the plane.
TEST(PolygonOverPlane, WhatLiesInThePlaneGivesNothingHoweverItIsTurned) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const auto point = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  int seemed_to_cross_often = 0;
  for (int turn = 0; turn < 10'000; ++turn) {
    const Vec3 s = normalized(point()), normal = normalized(cross(s, point())), t = cross(normal, s);
    const Vec3 origin = 3.0f * normal;
    const std::vector<Vec3> panel = rectangle(origin + uniform(random) * s, 0.3f * s, 0.3f * t);
    int crossings = 0;
    for (std::size_t c = 0; c < 4; ++c)
      crossings += (dot(panel[c] - origin, normal) > 0) != (dot(panel[(c + 1) % 4] - origin, normal) > 0);
    seemed_to_cross_often += crossings > 2 ? 1 : 0;
    const Vec3 at = origin + 1.7f * t;
    float factor = 1;
    PolygonOverPlane(origin, normal, panel, -normal).form_factors({&at.x, &at.y, &at.z, 1}, &factor);
    ASSERT_LT(factor, 1e-5f) << turn;
    ASSERT_LT(point_to_polygon_form_factor(at, normal, panel), 1e-5f) << turn;
  }
  EXPECT_GT(seemed_to_cross_often, 20);
}

}  // namespace
}  // namespace engine
