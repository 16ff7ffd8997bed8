// Archives that are made up as they are read: any part of them is the same part of the whole.
#include <sys/stat.h>

#include <array>

#include "server/artefacts/npz_body.h"
#include "server/artefacts/tar_body.h"
#include "tests/unit/server/read_body.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

/// Every position and a length, each read by a body that has seen nothing else.
template <class MakeBody>
void expect_parts_of_the_whole(MakeBody make) {
  auto body = make();
  const std::string whole = read_from(body, 0, body.size(), 1 << 16);
  ASSERT_EQ(static_cast<std::int64_t>(whole.size()), body.size());
  for (std::int64_t at = 0; at < body.size(); at += 37)
    for (const std::int64_t size : {1, 100, 1500}) {
      auto other = make();
      ASSERT_EQ(read_from(other, at, size, 64),
                whole.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(size)))
          << at << " + " << size;
    }
  char byte = 0;
  EXPECT_EQ(body.read(body.size(), &byte, 1), 0);
}

TarBody sample_tar(const std::filesystem::path& folder) {
  const std::string long_name = std::string(150, 'n') + "/ü.txt";
  return TarBody({{"a/text", 0, {}, {}, "hello"},
                  {"a/file", 1000, folder, "data.bin", {}},
                  {long_name, 0, {}, {}, ""},
                  {"a/last", 1000, folder, "data.bin", {}}},
                 1'700'000'000);
}

TEST(TarBody, AnyPartIsThatPartOfTheWhole) {
  TemporaryFolder folder;
  write_text(folder.path() / "data.bin", std::string(1000, 'x'));
  expect_parts_of_the_whole([&] { return sample_tar(folder.path()); });
}

TEST(TarBody, AFileThatIsGoneOrShorterIsAnError) {
  TemporaryFolder folder;
  write_text(folder.path() / "data.bin", std::string(700, 'x'));
  TarBody tar = sample_tar(folder.path());
  EXPECT_LT(static_cast<std::int64_t>(read_from(tar, 0, tar.size(), 512).size()), tar.size());
  std::filesystem::remove(folder.path() / "data.bin");
  TarBody other = sample_tar(folder.path());
  std::array<char, 8> bytes{};
  EXPECT_EQ(other.read(1536, bytes.data(), 8), -1);
}

TEST(TarBody, ASymbolicLinkIsNotFollowed) {
  TemporaryFolder folder;
  write_text(folder.path() / "secret", std::string(1000, 's'));
  std::filesystem::create_symlink(folder.path() / "secret", folder.path() / "data.bin");
  TarBody tar = sample_tar(folder.path());
  EXPECT_EQ(read_from(tar, 0, tar.size(), 512).find("ssss"), std::string::npos);
}

TEST(TarBody, SaysTheSizeOfFilesBeyondEightGibibytes) {
  const std::int64_t huge = std::int64_t{9} << 30;
  TarBody tar({{"huge", huge, "/nowhere", "huge", {}}}, 0);
  EXPECT_EQ(tar.size(), 3 * 512 + huge + 2 * 512);
  EXPECT_NE(read_from(tar, 0, 1024, 512).find("size=" + std::to_string(huge)), std::string::npos);
}

api::Result<NpzBody> sample_npz(const std::filesystem::path& folder) {
  std::vector<NpzEntry> entries;
  for (const char* name : {"one.npy", "two.npy"}) {
    auto file = open_below(folder, name);
    EXPECT_TRUE(file);
    entries.push_back({name, std::move(*file), 900});
  }
  return NpzBody::of(std::move(entries));
}

TEST(NpzBody, AnyPartIsThatPartOfTheWhole) {
  TemporaryFolder folder;
  write_text(folder.path() / "one.npy", std::string(900, '1'));
  write_text(folder.path() / "two.npy", std::string(900, '2'));
  expect_parts_of_the_whole([&] { return std::move(*sample_npz(folder.path())); });
}

TEST(NpzBody, RefusesFourGibibytes) {
  std::vector<NpzEntry> entries;
  entries.push_back({"radiosity.npy", {}, std::int64_t{4} << 30});
  const auto body = NpzBody::of(std::move(entries));
  ASSERT_FALSE(body);
  EXPECT_EQ(body.error().fault, api::Fault::out_of_resources);
}

}  // namespace
}  // namespace server
