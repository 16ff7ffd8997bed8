#include "engine/output/artefacts.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "engine/base/sha256.h"
#include "engine/output/npy.h"
#include "engine/output/zip_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/output/sample.h"

namespace {

namespace fs = std::filesystem;
using tests::bytes_of;
using Folder = tests::TemporaryFolder;

// FIPS 180-4's own examples, and a million times "a" (longer than one read buffer).
TEST(Sha256, AgreesWithTheVectorsOfTheStandard) {
  EXPECT_EQ(engine::sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(engine::sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(engine::sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  Folder folder;
  ASSERT_TRUE(engine::write_file(folder.path() / "a", std::string(1'000'000, 'a')));
  const auto digest = engine::digest_file(folder.path() / "a");
  ASSERT_TRUE(digest);
  EXPECT_EQ(digest->bytes, 1'000'000u);
  EXPECT_EQ(digest->sha256, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Npy, HeaderIsAlignedAndTellsItsLength) {
  const std::string header = engine::npy_header("<f4", std::array<std::uint64_t, 3>{120, 50'000, 3});
  EXPECT_EQ(header.size() % 64, 0u);
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(header[i]); };
  EXPECT_EQ(byte(8) + 256u * byte(9), header.size() - 10);
  EXPECT_EQ(header.back(), '\n');
  EXPECT_NE(header.find("(120, 50000, 3, )"), std::string::npos) << header;
}

// Wide enough for several blocks of patches: 2,000 frames leave 1,398 patches per 32 MiB.
TEST(RadiosityNpy, TransposesASeriesLargerThanItsBuffer) {
  constexpr std::uint32_t kPatches = 3000, kFrames = 2000;
  Folder folder;
  ASSERT_TRUE(
      engine::write_radiosity_npy(folder.path() / "b.npy", tests::numbered_series(kPatches, kFrames)));
  const std::string bytes = bytes_of(folder.path() / "b.npy");
  const std::size_t start = bytes.find('\n') + 1;
  ASSERT_EQ(bytes.size(), start + std::size_t{kPatches} * kFrames * 12);
  for (std::size_t f = 0; f < kFrames; f += 7)
    for (std::size_t p = 0; p < kPatches; p += 11) {
      float value[3];
      std::memcpy(value, bytes.data() + start + 12 * (f * kPatches + p), sizeof value);
      ASSERT_EQ(value[0], static_cast<float>(p + 1000 * f)) << "patch " << p << " frame " << f;
      ASSERT_EQ(value[1], -static_cast<float>(p));
      ASSERT_EQ(value[2], 0.5f);
    }
}

TEST(RadiosityNpy, WritesAHeaderOnlyWhenThereAreNoPatches) {
  Folder folder;
  ASSERT_TRUE(engine::write_radiosity_npy(folder.path() / "b.npy", engine::PatchSeries(0, 4)));
  EXPECT_EQ(fs::file_size(folder.path() / "b.npy") % 64, 0u);
}

TEST(PatchesNpz, CutsNamesThatAreTooLong) {
  Folder folder;
  auto scene = tests::sample_scene();
  scene.objects[0].name = std::string(60'000, 'x');
  const auto patches = engine::mesh_into_patches(scene, 0.5);
  ASSERT_TRUE(patches);
  ASSERT_TRUE(
      engine::write_patches_npz(folder.path() / "p.npz", scene, *patches, tests::sample_animation(), {}));
  EXPECT_NE(bytes_of(folder.path() / "p.npz").find("'<U256'"), std::string::npos);
  EXPECT_LT(fs::file_size(folder.path() / "p.npz"), 20'000u);
}

TEST(ZipStore, RefusesAnArchiveOfFourGibibytes) {
  Folder folder;
  auto file = engine::DurableFile::create(folder.path() / "big.zip");
  ASSERT_TRUE(file);
  engine::ZipStore zip(*file);
  const auto begun = zip.begin("huge.npy", std::uint64_t{4} << 30);
  ASSERT_FALSE(begun);
  EXPECT_EQ(begun.error().fault, api::Fault::out_of_resources);
  EXPECT_NE(begun.error().message.find("huge.npy"), std::string::npos);
}

TEST(Manifest, EscapesWhatJsonReserves) {
  Folder folder;
  const std::string name = "a\"b\\c\td";
  ASSERT_TRUE(engine::write_file(folder.path() / name, "x"));
  const engine::Artefact artefact{name, "image/png"};
  ASSERT_TRUE(engine::write_manifest(folder.path(), {&artefact, 1}));
  EXPECT_NE(bytes_of(folder.path() / "manifest.json").find(R"("a\"b\\c\u0009d")"), std::string::npos);
}

TEST(Manifest, IsNotWrittenWhenAFileOfItIsMissing) {
  Folder folder;
  const engine::Artefact artefact{"gone.png", "image/png"};
  const auto written = engine::write_manifest(folder.path(), {&artefact, 1});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().fault, api::Fault::internal);
  EXPECT_NE(written.error().message.find("gone.png"), std::string::npos) << written.error().message;
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
