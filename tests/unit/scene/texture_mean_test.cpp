// Textures written by OpenImageIO, whose mean is known in closed form.
#include "engine/image/texture_mean.h"

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

// 1e-5: a level of the 16 bits it is read with, and single precision.
TEST(TextureMean, IsTakenInLinearLightNotOfSrgbValues) {
  SceneFolder folder;
  std::vector<unsigned char> pixels = repeated({0, 0, 0}, 100 * 50);
  const std::vector<unsigned char> bright = repeated({255, 188, 128}, 100 * 50);
  pixels.insert(pixels.end(), bright.begin(), bright.end());
  write_image(folder, "half.png", "png", 100, 100, 3, pixels);
  const auto mean = mean_reflectance_of_texture(folder.path() / "half.png", kPixelsMax);
  ASSERT_TRUE(mean) << mean.error().message;
  EXPECT_NEAR(mean->r, 0.5, 1e-5);
  EXPECT_NEAR(mean->g, linear(188) / 2, 1e-5);
  EXPECT_NEAR(mean->b, linear(128) / 2, 1e-5);
}

TEST(TextureMean, OfGreyIsGreyAndAlphaIsNotRead) {
  SceneFolder folder;
  write_image(folder, "grey.png", "png", 3, 5, 1, repeated({100}, 15));
  write_image(folder, "alpha.png", "png", 3, 5, 4, repeated({200, 100, 50, 10}, 15));
  const auto grey = mean_reflectance_of_texture(folder.path() / "grey.png", kPixelsMax);
  const auto alpha = mean_reflectance_of_texture(folder.path() / "alpha.png", kPixelsMax);
  ASSERT_TRUE(grey && alpha);
  EXPECT_NEAR(grey->r, linear(100), 1e-5);
  EXPECT_EQ(grey->b, grey->r);
  EXPECT_NEAR(alpha->r, linear(200), 1e-5);
  EXPECT_NEAR(alpha->b, linear(50), 1e-5);
}

TEST(TextureMean, OfAJpegIsWithinItsCoding) {
  SceneFolder folder;
  write_image(folder, "flat.jpg", "jpg", 64, 64, 3, repeated({180, 90, 60}, 64 * 64));
  const auto mean = mean_reflectance_of_texture(folder.path() / "flat.jpg", kPixelsMax);
  ASSERT_TRUE(mean) << mean.error().message;
  // YCbCr in whole numbers is off by 2 levels at most.
  EXPECT_NEAR(mean->r, linear(180), linear(182) - linear(180));
  EXPECT_NEAR(mean->g, linear(90), linear(92) - linear(90));
  EXPECT_NEAR(mean->b, linear(60), linear(62) - linear(60));
}

TEST(TextureMean, GoesByFirstBytesNotByName) {
  SceneFolder folder;
  write_image(folder, "wood.jpg", "png", 4, 4, 3, repeated({188, 188, 188}, 16));
  EXPECT_TRUE(mean_reflectance_of_texture(folder.path() / "wood.jpg", kPixelsMax));
  write_image(folder, "wood.png", "tif", 4, 4, 3, repeated({188, 188, 188}, 16));
  const auto tiff = mean_reflectance_of_texture(folder.path() / "wood.png", kPixelsMax);
  ASSERT_FALSE(tiff) << "other decoders must not see a stranger's file";
  EXPECT_EQ(tiff.error().fault, api::Fault::invalid_request);
}

TEST(TextureMean, RefusesWhatIsTooLarge) {
  SceneFolder folder;
  write_image(folder, "wide.png", "png", kTextureEdgeMax + 1, 1, 1, repeated({9}, kTextureEdgeMax + 1));
  const auto wide = mean_reflectance_of_texture(folder.path() / "wide.png", kPixelsMax);
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().fault, api::Fault::out_of_resources);
  write_image(folder, "small.png", "png", 10, 10, 1, repeated({9}, 100));
  EXPECT_TRUE(mean_reflectance_of_texture(folder.path() / "small.png", 100));
  EXPECT_FALSE(mean_reflectance_of_texture(folder.path() / "small.png", 99));
}

TEST(TextureMean, RefusesWhatIsDamagedOrEmptyOrNotThere) {
  SceneFolder folder;
  std::vector<unsigned char> noise;
  for (unsigned i = 0; i < 64 * 64; ++i) noise.push_back(static_cast<unsigned char>((i * 2654435761u) >> 11));
  write_image(folder, "cut.png", "png", 64, 64, 1, noise);
  const auto whole = std::filesystem::file_size(folder.path() / "cut.png");
  for (const std::uintmax_t bytes : {whole / 2, std::uintmax_t{40}, std::uintmax_t{8}, std::uintmax_t{0}}) {
    std::filesystem::resize_file(folder.path() / "cut.png", bytes);
    const auto mean = mean_reflectance_of_texture(folder.path() / "cut.png", kPixelsMax);
    ASSERT_FALSE(mean) << bytes;
    EXPECT_EQ(mean.error().fault, api::Fault::invalid_request) << bytes;
  }
  EXPECT_FALSE(mean_reflectance_of_texture(folder.path() / "gone.png", kPixelsMax));
}

TEST(TextureMean, ReplacesKdOfAScene) {
  SceneFolder folder;
  write_image(folder, "wood.png", "png", 8, 8, 3, repeated({188, 128, 100}, 64));
  folder.with("scene.obj", "mtllib a.mtl\n" + kSquare + "usemtl wood\nf 1 2 3 4\n")
      .with("a.mtl", "newmtl wood\nKd 1 1 1\nmap_Kd C:\\tex\\Wood.PNG\n");
  const auto scene = load_scene(folder.path(), dark(), {}, mean_reflectance_of_texture);
  ASSERT_TRUE(scene) << places_of(scene.error());
  EXPECT_NEAR(scene->materials[0].reflectance.g, linear(128), 1e-5);
}

}  // namespace
}  // namespace engine
