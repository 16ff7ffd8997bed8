// Form factors counted from global lines, n_ij / n_i, against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "engine/lines/trace_lines.h"
#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

using engine::Vec3;

constexpr std::uint64_t kSeeds = 24;
constexpr std::uint64_t kLines = 1 << 16;

/// One false alarm in 10,000 choices of seeds over the 12 comparisons of this file. A count conditional on
/// the crossings is binomial, so its mean over seeds is nearly normal, and unbiased.
constexpr double kFalseAlarm = 1e-4 / 12;

std::uint64_t lines_between(const engine::TracedLines& traced, engine::PatchId from, engine::PatchId to) {
  std::uint64_t count = 0;
  for (const engine::Exchange exchange : traced.static_rows.row(from))
    if (exchange.sender() == to) count += exchange.count();
  return count;
}

/// F from polygon `from` to the polygons `to`, by kSeeds independent sets of lines.
Sample counted_form_factor(const SceneBuilder& built, std::uint32_t from,
                           const std::vector<std::uint32_t>& to) {
  const ReadyScene ready(built, 1e4);  // patches as large as can be
  const std::vector<engine::FrameIndex> frames{0};
  Sample factor;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto traced =
        engine::trace_lines(ready.patches, ready.animation, ready.static_rays, frames, {kLines, seed}, {});
    std::uint64_t crossings = 0, exchanges = 0;
    for (const engine::PatchId receiver : ready.patches_of_polygon(from)) {
      crossings += traced->crossings.at(receiver, 0);
      for (const std::uint32_t polygon : to)
        for (const engine::PatchId sender : ready.patches_of_polygon(polygon))
          exchanges += lines_between(*traced, receiver, sender);
    }
    factor.add(static_cast<double>(exchanges) / static_cast<double>(crossings));
  }
  return factor;
}

/// The t-test, and that it is sharp: it sees an error of half a per cent (of two where the factor is small).
void expect_form_factor(const Sample& counted, double exact) {
  EXPECT_TRUE(agrees(counted, exact, kFalseAlarm));
  EXPECT_LT(counted.standard_error(), exact * (exact > 0.1 ? 1e-3 : 4e-3));
}

SceneBuilder room(Vec3 size) {
  SceneBuilder built;
  built.add_box({0, 0, 0}, size, true, built.add_material({}));
  return built;
}

/// Two rectangles face to face at distance c.
SceneBuilder parallel_rectangles(float a, float b, float c) {
  SceneBuilder built;
  const auto paint = built.add_material({});
  built.add_polygon({{0, 0, 0}, {a, 0, 0}, {a, b, 0}, {0, b, 0}}, paint);
  built.add_polygon({{0, 0, c}, {0, b, c}, {a, b, c}, {a, 0, c}}, paint);
  return built;
}

/// Two rectangles at a right angle on a common edge of length 1: w wide on the floor, h high on the wall.
SceneBuilder perpendicular_rectangles(float w, float h) {
  SceneBuilder built;
  const auto paint = built.add_material({});
  built.add_polygon({{0, 0, 0}, {w, 0, 0}, {w, 1, 0}, {0, 1, 0}}, paint);
  built.add_polygon({{0, 0, 0}, {0, 1, 0}, {0, 1, h}, {0, 0, h}}, paint);
  return built;
}

/// A regular polygon about the z axis, counter-clockwise seen from above.
std::vector<Vec3> regular_polygon(int corners, double radius, double height) {
  std::vector<Vec3> polygon;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    polygon.push_back({static_cast<float>(radius * std::cos(angle)),
                       static_cast<float>(radius * std::sin(angle)), static_cast<float>(height)});
  }
  return polygon;
}

double area_of(const std::vector<Vec3>& polygon) {
  double doubled = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    doubled += double{a.x} * b.y - double{b.x} * a.y;
  }
  return std::abs(doubled) / 2;
}

/// Form factor from polygon `a` to polygon `b`, both horizontal and not touching, as an integral over both
/// outlines (Stokes):  F = 1 / (2 pi A) |oint oint ln r dr_a . dr_b|, with 5 points of Gauss per edge. Shares
/// nothing with the engine.
double form_factor_by_outlines(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  constexpr std::array<double, 5> kAt{0.04691007703066800, 0.23076534494715845, 0.5, 0.76923465505284155,
                                      0.95308992296933200};
  constexpr std::array<double, 5> kWeight{0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                          0.23931433524968324, 0.11846344252809454};
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec3 edge_a = a[(i + 1) % a.size()] - a[i], edge_b = b[(j + 1) % b.size()] - b[j];
      double logarithm = 0;
      for (std::size_t s = 0; s < 5; ++s)
        for (std::size_t t = 0; t < 5; ++t) {
          const double x = double{a[i].x} + kAt[s] * edge_a.x - b[j].x - kAt[t] * edge_b.x;
          const double y = double{a[i].y} + kAt[s] * edge_a.y - b[j].y - kAt[t] * edge_b.y;
          const double z = double{a[i].z} - b[j].z;
          logarithm += kWeight[s] * kWeight[t] * 0.5 * std::log(x * x + y * y + z * z);
        }
      sum += logarithm * (double{edge_a.x} * edge_b.x + double{edge_a.y} * edge_b.y);
    }
  return std::abs(sum) / (2 * std::numbers::pi * area_of(a));
}

constexpr double kEqualDiscs = 0.3819660112501051;     // r1 = r2 = h
constexpr double kUnequalDiscs = 0.04805898398896202;  // from r1 = 1 to r2 = .5 at distance 2

/// From a 24-gon of radius 1 on the floor to one of radius `radius` at `height` that looks down.
void expect_disc_form_factor(double radius, double height) {
  const auto low = regular_polygon(24, 1, 0), high = regular_polygon(24, radius, height);
  SceneBuilder built;
  const auto paint = built.add_material({});
  built.add_polygon(low, paint);
  built.add_polygon({high.rbegin(), high.rend()}, paint);
  expect_form_factor(counted_form_factor(built, 0, {1}), form_factor_by_outlines(low, high));
}

}  // namespace

// Closed forms: Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11 (parallel), C-14
// (perpendicular), C-41 (discs).

TEST(FormFactors, OfACube) {
  const SceneBuilder cube = room({1, 1, 1});  // faces -x, +x, -y, +y, -z, +z
  expect_form_factor(counted_form_factor(cube, 4, {5}), 0.19982489569838746);
  expect_form_factor(counted_form_factor(cube, 4, {0}), 0.20004377607540316);
  expect_form_factor(counted_form_factor(cube, 0, {3}), 0.20004377607540316);
}

TEST(FormFactors, OfParallelRectangles) {
  expect_form_factor(counted_form_factor(parallel_rectangles(2, 1, 0.5f), 0, {1}), 0.5089886690414376);
}

TEST(FormFactors, OfPerpendicularRectangles) {
  expect_form_factor(counted_form_factor(perpendicular_rectangles(1, 2), 0, {1}), 0.2328526027953619);
  expect_form_factor(counted_form_factor(perpendicular_rectangles(2, 0.5f), 0, {1}), 0.07865027050598078);
}

TEST(FormFactors, OfTheGarage) {
  const SceneBuilder garage = room({30, 18, 4});
  expect_form_factor(counted_form_factor(garage, 4, {5}), 0.7173088414555596);
  expect_form_factor(counted_form_factor(garage, 4, {2}), 0.08966181554560064);
  expect_form_factor(counted_form_factor(garage, 4, {0}), 0.051683763726619515);
  expect_form_factor(counted_form_factor(garage, 4, {0, 1, 2, 3, 5}), 1.0);
}

// The yardstick of the discs: within 1e-9 of the cube's closed form (Gauss's rule on smooth edges), and, for
// polygons of 1,024 corners, of the discs' own, to which they converge as 1 / corners^2 (7e-6 here).
TEST(FormFactors, TheIntegralOverOutlinesIsRight) {
  const auto square = regular_polygon(4, std::numbers::sqrt2 / 2, 0);
  const auto above = regular_polygon(4, std::numbers::sqrt2 / 2, 1);
  EXPECT_NEAR(form_factor_by_outlines(square, above), 0.19982489569838746, 1e-6);
  const auto disc = regular_polygon(1024, 1, 0);
  EXPECT_NEAR(form_factor_by_outlines(disc, regular_polygon(1024, 1, 1)), kEqualDiscs, 2e-5);
  EXPECT_NEAR(form_factor_by_outlines(disc, regular_polygon(1024, 0.5, 2)), kUnequalDiscs, 2e-5);
}

TEST(FormFactors, OfCoaxialDiscsAsPolygonsOf24Corners) {
  expect_disc_form_factor(1, 1);
  expect_disc_form_factor(0.5, 2);
}

}  // namespace tests
