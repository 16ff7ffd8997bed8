// Texture coordinates and normals of corners, and what a texture says at a point.
#include <cmath>
#include <cstdlib>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

const std::string kCoordinates = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 .5\nvt .5\nvn 0 0 2\nvn 0 3 4\nvn 0 0 0\n";

/// Loads faces over kSquare and kCoordinates, with a texture on the material "wood".
Scene load_faces(const std::string& faces) {
  SceneFolder folder;
  folder.with("scene.obj", "mtllib a.mtl\n" + kSquare + kCoordinates + "usemtl wood\n" + faces)
      .with("a.mtl", "newmtl wood\nmap_Kd wood.png\nnewmtl plain\nKd .5\n")
      .with("wood.png", "pixels");
  const auto reader = [](const auto&, std::size_t) { return Texture{1, 1, {{9, 9, 9}}}; };
  auto scene = load_scene(folder.path(), dark(), {}, reader);
  if (scene) return std::move(*scene);
  ADD_FAILURE() << places_of(scene.error());
  return {};
}

using Indices = std::vector<std::uint32_t>;

TEST(Corners, KeepTheirTextureCoordinatesAndUnitNormals) {
  const Scene scene = load_faces("f 1/1/1 2/2/1 3/3/2 4/4/2\nf 1/-5/-3 2/5/2 3/3/1\n");
  EXPECT_EQ(scene.corners, (Indices{0, 1, 2, 3, 0, 1, 2}));
  EXPECT_EQ(scene.corner_uvs, (Indices{0, 1, 2, 3, 0, 4, 2}));
  EXPECT_EQ(scene.corner_normals, (Indices{0, 0, 1, 1, 0, 1, 0}));
  EXPECT_EQ(scene.uvs.at(3), (Uv{0, 1}));
  EXPECT_EQ(scene.uvs.at(4), (Uv{.5f, 0}));
  EXPECT_EQ(scene.normals.at(0), (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.normals.at(1), (Vec3{0, .6f, .8f}));
}

TEST(Corners, OfAPolygonHaveThemAllOrNot) {
  const Scene scene = load_faces(
      "f 1 2 3\n"             // before any that has one
      "f 1/1 2/2 3/3\n"       // coordinates only
      "f 1/1/1 2/2/1 3\n"     // one corner has none
      "f 1//1 2//3 3//1\n"    // one normal is zero
      "f 1//1 2//1 4//2\n");  // normals only
  const auto none = kNoIndex;
  EXPECT_EQ(scene.corner_uvs,
            (Indices{none, none, none, 0, 1, 2, none, none, none, none, none, none, none, none, none}));
  EXPECT_EQ(scene.corner_normals,
            (Indices{none, none, none, none, none, none, none, none, none, none, none, none, 0, 0, 1}));
  EXPECT_TRUE(has_warning(scene, "4 polygons of material 'wood' without texture coordinates"));
}

TEST(Corners, ThatHaveNoneTakeNoMemory) {
  const Scene none = load_faces("f 1 2 3 4\n");
  EXPECT_TRUE(none.corner_uvs.empty() && none.corner_normals.empty());
  EXPECT_EQ(none.uvs.capacity() + none.normals.capacity(), 0u);
  const Scene untextured = load_faces("usemtl plain\nf 1/1/1 2/2/1 3/3/1\n");
  EXPECT_TRUE(untextured.corner_uvs.empty() && untextured.uvs.empty());
  EXPECT_EQ(untextured.corner_normals.size(), 3u) << "smooth shading needs no texture";
}

TEST(Corners, MoveWithTheirPolygonsWhereOthersAreDropped) {
  const Scene scene = load_faces("f 1/1 1/2 2/3\nf 1/1 2/2 2/4 3/3 4/5\n");  // no area; a corner twice
  ASSERT_EQ(scene.polygons.size(), 1u);
  EXPECT_EQ(scene.corners, (Indices{0, 1, 2, 3}));
  EXPECT_EQ(scene.corner_uvs, (Indices{0, 1, 2, 4}));
}

TEST(Corners, MayNameWhatFollowsInTheFile) {
  const Scene scene = load_faces("f 1/6/4 2/1/1 3/1/1\nvt .25 .75\nvn 1 0 0\n");
  ASSERT_EQ(scene.corner_uvs.size(), 3u);
  EXPECT_EQ(scene.uvs.at(scene.corner_uvs[0]), (Uv{.25f, .75f}));
  EXPECT_EQ(scene.normals.at(scene.corner_normals[0]), (Vec3{1, 0, 0}));
}

TEST(Corners, HaveALimitOfCoordinatesAndNormals) {
  SceneLimits limits;
  limits.vertices = 4;
  for (const std::string more : {"vt 0 0\n", "vn 0 0 1\n"}) {
    EXPECT_TRUE(load_obj(kSquare + more + more + more + more + "f 1 2 3\n", limits));
    const auto scene = load_obj(kSquare + more + more + more + more + more + "f 1 2 3\n", limits);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().fault, api::Fault::out_of_resources);
    EXPECT_EQ(scene.error().violations.at(0).line, 9u);
  }
}

// Levels 0 and 255 are 0 and kReflectanceMax in linear light: left black, right white; below green, above
// not.
const Texture kQuarters{2, 2, {{0, 0, 0}, {255, 0, 0}, {0, 255, 0}, {255, 255, 0}}};

TEST(TexturePoints, AreSampledWithVUpwards) {
  EXPECT_EQ(reflectance_at(kQuarters, {.25f, .25f}), (Rgb{0, kReflectanceMax, 0})) << "lower left";
  EXPECT_EQ(reflectance_at(kQuarters, {.75f, .25f}), (Rgb{kReflectanceMax, kReflectanceMax, 0}));
  EXPECT_EQ(reflectance_at(kQuarters, {.25f, .75f}), (Rgb{0, 0, 0})) << "upper left";
  EXPECT_EQ(reflectance_at(kQuarters, {.75f, .75f}), (Rgb{kReflectanceMax, 0, 0}));
}

TEST(TexturePoints, AreJoinedLinearlyBetweenPixelCentres) {
  EXPECT_FLOAT_EQ(reflectance_at(kQuarters, {.5f, .25f}).r, kReflectanceMax / 2);
  EXPECT_FLOAT_EQ(reflectance_at(kQuarters, {.375f, .25f}).r, kReflectanceMax / 4);
  EXPECT_FLOAT_EQ(reflectance_at(kQuarters, {.25f, .375f}).g, kReflectanceMax * 3 / 4);
}

TEST(TexturePoints, RepeatAcrossTheEdges) {
  EXPECT_FLOAT_EQ(reflectance_at(kQuarters, {0, .25f}).r, kReflectanceMax / 2) << "left meets right";
  for (const float turns : {-3.f, 1.f, 40.f})
    for (const Uv at : {Uv{.125f, .625f}, Uv{.875f, .0625f}, Uv{0, 0}}) {
      EXPECT_EQ(reflectance_at(kQuarters, {at.u + turns, at.v}), reflectance_at(kQuarters, at)) << turns;
      EXPECT_EQ(reflectance_at(kQuarters, {at.u, at.v + turns}), reflectance_at(kQuarters, at)) << turns;
    }
  for (const float far : {1e30f, -1e30f, -1e-30f}) {
    const Rgb rho = reflectance_at(kQuarters, {far, far});
    EXPECT_TRUE(rho.r >= 0 && rho.r <= kReflectanceMax) << far;
  }
}

TEST(TexturePoints, HaveTheMeanOfThePixelsOnAverage) {
  std::srand(7);
  Texture texture{5, 3, std::vector<std::array<std::uint8_t, 3>>(15)};
  for (auto& pixel : texture.srgb)
    for (auto& level : pixel) level = static_cast<std::uint8_t>(std::rand() % 256);
  // Bilinear interpolation of a periodic grid: the midpoint rule over whole pixels is exact.
  constexpr int kSteps = 4;
  double sum = 0;
  for (float y = 0.5f; y < 3 * kSteps; ++y)
    for (float x = 0.5f; x < 5 * kSteps; ++x)
      sum += reflectance_at(texture, {x / (5 * kSteps), y / (3 * kSteps)}).b;
  EXPECT_NEAR(sum / (15 * kSteps * kSteps), mean_reflectance(texture).b, 1e-6);
}

}  // namespace
}  // namespace engine
