#include "engine/image/motion_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/visibility/ray_scene.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

/// Of 3 objects the second and third move, made of triangles and parallelograms of all sizes about the
/// origin.
struct Movers {
  Scene scene = tests::scene_with(3, 1);
  Animation animation;
  Patches patches;

  explicit Movers(std::mt19937& random) {
    std::uniform_real_distribution<float> place(-1, 1);
    const auto point = [&] { return Vec3{place(random), place(random), place(random)}; };
    tests::add_polygon(scene, {{-9, -9, -9}, {9, -9, -9}, {9, 9, -9}, {-9, 9, -9}});
    for (std::uint32_t object = 1; object < 3; ++object)
      for (int k = 0; k < 4; ++k) {
        const float size = std::pow(0.3f, static_cast<float>(k));
        const Vec3 a = point(), u = size * point(), v = size * point();
        if (k % 2 == 0)
          tests::add_polygon(scene, {a, a + u, a + u + v, a + v}, object);
        else
          tests::add_polygon(scene, {a, a + u, a + v}, object);
      }
    animation = tests::still(scene, 2);
    for (std::uint32_t object = 1; object < 3; ++object)
      animation.objects[object].spans = {{0, 0, tests::moved_to(place(random), place(random), 0)}};
    patches = *mesh_into_patches(scene, 5);
  }
};

bool holds(const MotionRows& rows, std::uint32_t x, std::uint32_t y) {
  for (const PixelSpan span : rows[y])
    if (x >= span.x0 && x < span.x1) return true;
  return false;
}

// From outside, from among the facets (some are then behind the camera), and very near to them.
TEST(MotionRows, HoldEveryPixelThatSeesSomethingThatMoves) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> place(-1, 1);
  std::size_t met = 0, spared = 0;
  for (int round = 0; round < 60; ++round) {
    const Movers movers(random);
    const float away = round % 3 == 0 ? 4.0f : round % 3 == 1 ? 0.7f : 0.05f;
    const CameraPose pose{{away * place(random), away * place(random), away}, {0, 0, 0}, {0, 1, 0}, 70};
    const PinholeCamera camera = pinhole_camera(pose, 61, 40);
    const FrameIndex frame = 0;
    const MovingRays rays(movers.patches, movers.animation, std::span(&frame, 1));
    const MotionRows rows = rows_with_motion(movers.patches, movers.animation, frame, camera);
    ASSERT_EQ(rows.size(), 40u);
    for (std::uint32_t y = 0; y < 40; ++y)
      for (std::uint32_t x = 0; x < 61; ++x)
        for (const SubPixel sample : sub_pixels(4)) {
          SurfaceHit hit;
          const Ray ray =
              camera.ray_through(static_cast<float>(x) + sample.x, static_cast<float>(y) + sample.y);
          const bool meets = rays.nearest(ray, 0, hit);
          met += meets;
          spared += !holds(rows, x, y);
          ASSERT_TRUE(!meets || holds(rows, x, y)) << "round " << round << " pixel " << x << ' ' << y;
        }
  }
  EXPECT_GT(met, 20'000u);
  EXPECT_GT(spared, 100'000u);
}

TEST(MotionRows, SpansOfARowAreApartAndInOrder) {
  std::mt19937 random(5);
  for (int round = 0; round < 40; ++round) {
    const Movers movers(random);
    const PinholeCamera camera = pinhole_camera({{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 60}, 200, 100);
    for (const auto& row : rows_with_motion(movers.patches, movers.animation, 0, camera))
      for (std::size_t k = 0; k < row.size(); ++k) {
        EXPECT_LT(row[k].x0, row[k].x1);
        EXPECT_LE(row[k].x1, 200u);
        EXPECT_TRUE(k == 0 || row[k].x0 > row[k - 1].x1);
      }
  }
}

TEST(MotionRows, AreEmptyWhereNothingThatMovesIsThere) {
  std::mt19937 random(1);
  const Movers movers(random);
  const PinholeCamera camera = pinhole_camera({{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 60}, 20, 10);
  for (const auto& row : rows_with_motion(movers.patches, movers.animation, 1, camera))
    EXPECT_TRUE(row.empty());
}

}  // namespace
}  // namespace engine
