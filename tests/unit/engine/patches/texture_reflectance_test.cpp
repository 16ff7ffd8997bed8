#include "engine/patches/texture_reflectance.h"

#include <gtest/gtest.h>

#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

constexpr std::array<std::uint8_t, 3> kBlack{0, 0, 0}, kWhite{255, 255, 255}, kRed{255, 0, 0};

/// A texture per pixel list, on material 0; its reflectance is the mean, as load_scene leaves it.
Scene painted(std::uint32_t width, std::uint32_t height, std::vector<std::array<std::uint8_t, 3>> pixels,
              bool both_sides = false) {
  Scene scene = tests::scene_with(1, 2, both_sides);
  scene.textures.push_back({width, height, std::move(pixels)});
  scene.materials[0].texture = 0;
  scene.materials[0].reflectance = mean_reflectance(scene.textures[0]);
  return scene;
}

/// The polygon last added lies on the texture with these corners.
void lay_on_texture(Scene& scene, std::initializer_list<Uv> corners) {
  scene.corner_uvs.resize(scene.polygons.back().first_corner, kNoIndex);
  for (const Uv uv : corners) {
    scene.corner_uvs.push_back(static_cast<std::uint32_t>(scene.uvs.size()));
    scene.uvs.push_back(uv);
  }
}

void add_square(Scene& scene, float x, std::uint32_t material = 0) {
  tests::add_polygon(scene, {{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 1, 0}, {x, 1, 0}}, 0, material);
}

std::vector<Rgb> reflectance(const Scene& scene, double patch_edge_m) {
  return texture_reflectance(scene, tests::still(scene, 1), *mesh_into_patches(scene, patch_edge_m));
}

// Three patches across a texture that is black on its left half and red on its right one.
TEST(TextureReflectance, APatchHasTheMeanOfTheHalvesThatItCovers) {
  Scene scene = painted(2, 1, {kBlack, kRed});
  add_square(scene, 0);
  lay_on_texture(scene, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const auto rho = reflectance(scene, 0.34);
  ASSERT_EQ(rho.size(), 9u);
  for (int row = 0; row < 3; ++row) {
    EXPECT_NEAR(rho[3 * row].r, 0, 1e-6f);
    EXPECT_NEAR(rho[3 * row + 1].r, kTexelMax / 2, 1e-6f);
    EXPECT_NEAR(rho[3 * row + 2].r, kTexelMax, 1e-6f);
    EXPECT_EQ(rho[3 * row + 2].g, 0);
  }
}

TEST(TextureReflectance, TheFirstRowOfAPictureIsAtTheTop) {
  Scene scene = painted(1, 2, {kWhite, kBlack});
  add_square(scene, 0);
  lay_on_texture(scene, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const auto rho = reflectance(scene, 0.5);
  EXPECT_NEAR(rho[0].r, 0, 1e-6f) << "v = 0 is the bottom";
  EXPECT_NEAR(rho[2].r, kTexelMax, 1e-6f);
}

TEST(TextureReflectance, BothSidesShowTheSameAndRepetitionsAverageOut) {
  Scene scene = painted(2, 2, {kBlack, kWhite, kWhite, kBlack}, true);
  add_square(scene, 0);
  lay_on_texture(scene, {{0.3f, 0.1f}, {8.3f, 0.1f}, {8.3f, 8.1f}, {0.3f, 8.1f}});
  const auto rho = reflectance(scene, 0.25);
  ASSERT_EQ(rho.size(), 32u);
  for (const Rgb value : rho) EXPECT_NEAR(value.g, kTexelMax / 2, 1e-6f);
}

// A pentagon is cut into triangles, each of which must find its own corners: u follows x, so a patch left of
// x = 1/2 is black, one right of it is red, and their areas weigh to the mean.
TEST(TextureReflectance, TrianglesOfAPolygonFindTheirCornersOnTheTexture) {
  Scene scene = painted(2, 1, {kBlack, kRed});
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 0.75f, 0}, {0.5f, 1, 0}, {0, 0.75f, 0}});
  lay_on_texture(scene, {{0, 0}, {1, 0}, {1, 0.75f}, {0.5f, 1}, {0, 0.75f}});
  const Patches patches = *mesh_into_patches(scene, 0.1);
  const auto rho = texture_reflectance(scene, tests::still(scene, 1), patches);
  double red_area = 0, area = 0;
  for (PatchId p = 0; p < patches.count(); ++p) {
    const CellCorners cell = cell_corners(patches.facets[patches.facet_of[p]], patches.cell_of(p));
    const Facet& facet = patches.facets[patches.facet_of[p]];
    float low = 1, high = 0;
    for (std::uint32_t c = 0; c < cell.count; ++c) {
      const float x = (facet.origin + cell.u[c] * facet.edge_u + cell.v[c] * facet.edge_v).x;
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (high < 0.499f || low > 0.501f) {
      EXPECT_NEAR(rho[p].r, low > 0.5f ? kTexelMax : 0, 1e-5f) << p;
    }
    red_area += rho[p].r * patches.area_m2[p];
    area += patches.area_m2[p];
  }
  EXPECT_NEAR(red_area / area, kTexelMax / 2, 1e-5);
}

TEST(TextureReflectance, IsEmptyWhereNothingShowsATexture) {
  Scene plain = tests::scene_with(1, 1);
  add_square(plain, 0);
  EXPECT_TRUE(reflectance(plain, 0.5).empty());

  Scene unlaid = painted(1, 1, {kRed});
  add_square(unlaid, 0);
  EXPECT_TRUE(reflectance(unlaid, 0.5).empty()) << "no texture coordinates: the mean is the material's";

  Scene keyed = painted(1, 1, {kRed});
  add_square(keyed, 0);
  lay_on_texture(keyed, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  Animation animation = tests::still(keyed, 2);
  animation.reflectance = {{{0.1f, 0.2f, 0.3f}}, {}};
  EXPECT_TRUE(texture_reflectance(keyed, animation, *mesh_into_patches(keyed, 0.5)).empty());
}

TEST(TextureReflectance, OtherMaterialsAndFacesWithoutCoordinatesKeepTheirs) {
  Scene scene = painted(2, 1, {kBlack, kWhite});
  add_square(scene, 0);
  lay_on_texture(scene, {{0, 0}, {0.4f, 0}, {0.4f, 1}, {0, 1}});
  add_square(scene, 2);     // the same material, no coordinates
  add_square(scene, 4, 1);  // paint
  scene.corner_uvs.resize(scene.corners.size(), kNoIndex);
  const auto rho = reflectance(scene, 2);
  ASSERT_EQ(rho.size(), 3u);
  EXPECT_NEAR(rho[0].r, 0, 1e-6f);
  EXPECT_EQ(rho[1], mean_reflectance(scene.textures[0]));
  EXPECT_EQ(rho[2], (Rgb{0.5f, 0.5f, 0.5f}));
}

TEST(TextureReflectance, NoPatchReflectsAllTheLight) {
  Scene scene = painted(1, 1, {kWhite});
  add_square(scene, 0);
  lay_on_texture(scene, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  add_square(scene, 2);
  scene.corner_uvs.resize(scene.corners.size(), kNoIndex);
  for (const Rgb rho : reflectance(scene, 2)) EXPECT_LE(max_channel(rho), kTexelMax);
}

TEST(PatchReflectance, AnAnimatedMaterialWinsOverTheTextureOfOthers) {
  Scene scene = painted(1, 1, {kRed});
  add_square(scene, 0);
  lay_on_texture(scene, {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  add_square(scene, 2, 1);
  scene.corner_uvs.resize(scene.corners.size(), kNoIndex);
  Animation animation = tests::still(scene, 2);
  animation.reflectance = {{}, {{0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}}};
  Patches patches = *mesh_into_patches(scene, 2);
  patches.texture_reflectance = texture_reflectance(scene, animation, patches);
  EXPECT_EQ(patch_reflectance(scene, animation, patches, 0, 1), (Rgb{kTexelMax, 0, 0}));
  EXPECT_EQ(patch_reflectance(scene, animation, patches, 1, 1), (Rgb{0.2f, 0.2f, 0.2f}));
}

}  // namespace
}  // namespace engine
