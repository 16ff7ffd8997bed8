#include "engine/patches/ear_clipping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace engine {
namespace {

/// Triangles of the right number, all turning as the polygon, that cover its area.
void expect_triangulates(const std::vector<Vec3>& corners, double area_m2) {
  const Vec3 whole = area_vector(corners);
  ASSERT_NEAR(length(whole), area_m2, 1e-5 * area_m2);
  const auto triangles = clip_ears(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  double sum = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 doubled = cross(corners[b] - corners[a], corners[c] - corners[a]);
    EXPECT_GE(dot(doubled, whole), 0) << a << ' ' << b << ' ' << c;
    sum += 0.5 * length(doubled);
    for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) ++edges[{from, to}];
  }
  EXPECT_NEAR(sum, area_m2, 1e-5 * area_m2);  // together with the number: no overlap
  for (std::uint32_t k = 0; k < corners.size(); ++k) {
    const std::uint32_t next = (k + 1) % static_cast<std::uint32_t>(corners.size());
    EXPECT_EQ((edges[{k, next}]), 1) << "edge " << k << " of the polygon";
  }
}

TEST(ClipEars, ATriangleIsItself) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(clip_ears(corners), (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
}

TEST(ClipEars, ConvexPolygons) {
  for (const int n : {4, 5, 12, 64}) {
    std::vector<Vec3> corners;
    for (int k = 0; k < n; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / static_cast<float>(n);
      corners.push_back({std::cos(angle), 5, -std::sin(angle)});
    }
    expect_triangulates(corners, 0.5 * n * std::sin(2 * std::numbers::pi / n));
  }
}

TEST(ClipEars, ConcavePolygonsFromEveryFirstCorner) {
  const std::vector<std::pair<std::vector<Vec3>, double>> cases{
      {{{0, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}, {1, 2, 1}, {0, 2, 1}}, 3.0},  // L
      {{{0, 0, 0}, {4, 1, 0}, {0, 2, 0}, {1, 1, 0}}, 3.0},                        // dart
      {{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}, 7.0},  // U
  };
  for (const auto& [corners, area] : cases)
    for (std::size_t first = 0; first < corners.size(); ++first) {
      std::vector<Vec3> turned(corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
      turned.insert(turned.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first));
      expect_triangulates(turned, area);
    }
}

TEST(ClipEars, AStarOfManyPoints) {
  std::vector<Vec3> corners;
  constexpr int kPoints = 16;
  for (int k = 0; k < 2 * kPoints; ++k) {
    const double angle = std::numbers::pi * k / kPoints, radius = k % 2 == 0 ? 2.0 : 0.5;
    corners.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle)), -3});
  }
  expect_triangulates(corners, kPoints * 2.0 * 0.5 * std::sin(std::numbers::pi / kPoints));
}

TEST(ClipEars, AClockwisePolygonSeenFromAboveKeepsItsTurn) {
  const std::vector<Vec3> corners{{0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0, 0}, {0, 0, 0}};
  EXPECT_LT(area_vector(corners).z, 0);
  expect_triangulates(corners, 3.0);
}

TEST(ClipEars, ACrossedPolygonIsFannedRatherThanNeverFinished) {
  const std::vector<Vec3> bow_tie{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  EXPECT_EQ(clip_ears(bow_tie).size(), 2u);
  const std::vector<Vec3> in_a_row{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}};
  EXPECT_EQ(clip_ears(in_a_row).size(), 3u);
}

}  // namespace
}  // namespace engine
