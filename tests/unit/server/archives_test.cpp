// Archives that python wrote, honest and lying: tests/support/archives.py, whose names say what is expected.
#include <fcntl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>

#include "server/archives/archive.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

struct Read {
  api::Status status = api::Done{};
  std::map<std::string, std::string> files;
  std::int64_t bytes = 0;
};

Read read(const fs::path& path, const server::ArchiveLimits& limits = {}) {
  Read result;
  std::string name;
  const server::FileHandle archive(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  const server::EntrySink sink{[&](const std::string& begun) -> api::Status {
                                 name = begun;
                                 result.files[name];
                                 return api::Done{};
                               },
                               [&](std::string_view bytes) -> api::Status {
                                 result.files[name] += bytes;
                                 result.bytes += static_cast<std::int64_t>(bytes.size());
                                 return api::Done{};
                               }};
  result.status = server::read_archive(archive, limits, sink);
  return result;
}

std::string code_of(const api::Status& status) {
  if (status) return "ok";
  return status.error().violations.empty() ? "without a violation" : status.error().violations[0].code;
}

class Archives : public testing::Test {
 protected:
  void SetUp() override {
    const std::string command = std::string(KEYLUME_PYTHON) +
                                " -B " KEYLUME_SOURCE_DIR "/tests/support/archives.py " +
                                folder_.path().string();
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  tests::TemporaryFolder folder_;
};

TEST_F(Archives, AreTakenOrRefusedForTheReasonTheyWereMadeFor) {
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    const std::string name = entry.path().filename().string();
    const Read outcome = read(entry.path());
    EXPECT_EQ(code_of(outcome.status), name.substr(0, name.find("--")))
        << name << ": " << (outcome.status ? "" : outcome.status.error().message);
    EXPECT_LE(outcome.bytes, 4 << 20) << name << " was let grow";
    for (const auto& file : outcome.files) EXPECT_TRUE(server::is_entry_name(file.first)) << name;
    ++seen;
  }
  EXPECT_GT(seen, 60);
}

TEST_F(Archives, GiveTheBytesThatWentIn) {
  for (const char* name : {"ok--job.zip", "ok--job.tar", "ok--here.tar"}) {
    const Read outcome = read(folder_.path() / name);
    EXPECT_EQ(outcome.files.size(), 2u) << name;
    EXPECT_EQ(outcome.files.at("scene.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n") << name;
    EXPECT_EQ(outcome.files.at("animation.json"), "{\"frames\":{\"count\":1}}") << name;
  }
  EXPECT_EQ(read(folder_.path() / "ok--sixty_four_kib.zip").files.at("scene.obj").size(), 65536u);
  EXPECT_EQ(read(folder_.path() / "ok--folders.zip").files.size(), 1u) << "hidden files are left out";
  EXPECT_TRUE(read(folder_.path() / "ok--long_gnu.tar").files.begin()->first.ends_with("/scene.obj"));
}

TEST_F(Archives, AreHeldToTheirLimits) {
  server::ArchiveLimits limits;
  limits.entry_bytes = 20;
  EXPECT_EQ(code_of(read(folder_.path() / "ok--job.zip", limits).status), "too_large");
  EXPECT_EQ(code_of(read(folder_.path() / "ok--job.tar", limits).status), "too_large");
  limits = {};
  limits.total_bytes = 40;
  EXPECT_EQ(code_of(read(folder_.path() / "ok--job.zip", limits).status), "too_large");
  limits = {};
  limits.entries = 1;
  EXPECT_EQ(code_of(read(folder_.path() / "ok--job.tar", limits).status), "too_many");
}

TEST_F(Archives, CutAnywhereAreRefusedAndNeverHalfTaken) {
  for (const char* name : {"ok--job.zip", "ok--job.tar"}) {
    const std::string whole = tests::bytes_of(folder_.path() / name);
    const fs::path cut = folder_.path() / "cut";
    // Behind its two empty blocks a tar is padded: that may be missing.
    const std::size_t needed = std::string(name).ends_with("tar") ? 4 * 512 + 512 : whole.size();
    for (std::size_t size = 0; size < needed; size += 7) {
      std::ofstream(cut, std::ios::binary | std::ios::trunc) << whole.substr(0, size);
      EXPECT_FALSE(read(cut).status) << name << " cut to " << size;
    }
  }
}

TEST_F(Archives, ARefusalShowsNoControlCharactersOfTheName) {
  const Read outcome = read(folder_.path() / "bad_name--newline.zip");
  ASSERT_FALSE(outcome.status);
  EXPECT_EQ(outcome.status.error().message.find_first_of("\r\n"), std::string::npos);
}

}  // namespace
