#include "engine/image/textured_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "tests/unit/image/one_frame.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using Pixel = std::array<std::uint8_t, 3>;
constexpr float kPi = std::numbers::pi_v<float>;
const auto never = [] { return false; };

/// 2 x 2 squares of two colours, each of 16 x 16 pixels, so that inside a square nothing is mixed.
Texture checkerboard(Pixel one, Pixel other) {
  Texture texture{32, 32, {}};
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) texture.srgb.push_back((x < 16) == (y < 16) ? one : other);
  return texture;
}

/// A wall, 4 m x 4 m at z = 0, that faces a camera and shows a texture `turns` times each way.
struct Wall {
  Scene scene = tests::scene_with(1, 1);
  Animation animation;
  Patches patches;

  Wall(Texture texture, float turns, double patch_edge_m) {
    scene.textures.push_back(std::move(texture));
    scene.materials[0].texture = 0;
    tests::add_polygon(scene, {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}});
    scene.uvs = {{0, 0}, {turns, 0}, {turns, turns}, {0, turns}};
    scene.corner_uvs = {0, 1, 2, 3};
    animation = tests::still(scene, 1);
    patches = *mesh_into_patches(scene, patch_edge_m);
    patches.texture_reflectance = texture_reflectance(scene, animation, patches);
  }

  /// B = E + rho H, as a solve leaves it.
  PatchSeries lit_by(const std::function<Rgb(Vec3)>& irradiance_w_m2) const {
    return tests::series_of(patches, 1, [&](PatchId patch, Vec3 at) {
      return animation.emission.exitance(0, 0) + patches.texture_reflectance[patch] * irradiance_w_m2(at);
    });
  }

  /// 160 x 160 pixels from `pose`, one sample each.
  Image seen(const PatchSeries& radiosity, const CameraPose& pose, std::uint32_t samples = 1) const {
    const StaticRays rays(patches, animation);
    const ShadingMesh mesh = build_shading_mesh(patches);
    const auto textures = make_textured_view(scene, animation, patches, mesh);
    std::vector<std::vector<Rgb>> nodes(1);
    if (textures)
      EXPECT_TRUE(textured_node_values(*textures, {}, radiosity, 0, every_frame(animation), never, nodes));
    else
      EXPECT_TRUE(node_radiosity(mesh, patches, radiosity, 0, never, nodes));
    const FrameIndex frame = 0;
    const MovingRays moving(patches, animation, std::span(&frame, 1));
    const ShadedScene stage{patches, mesh, rays, textures.get()};
    const PinholeCamera camera = pinhole_camera(pose, 160, 160);
    return tests::one_frame(stage, {camera, moving, 0, whole_rows(camera), 0}, nodes[0], samples);
  }
};

/// Sees x, y in [-1.6, 1.6] at z = 0: 50 pixels per metre.
const CameraPose kInFront{{0, 0, 1.6f}, {0, 0, 0}, {0, 1, 0}, 90};

/// Where a pixel of that picture is on the wall.
Vec3 on_wall(std::uint32_t x, std::uint32_t y) {
  return {(static_cast<float>(x) + 0.5f - 80) / 50, (80 - static_cast<float>(y) - 0.5f) / 50, 0};
}

/// The colour of a checkerboard there, or none within a pixel of where colours meet. A turn is 4 m / turns.
std::optional<Rgb> colour_at(const Texture& texture, Vec3 at, float turns) {
  const auto square = [&](float coordinate) {
    const float squares = (coordinate + 2) / 4 * turns * 2;
    const float rest = squares - std::floor(squares);
    return rest < 0.08f || rest > 0.92f ? -1 : static_cast<int>(std::floor(squares));
  };
  const int x = square(at.x), y = square(at.y);
  if (x < 0 || y < 0) return {};
  const Rgb rho =
      texel(texture, (x + y) % 2 == 0 ? 0 : 31, 31);  // the lower left square is like the upper right
  return Rgb{std::min(rho.r, kTexelMax), std::min(rho.g, kTexelMax), std::min(rho.b, kTexelMax)};
}

/// The number of pixels compared.
int expect_colours(const Wall& wall, const Image& image, float turns,
                   const std::function<Rgb(Vec3)>& irradiance, float tolerance) {
  int compared = 0;
  for (std::uint32_t y = 0; y < 160; ++y)
    for (std::uint32_t x = 0; x < 160; ++x)
      if (const auto rho = colour_at(wall.scene.textures[0], on_wall(x, y), turns)) {
        const Rgb expected =
            (wall.animation.emission.exitance(0, 0) + *rho * irradiance(on_wall(x, y))) * (1 / kPi);
        EXPECT_NEAR(image.at(x, y).r, expected.r, tolerance * expected.r) << x << ' ' << y;
        EXPECT_NEAR(image.at(x, y).g, expected.g, tolerance * expected.g) << x << ' ' << y;
        EXPECT_NEAR(image.at(x, y).b, expected.b, tolerance * expected.b) << x << ' ' << y;
        ++compared;
      }
  return compared;
}

Rgb even(Vec3) {
  return {3, 2, 1};
}

TEST(TexturedView, ACheckerboardInEvenLightIsItsColoursTimesIrradianceOverPi) {
  // Patches of a quarter of a square, of one square and a bit, and of the whole wall.
  for (const double edge_m : {0.25, 1.1, 4.0}) {
    const Wall wall(checkerboard({250, 180, 90}, {60, 70, 200}), 2, edge_m);
    EXPECT_GT(expect_colours(wall, wall.seen(wall.lit_by(even), kInFront), 2, even, 1e-5f), 10'000) << edge_m;
  }
}

TEST(TexturedView, ALampWithATextureAddsItsExitance) {
  Wall wall(checkerboard({250, 180, 90}, {60, 70, 200}), 2, 0.5);
  wall.animation.emission.exitance_w_m2[0] = {{7, 0.5f, 0}};
  EXPECT_GT(expect_colours(wall, wall.seen(wall.lit_by(even), kInFront), 2, even, 1e-5f), 10'000);
}

// Patches whose centres see H are half a patch from the nodes that show it; of a linear field means over
// neighbours are exact, whatever the texture does in between.
TEST(TexturedView, LightThatGrowsEvenlyIsShownEvenlyThroughAPatternOfAnySize) {
  const auto growing = [](Vec3 at) { return Rgb{5 + at.x, 5 - at.y, 5 + at.x + at.y}; };
  for (const double edge_m : {0.1, 0.16}) {
    const Wall wall(checkerboard({250, 180, 90}, {60, 70, 200}), 2, edge_m);
    EXPECT_GT(expect_colours(wall, wall.seen(wall.lit_by(growing), kInFront), 2, growing, 1e-4f), 10'000);
  }
}

TEST(TexturedView, AChannelThatReflectsNothingIsBlackAndTheOthersAreNot) {
  const Wall wall(checkerboard({255, 0, 0}, {0, 200, 0}), 2, 0.25);
  const Image image = wall.seen(wall.lit_by(even), kInFront);
  EXPECT_GT(expect_colours(wall, image, 2, even, 1e-5f), 10'000);
  for (const Rgb pixel : image.pixels) EXPECT_EQ(pixel.b, 0);
}

// A dark square, rho of 0.0003 (level 1), beside a bright one. What it reflects is lost in the solver's
// noise, here all of it; counted as much as its neighbour it would halve H where they meet. It counts a
// thirtieth.
TEST(TexturedView, DarkPatchesCountLittleInTheIrradianceOfTheirNeighbours) {
  const Wall wall(checkerboard({200, 200, 200}, {1, 1, 1}), 2, 1.0);  // a patch per square
  PatchSeries radiosity = wall.lit_by(even);
  for (PatchId patch = 0; patch < wall.patches.count(); ++patch)
    if (wall.patches.texture_reflectance[patch].r < 0.01f) radiosity.at(patch, 0) = {0, 0, 0};
  const Image image = wall.seen(radiosity, kInFront);
  for (std::uint32_t y = 0; y < 160; ++y)
    for (std::uint32_t x = 0; x < 160; ++x)
      if (const auto colour = colour_at(wall.scene.textures[0], on_wall(x, y), 2);
          colour && colour->r > 0.1f) {
        EXPECT_NEAR(image.at(x, y).r, colour->r * 3 / kPi, 0.035f * colour->r * 3 / kPi) << x << ' ' << y;
      }
}

TEST(TexturedView, OneColourIsWhatAPlainMaterialShows) {
  const auto uneven = [](Vec3 at) { return Rgb{1 + at.x * at.x, 2 + at.y, 3}; };
  Wall wall(checkerboard({90, 120, 200}, {90, 120, 200}), 1.5f, 0.3);
  const PatchSeries radiosity = wall.lit_by(uneven);
  const Image textured = wall.seen(radiosity, kInFront);
  wall.patches.texture_reflectance.clear();
  const Image plain = wall.seen(radiosity, kInFront);
  for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
    EXPECT_NEAR(textured.pixels[i].r, plain.pixels[i].r, 1e-5f * plain.pixels[i].r);
    EXPECT_NEAR(textured.pixels[i].g, plain.pixels[i].g, 1e-5f * plain.pixels[i].g);
  }
}

// 50 squares per metre, so less than a pixel each, and along a wall seen from its edge many in a pixel: only
// the mean is left, and no pattern of its own.
TEST(TexturedView, APatternFinerThanPixelsIsItsMean) {
  const Wall wall(checkerboard({255, 255, 255}, {0, 0, 0}), 8000, 0.5);
  for (const CameraPose& pose : {kInFront, CameraPose{{-1.9f, 0, 0.3f}, {1, 0, 0}, {0, 0, 1}, 40}}) {
    const Image image = wall.seen(wall.lit_by(even), pose, 4);
    int seen = 0;
    for (std::uint32_t y = 1; y < 159; ++y)
      for (std::uint32_t x = 1; x < 159; ++x)
        if (image.at(x - 1, y).r > 0 && image.at(x + 1, y).r > 0 && image.at(x, y - 1).r > 0 &&
            image.at(x, y + 1).r > 0) {  // not on the rim of the wall
          ++seen;
          EXPECT_NEAR(image.at(x, y).r, 0.5f * 3 / kPi, 0.02f) << x << ' ' << y;
        }
    EXPECT_GT(seen, 5000);
  }
}

TEST(TexturedView, MovesWithItsObject) {
  Wall wall(checkerboard({250, 180, 90}, {60, 70, 200}), 2, 0.5);
  const PatchSeries radiosity = wall.lit_by(even);
  const Image still = wall.seen(radiosity, kInFront);
  // Turned by 90 degrees about x, made twice as large, moved; the camera with it.
  Pose pose;
  pose.m = {{{2, 0, 0, 10}, {0, 0, -2, -3}, {0, 2, 0, 5}}};
  wall.animation.objects[0].spans = {{0, 0, pose}};
  const CameraPose moved_camera{
      transform_point(pose, kInFront.position), transform_point(pose, kInFront.target), {0, 0, 1}, 90};
  const Image moved = wall.seen(radiosity, moved_camera);
  for (std::size_t i = 0; i < still.pixels.size(); ++i)
    EXPECT_NEAR(still.pixels[i].r, moved.pixels[i].r, 1e-3f) << i % 160 << ' ' << i / 160;
}

// One wall that rests, one that comes and goes before it.
TEST(TexturedView, AStandingCameraKeepsWhatTracingShows) {
  Wall wall(checkerboard({250, 180, 90}, {60, 70, 200}), 3, 0.5);
  Scene& scene = wall.scene;
  scene.objects.resize(2);
  tests::add_polygon(scene, {{-1, -1, 0.4f}, {0.3f, -1, 0.4f}, {0.3f, 0.9f, 0.4f}, {-1, 0.9f, 0.4f}}, 1);
  scene.corner_uvs.insert(scene.corner_uvs.end(), {0, 1, 2, 3});
  wall.animation = tests::still(scene, 2);
  wall.animation.objects[1].spans = {{1, 1, {}}};
  wall.animation.emission.exitance_w_m2[0] = {{1, 2, 0}};
  wall.patches = *mesh_into_patches(scene, 0.5);
  wall.patches.texture_reflectance = texture_reflectance(scene, wall.animation, wall.patches);
  const StaticRays rays(wall.patches, wall.animation);
  const ShadingMesh mesh = build_shading_mesh(wall.patches);
  const auto textures = make_textured_view(scene, wall.animation, wall.patches, mesh);
  const ShadedScene stage{wall.patches, mesh, rays, textures.get()};
  std::vector<std::vector<Rgb>> nodes(1);
  textured_node_values(*textures, {}, wall.lit_by(even), 0, every_frame(wall.animation), never, nodes);
  const PinholeCamera camera = pinhole_camera(kInFront, 160, 120);
  const auto kept = see_static(stage, camera, 5, 100 << 20, never);
  ASSERT_TRUE(kept);
  for (FrameIndex f = 0; f < 2; ++f) {
    const MovingRays moving(wall.patches, wall.animation, std::span(&f, 1));
    const auto motion = rows_with_motion(wall.patches, wall.animation, f, camera);
    const FrameView anywhere{camera, moving, 0, whole_rows(camera), f}, there{camera, moving, 0, motion, f};
    EXPECT_EQ(tests::one_frame(stage, anywhere, nodes[0], 5).pixels,
              tests::one_frame(stage, there, nodes[0], 5, kept.get()).pixels)
        << "frame " << f;
  }
}

}  // namespace
}  // namespace engine
