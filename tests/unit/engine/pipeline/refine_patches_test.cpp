#include "engine/pipeline/refine_patches.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine/direct/direct_light.h"
#include "engine/visibility/ray_scene.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using tests::add_polygon;

constexpr float kLampHeight = 3, kCardHeight = 1, kLampHalf = 0.02f, kCardHalf = 0.25f;

/// A floor of 4 x 4 m below a small lamp at (2, 2), and a card between them about (x, y) of its object.
Scene floor_and_card(bool with_card = true) {
  Scene scene = tests::scene_with(2, 2);
  scene.materials[1].reflectance = {};
  add_polygon(scene, {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}});
  const float low = 2 - kLampHalf, high = 2 + kLampHalf, z = kLampHeight;
  add_polygon(scene, {{low, low, z}, {low, high, z}, {high, high, z}, {high, low, z}}, 0, 1);
  const float c = kCardHalf, h = kCardHeight;
  if (with_card) add_polygon(scene, {{-c, -c, h}, {c, -c, h}, {c, c, h}, {-c, c, h}}, 1, 1);
  return scene;
}

/// The card at `places`, one per frame.
Animation card_at(const Scene& scene, const std::vector<std::array<double, 2>>& places) {
  Animation animation = tests::still(scene, static_cast<FrameIndex>(places.size()));
  animation.emission.exitance_w_m2[1] = {{4000, 4000, 4000}};
  animation.objects[1].spans.clear();
  for (FrameIndex f = 0; f < places.size(); ++f)
    animation.objects[1].spans.push_back({f, f, tests::moved_to(places[f][0], places[f][1], 0)});
  return animation;
}

/// How far a point of the floor is from the edge of the card's shadow, the lamp taken as a point.
float distance_to_edge(Vec3 p, std::array<double, 2> card) {
  const float grow = kLampHeight / (kLampHeight - kCardHeight);
  const auto off = [&](float x, double place) {
    return std::abs(x - (2 + (static_cast<float>(place) - 2) * grow)) - kCardHalf * grow;
  };
  const float dx = off(p.x, card[0]), dy = off(p.y, card[1]);
  if (dx > 0 && dy > 0) return std::hypot(dx, dy);
  return std::abs(std::max(dx, dy));
}

api::LightingOptions options_with(double patch_edge_m) {
  api::LightingOptions options;
  options.patch_layout = api::PatchLayout::adaptive;
  options.patch_edge_m = patch_edge_m;
  return options;
}

RefinedPatches refine(const Scene& scene, const Animation& animation, std::uint64_t patch_count_max,
                      double patch_edge_m = 0.1) {
  auto refined = refine_patches(scene, animation, options_with(patch_edge_m), patch_count_max, {});
  EXPECT_TRUE(refined) << refined.error().message;
  return refined ? std::move(*refined) : RefinedPatches{};
}

bool is_on_floor(const Patches& patches, PatchId patch) {
  return patches.facets[patches.facet_of[patch]].polygon == 0;
}

// The edges are nowhere in line with the patches.
TEST(RefinePatches, TheEdgeOfAShadowIsFineInEveryFrameThatHasOne) {
  const Scene scene = floor_and_card();
  const std::vector<std::array<double, 2>> places{{1.511, 1.533}, {2.013, 1.987}, {2.521, 2.433}};
  const auto refined = refine(scene, card_at(scene, places), 100'000);
  const float smallest = 0.025f * 0.025f;
  int on_edge = 0, coarser = 0;
  for (PatchId patch = 0; patch < refined.patches.count(); ++patch) {
    if (!is_on_floor(refined.patches, patch)) continue;
    const Vec3 at = tests::centre_of(refined.patches, patch);
    const float area_m2 = refined.patches.area_m2[patch];
    float nearest = 100;
    for (const auto& place : places) nearest = std::min(nearest, distance_to_edge(at, place));
    // An edge that passes this near the middle of a patch passes through the patch. Where it cuts off less of
    // a cell's quarters than one sample stands for it can be missed; neighbours then see to one quartering.
    if (nearest < 0.3f * std::sqrt(area_m2)) {
      ++on_edge;
      coarser += area_m2 > 1.01f * smallest;
      EXPECT_LT(area_m2, 16.01f * smallest) << at.x << ' ' << at.y;
    }
    // The penumbra is 0.02 m wide: elsewhere the light is smooth, and no patch need be of the smallest.
    if (nearest > 0.4f) {
      EXPECT_GT(area_m2, 1.5f * smallest) << at.x << ' ' << at.y;
    }
  }
  EXPECT_GT(on_edge, 100);
  EXPECT_LT(coarser, on_edge / 10);
}

TEST(RefinePatches, PatchesAreNeverMoreThanAskedForAndNearlyAllAreUsed) {
  const Scene scene = floor_and_card();
  const Animation animation = card_at(scene, {{2.013, 1.987}});
  for (const std::uint64_t most : {450u, 550u, 700u}) {
    const auto refined = refine(scene, animation, most);
    EXPECT_LE(refined.patches.count(), most);
    EXPECT_GT(refined.patches.count(), most - most / 20);  // grading takes what it takes
  }
}

TEST(RefinePatches, WithoutLightNothingIsQuartered) {
  const Scene scene = floor_and_card();
  Animation animation = card_at(scene, {{2, 2}});
  animation.emission.exitance_w_m2[1] = {{}};
  const auto refined = refine(scene, animation, 100'000);
  EXPECT_EQ(refined.patches.count(), mesh_into_patches(scene, {0.1, api::PatchLayout::adaptive})->count());
}

TEST(RefinePatches, BlackSurfacesStayCoarse) {
  Scene scene = floor_and_card();
  scene.materials[0].reflectance = {};
  const auto refined = refine(scene, card_at(scene, {{2, 2}}), 100'000);
  EXPECT_EQ(refined.patches.count(), mesh_into_patches(scene, {0.1, api::PatchLayout::adaptive})->count());
}

TEST(RefinePatches, TheSameJobGivesTheSamePatches) {
  const Scene scene = floor_and_card();
  const Animation animation = card_at(scene, {{1.5, 1.5}, {2.5, 2}});
  const auto one = refine(scene, animation, 700), other = refine(scene, animation, 700);
  EXPECT_EQ(one.patches.area_m2, other.patches.area_m2);
  EXPECT_EQ(one.patches.facet_of, other.patches.facet_of);
}

TEST(RefinePatches, ACoarseMeshOfMoreThanAskedForIsRefused) {
  const Scene scene = floor_and_card();
  const auto refined = refine_patches(scene, card_at(scene, {{2, 2}}), options_with(0.1), 99, {});
  ASSERT_FALSE(refined);
  EXPECT_EQ(refined.error().fault, api::Fault::out_of_resources);
  ASSERT_EQ(refined.error().violations.size(), 1u);
  EXPECT_EQ(refined.error().violations[0].pointer, "/lighting/patch_count_max");
}

TEST(RefinePatches, AStopIsAnswered) {
  const Scene scene = floor_and_card();
  const Progress stopping{[](double) {}, [] { return true; }};
  const auto refined = refine_patches(scene, card_at(scene, {{2, 2}}), options_with(0.1), 1000, stopping);
  ASSERT_FALSE(refined);
  EXPECT_EQ(refined.error().fault, api::Fault::stopped);
}

/// Mean square difference between the direct light of patches and that of a mesh of 0.02 m, on the floor.
double mean_square_error(const Scene& scene, const Animation& animation, const Patches& patches) {
  const auto lit = [&](const Patches& of) {
    const StaticRays rays(of, animation);
    const FrameIndex frame = 0;
    return direct_light(of, animation, animation.emission, rays, std::span(&frame, 1), {16, 1, 5}, {})
        ->irradiance_w_m2;
  };
  const Patches fine = *mesh_into_patches(scene, 0.02);
  const PatchSeries exact = lit(fine), shown = lit(patches);
  double sum = 0;
  for (PatchId patch = 0; patch < fine.facets[0].cell_count(); ++patch) {
    const CellCorners corners = cell_corners(fine.facets[0], patch);
    const float u = 0.5f * (corners.u[0] + corners.u[2]), v = 0.5f * (corners.v[0] + corners.v[2]);
    const double difference = shown.at(patches.patch_at(0, u, v, true), 0).r - exact.at(patch, 0).r;
    sum += difference * difference;
  }
  return sum;
}

TEST(RefinePatches, AsManyPatchesShowTheLightBetterThanAUniformGrid) {
  const Scene scene = floor_and_card();
  const Animation animation = card_at(scene, {{2, 2}});
  const Patches uniform = *mesh_into_patches(scene, 0.1);
  const auto refined = refine(scene, animation, uniform.count());
  ASSERT_LE(refined.patches.count(), uniform.count());
  // A sharp edge: half the patch size is half the square error.
  EXPECT_LT(mean_square_error(scene, animation, refined.patches),
            0.6 * mean_square_error(scene, animation, uniform));
}

}  // namespace
}  // namespace engine
