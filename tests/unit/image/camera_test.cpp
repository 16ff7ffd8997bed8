#include "engine/image/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using engine::Vec3;

// 90 degrees from top to bottom: at distance d the picture is 2 d high; 200 x 100 pixels, so 4 d wide.
engine::PinholeCamera along_x() {
  return engine::pinhole_camera({{1, 2, 3}, {5, 2, 3}, {0, 0, 1}, 90}, 200, 100);
}

TEST(PinholeCamera, ProjectsKnownPointsToKnownPixels) {
  const auto camera = along_x();
  const auto expect_at = [&](Vec3 point, float x_expected, float y_expected) {
    float x = 0, y = 0;
    ASSERT_TRUE(camera.project(point, x, y));
    EXPECT_NEAR(x, x_expected, 1e-3f);
    EXPECT_NEAR(y, y_expected, 1e-3f);
  };
  expect_at({3, 2, 3}, 100, 50);     // straight ahead: the centre
  expect_at({3, 2, 5}, 100, 0);      // 2 m ahead, 2 m up: the upper edge
  expect_at({3, -2, 3}, 200, 50);    // looking along x with z up, right is -y: 4 m to the right is the edge
  expect_at({11, -3, -2}, 125, 75);  // 10 m ahead, 5 m right, 5 m down
}

TEST(PinholeCamera, RaysGoThroughThePointsThatProjectToTheirPixel) {
  const auto camera = along_x();
  for (const float x : {0.f, 0.5f, 63.25f, 199.5f})
    for (const float y : {0.f, 11.75f, 99.5f}) {
      const engine::Ray ray = camera.ray_through(x, y);
      float back_x = 0, back_y = 0;
      ASSERT_TRUE(camera.project(ray.origin + 7 * ray.direction, back_x, back_y));
      EXPECT_NEAR(back_x, x, 1e-3f);
      EXPECT_NEAR(back_y, y, 1e-3f);
    }
}

TEST(PinholeCamera, DoesNotProjectWhatIsBehindIt) {
  float x, y;
  EXPECT_FALSE(along_x().project({-1, 2, 3}, x, y));
  EXPECT_FALSE(along_x().project({1, 5, 3}, x, y)) << "in the plane of the pin-hole";
}

TEST(PinholeCamera, LooksStraightDownWithoutLosingItsPicture) {
  const auto camera = engine::pinhole_camera({{0, 0, 5}, {0, 0, 0}, {0, 0, 1}, 60}, 64, 48);
  EXPECT_NEAR(length(camera.upward), std::tan(3.14159265 / 6), 1e-5);
  EXPECT_NEAR(dot(camera.upward, camera.forward), 0, 1e-6);
  EXPECT_NEAR(length(camera.right) / length(camera.upward), 64.0 / 48, 1e-5);
}

TEST(PixelsAround, HoldsEveryPixelOfABoxAndNotMuchMore) {
  const std::vector<Vec3> points{{11, -3, -2}, {11, -1, 0}};  // 125, 75 and 115, 65
  const auto rect = engine::pixels_around(along_x(), points);
  EXPECT_TRUE(rect.contains(115, 65) && rect.contains(124, 74));
  EXPECT_LE(rect.x1 - rect.x0, 14u);
  EXPECT_LE(rect.y1 - rect.y0, 14u);
}

TEST(PixelsAround, IsEmptyBesideTheImageAndWholeAroundTheCamera) {
  const auto outside = engine::pixels_around(along_x(), std::vector<Vec3>{{2, 100, 3}, {2, 90, 4}});
  EXPECT_EQ(outside.x0, outside.x1);
  const auto around = engine::pixels_around(along_x(), std::vector<Vec3>{{3, 2, 3}, {0, 2, 3}});
  EXPECT_EQ(around.x1, 200u);
  EXPECT_EQ(around.y1, 100u);
}

TEST(SubPixels, FourOfThemLieInFourColumnsAndFourRows) {
  bool column[4] = {}, row[4] = {};
  for (const auto& p : engine::sub_pixels(4)) {
    column[static_cast<int>(p.x * 4)] = true;
    row[static_cast<int>(p.y * 4)] = true;
  }
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(column[i] && row[i]) << i;
  EXPECT_EQ(engine::sub_pixels(1)[0].x, 0.5f);
  EXPECT_EQ(engine::sub_pixels(1)[0].y, 0.5f);
}

}  // namespace
