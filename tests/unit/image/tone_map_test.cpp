#include "engine/image/tone_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/unit/image/rooms.h"

namespace {

using api::ToneMap;

TEST(Srgb, AgreesWithKnownValuesOfTheStandard) {
  EXPECT_EQ(engine::srgb_encode(0), 0);
  EXPECT_NEAR(engine::srgb_encode(1), 1, 1e-12);
  EXPECT_NEAR(255 * engine::srgb_encode(0.214041), 127.5, 0.01);  // half of the code values
  EXPECT_NEAR(engine::srgb_encode(0.0031308), 0.04045, 1e-6);     // where line and power meet
  EXPECT_NEAR(255 * engine::srgb_encode(0.18), 117.64, 0.02);
}

TEST(ToneCurve, KeepsMiddleGreyAndNeverFalls) {
  for (const ToneMap map : {ToneMap::clip, ToneMap::filmic}) {
    EXPECT_NEAR(engine::tone_curve(map, 0.18), 0.18, 1e-9);
    EXPECT_NEAR(engine::tone_curve(map, 0), 0, 1e-12);
    double before = 0;
    for (double x = 0; x < 20; x += 0.01) {
      const double y = engine::tone_curve(map, x);
      EXPECT_GE(y, before);
      EXPECT_LE(y, 1);
      before = y;
    }
    EXPECT_EQ(engine::tone_curve(map, 1e30), 1);
  }
}

TEST(ToneCurve, FilmicLeavesRoomAboveWhereClipIsWhite) {
  EXPECT_EQ(engine::tone_curve(ToneMap::clip, 1.0), 1);
  EXPECT_LT(engine::tone_curve(ToneMap::filmic, 1.0), 0.7);
  EXPECT_LT(engine::tone_curve(ToneMap::filmic, 3.0), 1.0);
}

TEST(DisplayTable, AgreesWithTheFormulaOnEveryOctave) {
  for (const ToneMap map : {ToneMap::clip, ToneMap::filmic})
    for (const double factor : {1.0, 0.37, 64.0}) {
      const engine::DisplayTable table(map, factor);
      for (double radiance = 1e-7; radiance < 1e6; radiance *= 1.013) {
        const auto x = static_cast<float>(radiance);
        const double exact = 255 * engine::srgb_encode(engine::tone_curve(map, factor * x));
        // Half a code value of rounding, and the table's own 1e-4 of full scale.
        EXPECT_NEAR(table(x), exact, 0.5 + 255e-4) << radiance;
      }
    }
}

TEST(DisplayTable, HasAnAnswerToEveryFloat) {
  const engine::DisplayTable table(ToneMap::filmic, std::exp2(32));
  EXPECT_EQ(table(0), 0);
  EXPECT_EQ(table(-1), 0);
  EXPECT_EQ(table(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(table(std::numeric_limits<float>::infinity()), 255);
  EXPECT_EQ(table(std::numeric_limits<float>::max()), 255);
  EXPECT_EQ(table(std::numeric_limits<float>::denorm_min()), 0);
}

TEST(DisplayTable, ShowsManyAsItShowsEach) {
  const engine::DisplayTable table(ToneMap::filmic, 0.7);
  std::vector<float> radiance{0,
                              -1,
                              -0.0f,
                              std::numeric_limits<float>::quiet_NaN(),
                              -std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::denorm_min()};
  for (float x = 1e-8f; x < 1e8f; x *= 1.0007f) radiance.insert(radiance.end(), {x, -x});
  std::vector<std::uint8_t> shown(radiance.size());
  table.show(radiance, shown.data());
  for (std::size_t k = 0; k < radiance.size(); ++k) ASSERT_EQ(shown[k], table(radiance[k])) << radiance[k];
}

// A wall of 3 m^2 with B = 2 and one of 1 m^2 with B = 6 W/m^2 mean 3; the lamp does not count.
TEST(AutoExposure, ShowsTheMeanOfWhatDoesNotEmitInMiddleGrey) {
  auto scene = tests::scene_with(1, 2);
  tests::add_polygon(scene, {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {0, 1, 0}});
  tests::add_polygon(scene, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  tests::add_polygon(scene, {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}}, 0, 1);
  const auto patches = engine::mesh_into_patches(scene, 0.5);
  ASSERT_TRUE(patches);
  auto animation = tests::still(scene, 2);
  animation.emission.exitance_w_m2[1] = {{0, 0, 0}, {500, 500, 500}};
  const auto radiosity = tests::series_of(*patches, 2, [](engine::PatchId, engine::Vec3 p) {
    const float b = p.z < 0.5f ? 2.0f : p.z < 1.5f ? 6.0f : 500.0f;
    return engine::Rgb{b, b, b};
  });
  const double factor = engine::auto_exposure_factor(*patches, animation, radiosity);
  EXPECT_NEAR(factor * 3 / std::numbers::pi, 0.18, 1e-6);
  EXPECT_EQ(engine::auto_exposure_factor(*patches, animation, engine::PatchSeries(patches->count(), 2)), 1);
}

}  // namespace
