// Textures written by OpenImageIO, whose pixels and mean are known.
#include "engine/image/texture_file.h"

#include <OpenImageIO/imageio.h>

#include <cmath>

#include "tests/unit/scene/scene_folder.h"

namespace engine {
namespace {

constexpr std::size_t kPixelsMax = 64u << 20;

/// sRGB 0 .. 255 to linear; IEC 61966-2-1, above its linear toe.
double linear(double level) {
  return std::pow((level / 255 + 0.055) / 1.055, 2.4);
}

/// Writes 8-bit pixels in `format` ("png", "jpg", "tif") to `name`, whatever that ends in.
void write_image(const SceneFolder& folder, const std::string& name, const std::string& format, int width,
                 int height, int channels, const std::vector<unsigned char>& pixels) {
  const auto path = folder.path() / ("written." + format);
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out) << OIIO::geterror();
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("CompressionQuality", 100);
  ASSERT_TRUE(out->open(path.string(), spec)) << out->geterror();
  ASSERT_TRUE(out->write_image(OIIO::TypeDesc::UINT8, pixels.data())) << out->geterror();
  ASSERT_TRUE(out->close());
  std::filesystem::rename(path, folder.path() / name);
}

std::vector<unsigned char> repeated(std::vector<unsigned char> pixel, int times) {
  std::vector<unsigned char> pixels;
  for (int i = 0; i < times; ++i) pixels.insert(pixels.end(), pixel.begin(), pixel.end());
  return pixels;
}

Rgb mean_of(const api::Result<Texture>& texture) {
  return texture ? mean_reflectance(*texture) : Rgb{-1, -1, -1};
}

TEST(TextureFile, KeepsEveryPixelWithTheTopRowFirst) {
  SceneFolder folder;
  std::vector<unsigned char> pixels;
  for (unsigned i = 0; i < 3 * 700; ++i) pixels.push_back(static_cast<unsigned char>(i * 37));
  write_image(folder, "all.png", "png", 7, 100, 3, pixels);
  const auto texture = read_texture(folder.path() / "all.png", kPixelsMax);
  ASSERT_TRUE(texture) << texture.error().message;
  EXPECT_EQ(texture->width, 7u);
  EXPECT_EQ(texture->height, 100u);
  ASSERT_EQ(texture->srgb.size(), 700u);
  for (std::size_t i = 0; i < 700; ++i)
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(texture->srgb[i][c], pixels[3 * i + c]) << i;
}

// 1e-5: white counts as 0.999999, and single precision.
TEST(TextureFile, IsReadInLinearLightNotOfSrgbValues) {
  SceneFolder folder;
  std::vector<unsigned char> pixels = repeated({0, 0, 0}, 100 * 50);
  const std::vector<unsigned char> bright = repeated({255, 188, 128}, 100 * 50);
  pixels.insert(pixels.end(), bright.begin(), bright.end());
  write_image(folder, "half.png", "png", 100, 100, 3, pixels);
  const Rgb mean = mean_of(read_texture(folder.path() / "half.png", kPixelsMax));
  EXPECT_NEAR(mean.r, 0.5, 1e-5);
  EXPECT_NEAR(mean.g, linear(188) / 2, 1e-5);
  EXPECT_NEAR(mean.b, linear(128) / 2, 1e-5);
}

TEST(TextureFile, OfGreyIsGreyAndAlphaIsNotRead) {
  SceneFolder folder;
  write_image(folder, "grey.png", "png", 3, 5, 1, repeated({100}, 15));
  write_image(folder, "alpha.png", "png", 3, 5, 4, repeated({200, 100, 50, 10}, 15));
  const Rgb grey = mean_of(read_texture(folder.path() / "grey.png", kPixelsMax));
  const Rgb alpha = mean_of(read_texture(folder.path() / "alpha.png", kPixelsMax));
  EXPECT_NEAR(grey.r, linear(100), 1e-5);
  EXPECT_EQ(grey.b, grey.r);
  EXPECT_NEAR(alpha.r, linear(200), 1e-5);
  EXPECT_NEAR(alpha.b, linear(50), 1e-5);
}

TEST(TextureFile, OfAJpegIsWithinItsCoding) {
  SceneFolder folder;
  write_image(folder, "flat.jpg", "jpg", 64, 64, 3, repeated({180, 90, 60}, 64 * 64));
  const Rgb mean = mean_of(read_texture(folder.path() / "flat.jpg", kPixelsMax));
  // YCbCr in whole numbers is off by 2 levels at most.
  EXPECT_NEAR(mean.r, linear(180), linear(182) - linear(180));
  EXPECT_NEAR(mean.g, linear(90), linear(92) - linear(90));
  EXPECT_NEAR(mean.b, linear(60), linear(62) - linear(60));
}

TEST(TextureFile, GoesByFirstBytesNotByName) {
  SceneFolder folder;
  write_image(folder, "wood.jpg", "png", 4, 4, 3, repeated({188, 188, 188}, 16));
  EXPECT_TRUE(read_texture(folder.path() / "wood.jpg", kPixelsMax));
  write_image(folder, "wood.png", "tif", 4, 4, 3, repeated({188, 188, 188}, 16));
  const auto tiff = read_texture(folder.path() / "wood.png", kPixelsMax);
  ASSERT_FALSE(tiff) << "other decoders must not see a stranger's file";
  EXPECT_EQ(tiff.error().fault, api::Fault::invalid_request);
}

TEST(TextureFile, RefusesWhatIsTooLarge) {
  SceneFolder folder;
  write_image(folder, "wide.png", "png", kTextureEdgeMax + 1, 1, 1, repeated({9}, kTextureEdgeMax + 1));
  const auto wide = read_texture(folder.path() / "wide.png", kPixelsMax);
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().fault, api::Fault::out_of_resources);
  write_image(folder, "small.png", "png", 10, 10, 1, repeated({9}, 100));
  EXPECT_TRUE(read_texture(folder.path() / "small.png", 100));
  EXPECT_FALSE(read_texture(folder.path() / "small.png", 99));
}

TEST(TextureFile, RefusesWhatIsDamagedOrEmptyOrNotThere) {
  SceneFolder folder;
  std::vector<unsigned char> noise;
  for (unsigned i = 0; i < 64 * 64; ++i) noise.push_back(static_cast<unsigned char>((i * 2654435761u) >> 11));
  write_image(folder, "cut.png", "png", 64, 64, 1, noise);
  const auto whole = std::filesystem::file_size(folder.path() / "cut.png");
  for (const std::uintmax_t bytes : {whole / 2, std::uintmax_t{40}, std::uintmax_t{8}, std::uintmax_t{0}}) {
    std::filesystem::resize_file(folder.path() / "cut.png", bytes);
    const auto cut = read_texture(folder.path() / "cut.png", kPixelsMax);
    ASSERT_FALSE(cut) << bytes;
    EXPECT_EQ(cut.error().fault, api::Fault::invalid_request) << bytes;
  }
  EXPECT_FALSE(read_texture(folder.path() / "gone.png", kPixelsMax));
}

TEST(TextureFile, ReplacesKdOfAScene) {
  SceneFolder folder;
  write_image(folder, "wood.png", "png", 8, 8, 3, repeated({188, 128, 100}, 64));
  folder.with("scene.obj", "mtllib a.mtl\n" + kSquare + "vt .5 .5\nusemtl wood\nf 1/1 2/1 3/1 4/1\n")
      .with("a.mtl", "newmtl wood\nKd 1 1 1\nmap_Kd C:\\tex\\Wood.PNG\n");
  const auto scene = load_scene(folder.path(), dark(), {}, read_texture);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_NEAR(scene->materials[0].reflectance.g, linear(128), 1e-5);
  ASSERT_EQ(scene->materials[0].texture, 0);
  EXPECT_EQ(scene->textures.at(0).srgb.size(), 64u);
  EXPECT_EQ(scene->corner_uvs, (std::vector<std::uint32_t>{0, 0, 0, 0}));
}

}  // namespace
}  // namespace engine
