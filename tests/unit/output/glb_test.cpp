// A frame as glTF, made up as it is read.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "engine/output/artefacts.h"
#include "engine/output/patches_glb.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/output/sample.h"

namespace {

struct OpenFile {
  explicit OpenFile(const std::filesystem::path& path)
      : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~OpenFile() { ::close(descriptor); }
  int descriptor;
};

/// patches.npz and radiosity.npy of the sample: 16 patches of the floor, 9 of the wing.
class Sample {
 public:
  Sample() {
    const auto patches = engine::mesh_into_patches(tests::sample_scene(), 0.5);
    EXPECT_TRUE(engine::write_patches_npz(folder.path() / "p.npz", tests::sample_scene(), *patches,
                                          tests::sample_animation(), {{0, 1, 0}, 0.25}));
    EXPECT_TRUE(
        engine::write_radiosity_npy(folder.path() / "r.npy", tests::numbered_series(patches->count(), 3)));
  }
  api::Result<engine::PatchesGlb> glb(engine::GlbOptions options = {}) {
    patches_ = std::make_unique<OpenFile>(folder.path() / "p.npz");
    radiosity_ = std::make_unique<OpenFile>(folder.path() / "r.npy");
    return engine::PatchesGlb::open(patches_->descriptor, radiosity_->descriptor, options);
  }
  tests::TemporaryFolder folder;

 private:
  std::unique_ptr<OpenFile> patches_, radiosity_;
};

std::string read_all(const engine::PatchesGlb& glb, std::uint64_t piece) {
  std::string bytes(glb.size_bytes(), '?');
  for (std::uint64_t at = 0; at < bytes.size();) {
    const auto got = glb.read(at, bytes.data() + at, std::min(piece, bytes.size() - at));
    if (got <= 0) return {};
    at += static_cast<std::uint64_t>(got);
  }
  return bytes;
}

TEST(PatchesGlb, IsTheSameHoweverItIsRead) {
  Sample sample;
  const auto glb = sample.glb();
  ASSERT_TRUE(glb) << glb.error().message;
  const std::string whole = read_all(*glb, 1 << 20);
  EXPECT_EQ(whole.substr(0, 4), "glTF");
  for (const std::uint64_t piece : {1, 7, 48, 1000}) EXPECT_EQ(read_all(*glb, piece), whole) << piece;
  char byte = 0;
  EXPECT_EQ(glb->read(glb->size_bytes(), &byte, 1), 0);
}

TEST(PatchesGlb, LeavesOutWhatIsNotThereInTheFrame) {
  Sample sample;
  const auto text = [&](api::FrameIndex frame) {
    const auto glb = sample.glb({.frame = frame});
    EXPECT_TRUE(glb);
    return glb ? read_all(*glb, 4096) : std::string();
  };
  EXPECT_NE(text(0).find(R"("count":100,)"), std::string::npos) << "25 patches, 4 vertices each";
  EXPECT_NE(text(1).find(R"("count":64,)"), std::string::npos) << "16 patches";
}

TEST(PatchesGlb, RefusesFramesThatAreNotThereAndFilesThatDoNotFit) {
  Sample sample;
  const auto late = sample.glb({.frame = 3});
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().fault, api::Fault::not_found);
  ASSERT_TRUE(engine::write_radiosity_npy(sample.folder.path() / "r.npy", tests::numbered_series(24, 3)));
  const auto other = sample.glb();
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().fault, api::Fault::internal);
}

TEST(PatchesGlb, ADamagedArchiveIsAnErrorAndNothingElse) {
  Sample sample;
  std::ifstream file(sample.folder.path() / "p.npz", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  for (std::size_t at = 0; at < whole.size(); at += 29) {
    std::string broken = whole;
    broken[at] = static_cast<char>(~broken[at]);
    std::ofstream(sample.folder.path() / "p.npz", std::ios::binary) << broken;
    if (const auto glb = sample.glb()) (void)read_all(*glb, 4096);
    std::ofstream(sample.folder.path() / "p.npz", std::ios::binary) << whole.substr(0, at);
    EXPECT_FALSE(sample.glb()) << "cut at " << at;
  }
}

}  // namespace
