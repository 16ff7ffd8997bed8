// What a process in the sandbox can still do, tried by a program that does its worst.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "engine/worker/landlock.h"
#include "engine/worker/supervision.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

class Sandbox : public testing::Test {
 protected:
  void SetUp() override {
    write(job() / "input/scene.obj", "v 0 0 0\n");
    fs::create_directories(job() / "artefacts");
    fs::create_directories(job() / "views");
    write(outside() / "secret", "of another job");
    run();
  }
  void run(const std::string& which = "run", const std::string& starter = "") {
    outcome_.clear();
    const std::string command =
        starter + " " + KEYLUME_SANDBOXED + " " + job().string() + " " + outside().string() + " " + which;
    const std::unique_ptr<FILE, int (*)(FILE*)> output(popen(command.c_str(), "r"), pclose);
    char line[256];
    while (output && std::fgets(line, sizeof line, output.get()))
      if (const std::string text = line; text.find(": ") != text.npos)
        outcome_[text.substr(0, text.find(": "))] =
            text.substr(text.find(": ") + 2, text.size() - text.find(": ") - 3);
  }
  fs::path job() const { return folder_.path() / "job"; }
  fs::path outside() const { return folder_.path() / "other"; }
  void expect(const std::string& outcome, std::initializer_list<const char*> names) {
    for (const char* name : names) EXPECT_EQ(outcome_[name], outcome) << name;
  }
  bool has(const char* part) { return outcome_["in force"].find(part) != std::string::npos; }

  tests::TemporaryFolder folder_;
  std::map<std::string, std::string> outcome_;
};

TEST_F(Sandbox, ReachesNoFileOutsideTheJob) {
  if (engine::landlock_version() == 0) GTEST_SKIP() << "the kernel has no Landlock";
  EXPECT_TRUE(has("landlock")) << outcome_["in force"];
  expect("EACCES", {"read a system file", "list the root", "read outside", "read outside by dots",
                    "write outside", "remove outside", "link to outside", "make a device"});
  EXPECT_NE(outcome_["read another process"], "done");
  EXPECT_NE(outcome_["run a program"], "done");
  EXPECT_NE(outcome_["move in from outside"], "done");
  EXPECT_NE(outcome_["truncate outside"], "done");
  std::string secret;
  std::getline(std::ifstream(outside() / "secret"), secret);
  EXPECT_EQ(secret, "of another job");
  EXPECT_FALSE(fs::exists(outside() / "made"));
}

TEST_F(Sandbox, OpensNoSocketsAndTouchesNoProcesses) {
  if (!has("seccomp")) GTEST_SKIP() << "no system call filter here: " << outcome_["in force"];
  expect("EPERM",
         {"open a socket", "open a unix socket", "open a pair of sockets", "mount", "change a mode outside"});
  expect("EPERM", {"limit the parent", "slow the parent", "move the parent", "reschedule the parent",
                   "slow the parent's disk", "have the parent signaled", "choose a signal"});
  expect("EPERM", {"share memory", "make semaphores", "make a queue", "make a named queue"});
  expect("EPERM", {"truncate outside", "change a time outside"});
  if (!engine::kMemoryCanBeLimited) return;  // sanitizers need what follows for themselves
  expect("EPERM", {"fork", "trace", "signal the parent"});
}

TEST_F(Sandbox, LeavesWhatARunNeeds) {
  expect("done", {"read a library", "read inside", "write inside", "start a thread", "signal itself",
                  "limit itself"});
  if (engine::landlock_version() != 1) expect("done", {"rename inside"});
}

TEST_F(Sandbox, OfAViewLeavesWhatWasRenderedAsItIs) {
  if (engine::landlock_version() == 0) GTEST_SKIP() << "the kernel has no Landlock";
  fs::remove(job() / "artefacts/made");
  run((job() / "views").string());
  expect("done", {"read inside", "write a view"});
  expect("EACCES", {"write inside"});
}

TEST_F(Sandbox, OfARunLeavesTheInputAsItIs) {
  if (engine::landlock_version() == 0) GTEST_SKIP() << "the kernel has no Landlock";
  expect("done", {"read inside", "write inside", "write what is said"});
  expect("EACCES", {"change the input", "cut the input", "add to the input", "remove the input",
                    "write beside the input", "rename the input"});
  EXPECT_NE(outcome_["replace the input"], "done");
  std::string scene;
  std::getline(std::ifstream(job() / "input/scene.obj"), scene);
  EXPECT_EQ(scene, "v 0 0 0");
}

TEST_F(Sandbox, OfACheckWritesWhatItHasFoundAndNothingElse) {
  if (engine::landlock_version() == 0) GTEST_SKIP() << "the kernel has no Landlock";
  fs::remove(job() / "report.json");
  fs::remove(job() / "artefacts/made");
  run("check");
  expect("done", {"read inside", "write what is checked", "make a preview"});
  expect("EACCES", {"write inside", "change the input", "cut the input", "add to the input",
                    "remove the input", "write beside the input", "rename the input"});
  for (const char* name : {"link the input", "replace the input"}) EXPECT_NE(outcome_[name], "done") << name;
  EXPECT_FALSE(fs::exists(job() / "report.json"));
}

// As somebody would leave the folder who wants the next run to write to the input.
TEST_F(Sandbox, OfARunHasFilesAndFoldersOfItsOwn) {
  if (engine::landlock_version() == 0) GTEST_SKIP() << "the kernel has no Landlock";
  fs::remove_all(job() / "artefacts");
  fs::create_directory_symlink("input", job() / "artefacts");
  fs::remove(job() / "progress.ndjson");
  fs::create_hard_link(job() / "input/scene.obj", job() / "progress.ndjson");
  run();
  expect("done", {"read inside", "write inside", "write what is said"});
  expect("EACCES", {"change the input", "add to the input", "remove the input"});
  EXPECT_FALSE(fs::exists(job() / "input/moved"));
  EXPECT_EQ(fs::hard_link_count(job() / "input/scene.obj"), 1u);
}

TEST_F(Sandbox, HoldsAProgramThatIsNotOurs) {
  write(job() / "artefacts/output", "");
  run("within", std::string(KEYLUME_WORKER_UNDER_TEST) + " burn confine --reads " +
                    (job() / "input").string() + " --writes " + (job() / "artefacts/output").string() +
                    " --");
  expect("done", {"read a library", "read inside", "start a thread", "signal itself"});
  if (engine::kMemoryCanBeLimited)
    expect("EPERM", {"open a socket", "open a unix socket", "fork", "run a program", "trace"});
  if (engine::landlock_version() == 0) return;
  expect("EACCES", {"read a system file", "list the root", "read outside", "write outside", "remove outside",
                    "write inside", "write a view", "change the input", "write beside the input"});
}

TEST_F(Sandbox, LimitsFilesInSizeAndNumber) {
  expect("EFBIG", {"write a huge file"});
  expect("EMFILE", {"open many files"});
  EXPECT_NE(outcome_["gain a user"], "done");
}

}  // namespace
