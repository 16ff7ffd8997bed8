// The furnace: where everything emits and reflects alike, every patch has B = E / (1 - rho), whatever closed
// things move or appear inside.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;
using engine::Rgb;

constexpr FrameIndex kFrames = 12;
constexpr Rgb kReflectance{0.5f, 0.3f, 0.1f};
constexpr Rgb kExitance{1.0f, 1.0f, 1.0f};
constexpr Rgb kExact{1.0f / (1.0f - 0.5f), 1.0f / (1.0f - 0.3f), 1.0f / (1.0f - 0.1f)};

/// A room with a box at rest, one that moves, one that turns as it moves, and one that is there in some
/// frames only. They never touch.
SceneBuilder furnace() {
  SceneBuilder built(kFrames);
  const auto paint = built.add_material(kReflectance, kExitance);
  built.add_box({0, 0, 0}, {4, 3, 2.5f}, true, paint);
  built.add_box({0.3f, 0.3f, 0.2f}, {0.9f, 1.1f, 0.7f}, false, paint);
  engine::ObjectMotion gliding, turning;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    gliding.spans.push_back({f, f, turned_and_moved(0, 1.4 + 0.15 * f, 2.2, 1.9)});
    turning.spans.push_back({f, f, turned_and_moved(0.23 * f, 1.7 + 0.1 * f, 1.0, 0.6)});
  }
  const auto glider = built.add_object(gliding), turner = built.add_object(turning);
  const auto guest = built.add_object({{{3, 4, {}}, {8, 9, {}}}});
  built.add_box({-0.3f, -0.2f, -0.25f}, {0.3f, 0.2f, 0.25f}, false, paint, glider);
  built.add_box({-0.35f, -0.3f, -0.3f}, {0.35f, 0.3f, 0.3f}, false, paint, turner);
  built.add_box({0.4f, 1.6f, 0.5f}, {0.8f, 2.0f, 1.3f}, false, paint, guest);
  return built;
}

bool is_there(const ReadyScene& ready, PatchId patch, FrameIndex frame) {
  for (const auto& span :
       ready.animation.objects[ready.patches.facets[ready.patches.facet_of[patch]].object].spans)
    if (span.first <= frame && frame <= span.last) return true;
  return false;
}

double largest_relative_error(Rgb value, Rgb exact) {
  return std::max({std::abs(double{value.r} / exact.r - 1), std::abs(double{value.g} / exact.g - 1),
                   std::abs(double{value.b} / exact.b - 1)});
}

/// Largest error of all patches and frames where all light travels by lines; 0 where a patch is not there.
double worst_error(const ReadyScene& ready, const api::LightingOptions& options) {
  const LitFrames lit = light_frames(ready, every_frame(ready.animation), options);
  double worst = 0;
  for (PatchId patch = 0; patch < ready.patches.count(); ++patch)
    for (FrameIndex f = 0; f < ready.animation.frame_count; ++f) {
      const Rgb found = lit.radiosity.at(patch, f);
      if (is_there(ready, patch, f))
        worst = std::max(worst, largest_relative_error(found, kExact));
      else
        EXPECT_EQ(found, Rgb{}) << "patch " << patch << " is not there in frame " << f;
    }
  return worst;
}

using Outline = std::vector<std::array<float, 2>>;

/// Walls over a counter-clockwise outline between two heights, ceiling and, unless it is given elsewhere,
/// floor one polygon each.
void add_prism(SceneBuilder& built, const Outline& outline, float low, float high, bool inward,
               std::uint32_t material, std::uint32_t object = 0, bool with_floor = true) {
  const auto add = [&](std::vector<engine::Vec3> corners) {
    if (inward) std::reverse(corners.begin(), corners.end());
    built.add_polygon(corners, material, object);
  };
  std::vector<engine::Vec3> bottom, top;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto [ax, ay] = outline[k];
    const auto [bx, by] = outline[(k + 1) % outline.size()];
    add({{ax, ay, low}, {bx, by, low}, {bx, by, high}, {ax, ay, high}});
    top.push_back({ax, ay, high});
    bottom.insert(bottom.begin(), {ax, ay, low});
  }
  if (with_floor) add(bottom);
  add(top);
}

/// An L-shaped room whose floor is of four polygons that meet edge to edge and corner to edge; in it a star
/// that turns, a block of bent faces, boxes a millimetre apart, and one that comes down on them as near.
/// (Where fronts lie on each other without a gap, what is between them is dark and not part of a furnace.)
SceneBuilder furnace_of_shapes() {
  SceneBuilder built(kFrames);
  const auto paint = built.add_material(kReflectance, kExitance);
  add_prism(built, {{0, 0}, {5, 0}, {5, 2}, {2, 2}, {2, 4}, {0, 4}}, 0, 2.5f, true, paint, 0, false);
  built.add_polygon({{0, 0, 0}, {3.1f, 0, 0}, {3.1f, 1.3f, 0}, {0, 1.3f, 0}}, paint);
  built.add_polygon({{3.1f, 0, 0}, {5, 0, 0}, {5, 2, 0}, {3.1f, 2, 0}}, paint);
  built.add_polygon({{0, 1.3f, 0}, {3.1f, 1.3f, 0}, {3.1f, 2, 0}, {1.2f, 2, 0}, {1.2f, 4, 0}, {0, 4, 0}},
                    paint);
  built.add_polygon({{1.2f, 2, 0}, {2, 2, 0}, {2, 4, 0}, {1.2f, 4, 0}}, paint);
  engine::ObjectMotion turning, landing;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    turning.spans.push_back({f, f, turned_and_moved(0.3 * f, 0.9 + 0.02 * f, 3.1, 0.9)});
    landing.spans.push_back({f, f, turned_and_moved(0, 0, 0, 0.1 * (kFrames - 1 - f))});
  }
  const auto turner = built.add_object(turning), lander = built.add_object(landing);
  Outline star;
  for (int k = 0; k < 10; ++k) {
    const double angle = k * 0.62831853, radius = k % 2 ? 0.2 : 0.5;
    star.push_back(
        {static_cast<float>(radius * std::cos(angle)), static_cast<float>(radius * std::sin(angle))});
  }
  add_prism(built, star, -0.3f, 0.3f, false, paint, turner);

  const engine::Vec3 low{0.5f, 0.5f, 0.4f};  // of a block whose corners are pulled about
  const auto corner = [&](int c, float x, float y, float z) {
    return low + engine::Vec3{(c & 1 ? 0.8f : 0) + x, (c & 2 ? 0.7f : 0) + y, (c & 4 ? 0.6f : 0) + z};
  };
  const std::array<engine::Vec3, 8> c{
      corner(0, 0, 0, 0.1f),     corner(1, 0.1f, 0, 0),  corner(2, 0, 0.1f, 0), corner(3, 0, 0, -0.1f),
      corner(4, -0.1f, 0, 0.1f), corner(5, 0, -0.1f, 0), corner(6, 0, 0, 0.2f), corner(7, 0.1f, 0.1f, 0)};
  for (const auto& face : std::array<std::array<std::size_t, 4>, 6>{
           {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}})
    built.add_polygon({c[face[0]], c[face[1]], c[face[2]], c[face[3]]}, paint);

  built.add_box({2.5f, 0.5f, 0.001f}, {3, 1.5f, 0.5f}, false, paint);
  built.add_box({3.001f, 0.5f, 0.001f}, {3.5f, 1.5f, 0.5f}, false, paint);
  built.add_box({2.75f, 0.75f, 0.501f}, {3.25f, 1.25f, 1}, false, paint);
  built.add_box({2.75f, 0.75f, 1.001f}, {3.25f, 1.25f, 1.2f}, false, paint, lander);
  return built;
}

}  // namespace

// No chance in it: rows are divided by their actual crossings, so each row of the operator sums to one and B
// is exact for any lines. What is left is the iteration, which stops when a step is below 1e-5 of E and so
// within 1e-5 rho of B (half of the tolerance), and the rounding of sums in single precision (the other
// half). One lost hit would show: rows have hundreds of crossings, so a single one is over 1e-4.
TEST(Furnace, EveryPatchAndFrameIsExactWhenAllLightTravelsByLines) {
  const ReadyScene ready(furnace(), 0.5);
  api::LightingOptions options;
  options.direct = api::DirectLight::pure;
  options.line_count = 200'000;
  for (const std::uint64_t seed : {1, 2, 3}) {
    options.seed = seed;
    EXPECT_LT(worst_error(ready, options), 1e-5) << "seed " << seed;
  }
}

// The same of polygons with corners that point inwards, of faces that are not flat and become two triangles
// each, of faces in one plane that touch, and of such as nearly touch.
TEST(Furnace, IsExactWhateverTheShapesOfItsPolygonsAndHowTheyMeet) {
  const ReadyScene ready(furnace_of_shapes(), 0.5);
  api::LightingOptions options;
  options.direct = api::DirectLight::pure;
  options.line_count = 200'000;
  EXPECT_LT(worst_error(ready, options), 1e-5);
}

// Direct light is sampled: each patch is within chance of the exact value, and so is the mean of those at
// rest and of those that move. One false alarm in 10,000 choices of seeds, over the red (the
// highest reflectance) of all patches in two frames.
TEST(Furnace, IsExactInTheMeanWhenDirectLightIsApart) {
  const ReadyScene ready(furnace(), 0.5);
  const std::vector<FrameIndex> frames{4, 8};  // all boxes are there
  std::vector<PatchId> resting, moving;
  for (PatchId p = 0; p < ready.patches.count(); ++p) (ready.moves(p) ? moving : resting).push_back(p);
  Sample of_resting[2], of_moving[2];
  std::vector<Sample> of_patch(2 * ready.patches.count());
  api::LightingOptions options;
  options.line_count = 100'000;
  options.samples_per_light = 32;
  for (options.seed = 1; options.seed <= 24; ++options.seed) {
    const LitFrames lit = light_frames(ready, frames, options);
    for (std::uint32_t k = 0; k < 2; ++k) {
      of_resting[k].add(mean_over(ready, lit.radiosity, resting, k).r);
      of_moving[k].add(mean_over(ready, lit.radiosity, moving, k).r);
      for (PatchId p = 0; p < ready.patches.count(); ++p) of_patch[2 * p + k].add(lit.radiosity.at(p, k).r);
    }
  }
  const double false_alarm = 1e-4 / static_cast<double>(of_patch.size() + 4);
  constexpr double kIteration = 1e-5;  // where it stops, as above
  for (std::uint32_t k = 0; k < 2; ++k) {
    EXPECT_TRUE(agrees(of_resting[k], 2.0, false_alarm, kIteration));
    EXPECT_TRUE(agrees(of_moving[k], 2.0, false_alarm, kIteration));
    EXPECT_LT(of_resting[k].standard_error(), 1e-3);
    EXPECT_LT(of_moving[k].standard_error(), 1e-3);
  }
  for (std::size_t k = 0; k < of_patch.size(); ++k)
    EXPECT_TRUE(agrees(of_patch[k], 2.0, false_alarm, kIteration))
        << "patch " << k / 2 << ", frame " << frames[k % 2];
}

// Of the power that is emitted in a closed scene of one reflectance each bounce leaves rho: the mean of B
// over the area is that of E over 1 - rho, whatever emits and however it is cut. Rows divided by actual
// crossings balance in the mean only, hence the t-test; 3 cuts x 2 ways of the first light share a false
// alarm of 1e-4.
TEST(ClosedScene, HasTheMeanExitanceOverOneMinusReflectanceHoweverItIsCut) {
  constexpr float kRho = 0.6f;
  SceneBuilder built;
  const auto wall = built.add_material({kRho, kRho, kRho}),
             lamp = built.add_material({kRho, kRho, kRho}, {1, 1, 1});
  built.add_box({0, 0, 0}, {3, 2, 2.5f}, true, {wall, lamp, wall, wall, wall, wall});
  built.add_box({0.5f, 0.5f, 0.3f}, {1.2f, 1.1f, 1}, false, {wall, wall, wall, wall, wall, lamp});
  for (const double patch_edge_m : {3.0, 0.8, 0.35}) {
    const ReadyScene ready(built, patch_edge_m);
    std::vector<PatchId> all(ready.patches.count());
    std::iota(all.begin(), all.end(), 0u);
    const double area = 2 * (3 * 2 + 3 * 2.5 + 2 * 2.5) + 2 * (0.7 * 0.6 + 0.7 * 0.7 + 0.6 * 0.7);
    const double exact = (2 * 2.5 + 0.7 * 0.6) / area / (1 - double{kRho});
    for (const auto direct : {api::DirectLight::apart, api::DirectLight::pure}) {
      api::LightingOptions options;
      options.direct = direct;
      options.line_count = 65'536;
      options.samples_per_light = 256;  // a face of one patch has no others to make up for it
      Sample mean;
      for (options.seed = 1; options.seed <= 16; ++options.seed)
        mean.add(mean_over(ready, light_frames(ready, {0}, options).radiosity, all, 0).r);
      EXPECT_TRUE(agrees(mean, exact, 1e-4 / 6, 2e-5)) << patch_edge_m;
      EXPECT_LT(mean.standard_error(), 2e-3 * exact);
    }
  }
}

}  // namespace tests
