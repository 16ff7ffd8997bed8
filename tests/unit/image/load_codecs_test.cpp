// The module of codecs: loaded when it is needed, and what is said where it cannot be.
#include "engine/image/load_codecs.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "engine/image/image_files.h"
#include "engine/image/png_bytes.h"
#include "tests/support/temporary_folder.h"

namespace engine {
namespace {

/// Is a file whose name holds `name` part of this process?
bool is_loaded(const std::string& name) {
  std::ifstream maps("/proc/self/maps");
  const std::string text{std::istreambuf_iterator<char>(maps), {}};
  EXPECT_NE(text.find("libstdc++"), std::string::npos) << "else nothing could be told from it";
  return text.find(name) != std::string::npos;
}

TEST(Codecs, AreLoadedForAnExrAndNotForAPng) {
  ASSERT_TRUE(png_bytes(ScreenImage(8, 8)));
  EXPECT_FALSE(is_loaded("keylume-codecs"));
  EXPECT_FALSE(is_loaded("libOpenImageIO"));
  const auto exr = encode_exr(Image(8, 8), [] { return false; });
  ASSERT_TRUE(exr) << exr.error().message;
  EXPECT_TRUE(exr->starts_with("\x76\x2f\x31\x01")) << "the first bytes of every EXR file";
  EXPECT_TRUE(is_loaded("keylume-codecs"));
}

TEST(Codecs, AreTheSameForAllThreadsThatAskAtOnce) {
  std::vector<const Codecs*> found(8);
  std::vector<std::thread> threads;
  for (const Codecs*& codecs : found)
    threads.emplace_back([&codecs] {
      const auto loaded = image_codecs();
      codecs = loaded ? *loaded : nullptr;
    });
  for (std::thread& thread : threads) thread.join();
  ASSERT_NE(found[0], nullptr);
  EXPECT_EQ(found, std::vector<const Codecs*>(8, found[0]));
}

TEST(Codecs, ThatAreMissingDamagedOrOfAnotherVersionAreNamed) {
  tests::TemporaryFolder folder;
  const auto missing = folder.path() / "gone.so", damaged = folder.path() / "damaged.so";
  std::ofstream(damaged) << "no library";
  for (const auto& [file, why] : {std::pair<std::filesystem::path, const char*>{missing, "No such file"},
                                  {damaged, "file too short"},
                                  {KEYLUME_OTHER_CODECS, "it is of version 0, not 1"},
                                  {KEYLUME_NO_CODECS, "does not have keylume_image_codecs"}}) {
    const auto codecs = open_codecs(file);
    ASSERT_FALSE(codecs) << file;
    EXPECT_EQ(codecs.error().fault, api::Fault::internal);
    EXPECT_NE(codecs.error().message.find(file.string()), std::string::npos) << codecs.error().message;
    EXPECT_NE(codecs.error().message.find(why), std::string::npos) << codecs.error().message;
  }
}

TEST(Codecs, AreLookedForBesideTheProgramAndThenInTheLibFolderBesideIts) {
  tests::TemporaryFolder folder;
  const auto programs = folder.path() / "bin";
  const auto built = programs / "keylume-codecs.so";
  const auto installed = folder.path() / "lib/keylume/keylume-codecs.so";
  EXPECT_EQ(codecs_file(programs), built) << "neither is there: the error names this one";
  std::filesystem::create_directories(installed.parent_path());
  std::ofstream(installed) << "";
  EXPECT_EQ(codecs_file(programs), installed);
  std::filesystem::create_directories(programs);
  std::ofstream(built) << "";
  EXPECT_EQ(codecs_file(programs), built);
}

}  // namespace
}  // namespace engine
