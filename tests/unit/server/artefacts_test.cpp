#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>

#include "server/artefacts/npy_slice.h"
#include "server/artefacts/verify.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

TEST(PlainPath, IsOneThatCannotLeaveItsFolder) {
  for (const char* path : {"a", "a.png", "images/front/0000.png", "..a", "a..b", "-"})
    EXPECT_TRUE(is_plain_relative_path(path)) << path;
  for (const char* path :
       {"", "/", "/a", "a/", "a//b", ".", "..", "../a", "a/../b", "a/..", "a/./b", "a\\b", "a\nb"})
    EXPECT_FALSE(is_plain_relative_path(path)) << path;
  EXPECT_FALSE(is_plain_relative_path(std::string_view("a\0b", 3)));
  EXPECT_FALSE(is_plain_relative_path(std::string(513, 'a')));
}

TEST(OpenBelow, FollowsNoLinkAndOpensNothingButFiles) {
  const TemporaryFolder folder;
  const std::filesystem::path root = folder.path() / "root";
  write_text(root / "sub/file", "inside");
  write_text(folder.path() / "secret", "outside");
  std::filesystem::create_symlink("../secret", root / "link");
  std::filesystem::create_directory_symlink("..", root / "up");
  ASSERT_EQ(::mkfifo((root / "fifo").c_str(), 0600), 0);
  EXPECT_TRUE(open_below(root, "sub/file"));
  for (const char* path : {"link", "up/secret", "fifo", "sub", "none", "sub/file/more"}) {
    const auto opened = open_below(root, path);
    ASSERT_FALSE(opened) << path;
    EXPECT_EQ(opened.error().fault, api::Fault::not_found) << path;
  }
}

TEST(ReadBelow, RefusesAFileLargerThanAllowed) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "12345");
  EXPECT_EQ(*read_below(folder.path(), "file", 5), "12345");
  EXPECT_FALSE(read_below(folder.path(), "file", 4));
}

// FIPS 180-2, appendix B.
TEST(Sha256, AgreesWithTheStandardsExamples) {
  EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_of(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  const TemporaryFolder folder;
  write_text(folder.path() / "file", std::string(1'000'000, 'a'));
  EXPECT_EQ(*sha256_of(*open_below(folder.path(), "file")), sha256_of(std::string(1'000'000, 'a')));
}

TEST(VerifyFiles, FindsEveryLie) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a", "abc");
  std::filesystem::create_symlink("a", folder.path() / "link");
  const std::string hash = sha256_of("abc");
  EXPECT_TRUE(verify_files(folder.path(), {{"a", 3, hash}}));
  EXPECT_FALSE(verify_files(folder.path(), {{"a", 4, hash}})) << "size";
  EXPECT_FALSE(verify_files(folder.path(), {{"a", 3, sha256_of("abd")}})) << "hash";
  EXPECT_FALSE(verify_files(folder.path(), {{"b", 3, hash}})) << "no such file";
  EXPECT_FALSE(verify_files(folder.path(), {{"link", 3, hash}})) << "a link";
  EXPECT_FALSE(verify_files(folder.path(), {{"../" + folder.path().filename().string() + "/a", 3, hash}}));
  EXPECT_FALSE(verify_files(folder.path(), {{"a", 3, hash}, {"a", 3, hash}})) << "twice";
}

/// A .npy file of shape (frames, patches, 3) whose floats count up from 0.
std::string npy_bytes(int frames, int patches, std::string_view descr = "<f4") {
  std::string header = "{'descr': '" + std::string(descr) + "', 'fortran_order': False, 'shape': (" +
                       std::to_string(frames) + ", " + std::to_string(patches) + ", 3), }";
  header.append(128 - 10 - 1 - header.size(), ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size());
  bytes += '\0';
  bytes += header;
  for (int i = 0; i < frames * patches * 3; ++i) {
    const float value = static_cast<float>(i);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

TEST(NpySlice, IsTheFrameAsAnArrayOfItsOwn) {
  const TemporaryFolder folder;
  write_text(folder.path() / "r.npy", npy_bytes(4, 5));
  const auto file = open_below(folder.path(), "r.npy");
  ASSERT_TRUE(file);
  const auto slice = frame_slice(*file, 2);
  ASSERT_TRUE(slice) << slice.error().message;
  EXPECT_EQ(slice->bytes, 5 * 3 * 4);
  EXPECT_EQ(slice->header.size() % 64, 0u) << "NumPy wants the data aligned";
  EXPECT_NE(slice->header.find("'shape': (5, 3)"), std::string::npos);
  float first = -1;
  ASSERT_EQ(::pread(file->get(), &first, sizeof first, slice->offset), 4);
  EXPECT_EQ(first, 2 * 5 * 3);
  EXPECT_EQ(frame_slice(*file, 4).error().fault, api::Fault::not_found);
}

TEST(NpySlice, RefusesOtherArraysAndFilesCutShort) {
  const TemporaryFolder folder;
  const std::string good = npy_bytes(4, 5);
  const std::string cases[]{
      npy_bytes(4, 5, "<f8"), good.substr(0, good.size() - 1), good.substr(0, 40), good.substr(0, 5), "",
      std::string(200, 'x')};
  for (const std::string& bytes : cases) {
    write_text(folder.path() / "r.npy", bytes);
    const auto file = open_below(folder.path(), "r.npy");
    ASSERT_TRUE(file);
    EXPECT_FALSE(frame_slice(*file, 0)) << bytes.size();
  }
}

TEST(DataFolder, IsOfOneServerAtATimeAndNamesTheOther) {
  const TemporaryFolder folder;
  auto first = DataFolder::open(folder.path() / "data");
  ASSERT_TRUE(first) << first.error().message;
  const auto second = DataFolder::open(folder.path() / "data");
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().fault, api::Fault::wrong_state);
  EXPECT_NE(second.error().message.find(std::to_string(::getpid())), std::string::npos)
      << second.error().message;
  { const DataFolder released = std::move(*first); }
  EXPECT_TRUE(DataFolder::open(folder.path() / "data"));
}

TEST(DataFolder, RemovesUploadsAndFoldersThatNoJobOwns) {
  const TemporaryFolder folder;
  const auto data = DataFolder::open(folder.path());
  ASSERT_TRUE(data);
  write_text(data->upload("job_1") / "input/scene.obj", "v");
  write_text(data->job("job_2") / "input/scene.obj", "v");
  write_text(data->job("job_3") / "input/scene.obj", "v");
  const std::string known[]{"job_3"};
  ASSERT_TRUE(data->remove_leftovers(known));
  EXPECT_FALSE(std::filesystem::exists(data->upload("job_1")));
  EXPECT_FALSE(std::filesystem::exists(data->job("job_2")));
  EXPECT_TRUE(std::filesystem::exists(data->job("job_3") / "input/scene.obj"));
}

TEST(RemoveTree, NeedsNoMoreDescriptorsForDeeperFolders) {
  const TemporaryFolder folder;
  const std::filesystem::path top = folder.path() / "top", before = std::filesystem::current_path();
  std::filesystem::create_directory(top);
  std::filesystem::current_path(top);
  for (int i = 0; i < 1500; ++i) {
    ASSERT_EQ(::mkdir("in", 0700), 0);
    std::ofstream("beside") << "x";
    ASSERT_EQ(::chdir("in"), 0);
  }
  std::filesystem::current_path(before);
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  rlimit few = limit;
  few.rlim_cur = 64;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
  const api::Status removed = remove_tree(top);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  EXPECT_TRUE(removed) << removed.error().message;
  EXPECT_FALSE(std::filesystem::exists(top));
}

TEST(RemoveTree, OpensWhatIsClosedAndFollowsNoLink) {
  const TemporaryFolder folder;
  write_text(folder.path() / "kept/file", "x");
  const std::filesystem::path top = folder.path() / "top";
  write_text(top / "a/b/c/file", "x");
  write_text(top / ".gone.0", "in the way");
  std::filesystem::create_directory_symlink(folder.path() / "kept", top / "a/link");
  for (const char* closed : {"a/b/c", "a/b", "a"})
    std::filesystem::permissions(top / closed, std::filesystem::perms::none);
  const api::Status removed = remove_tree(top);
  EXPECT_TRUE(removed) << removed.error().message;
  EXPECT_FALSE(std::filesystem::exists(top));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "kept/file"));
  EXPECT_TRUE(remove_tree(top)) << "nothing to do";
  write_text(top, "a file");
  EXPECT_TRUE(remove_tree(top));
  EXPECT_FALSE(std::filesystem::exists(top));
}

TEST(Verify, StopsReadingWhenToldTo) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "x");
  const std::atomic<bool> stopping = true;
  const api::Status read = verify_files(folder.path(), {{"file", 1, sha256_of("x")}}, stopping);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().fault, api::Fault::stopped);
}

TEST(DiskRoom, IsPromisedOnceAndNeverDownToTheLastByte) {
  std::int64_t free = 100 << 20;
  const auto room = std::make_shared<DiskRoom>([&] { return api::Result<std::int64_t>(free); }, 64 << 20);
  RoomClaim first(room), second(room);
  EXPECT_TRUE(first.reserve(20 << 20));
  EXPECT_EQ(second.reserve(20 << 20).error().fault, api::Fault::disk_full) << "promised to the first";
  first.wrote(20 << 20);
  free -= 20 << 20;
  EXPECT_TRUE(second.reserve(16 << 20));
  EXPECT_FALSE(first.make_sure_of(1)) << "more than it had reserved";
  second.release();
  EXPECT_TRUE(first.make_sure_of(1));
}

TEST(DiskRoom, UploadsOfUnknownSizeStopWhereTheRoomEnds) {
  std::int64_t free = 70 << 20;
  const auto room = std::make_shared<DiskRoom>([&] { return api::Result<std::int64_t>(free); }, 64 << 20);
  RoomClaim claims[2]{RoomClaim(room), RoomClaim(room)};
  constexpr std::int64_t kPiece = 1000;
  std::int64_t written = 0;
  for (bool any = true; any;) {
    any = false;
    for (RoomClaim& claim : claims) {
      if (!claim.make_sure_of(kPiece)) continue;
      written += kPiece;
      free -= kPiece;
      claim.wrote(kPiece);
      any = true;
    }
  }
  EXPECT_GE(free, std::int64_t{64 << 20});
  EXPECT_LT(free, std::int64_t{65 << 20});
  EXPECT_GT(written, 5 << 20);
}

TEST(Sha256, OfPiecesIsThatOfTheWhole) {
  Sha256 digest;
  for (int round = 0; round < 2; ++round) {
    digest.begin();
    for (const char* piece : {"one ", "", "two"}) digest.take(piece);
    EXPECT_EQ(digest.end(), sha256_of("one two"));
  }
}

}  // namespace
}  // namespace server
