// A data folder, a real database and jobs in them, for the tests of the server.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "server/artefacts/data_folder.h"
#include "server/artefacts/files.h"
#include "server/jobs/job_id.h"
#include "server/jobs/job_service.h"
#include "server/store/job_store.h"
#include "tests/support/temporary_folder.h"

namespace server {

using tests::TemporaryFolder;

inline void write_text(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A data folder and a store that can be closed and opened again, as a restart does.
class ServiceTest : public testing::Test {
 protected:
  void SetUp() override { open(); }

  void open() {
    auto folder = DataFolder::open(temporary_.path() / "data");
    ASSERT_TRUE(folder) << folder.error().message;
    folder_ = std::make_unique<DataFolder>(std::move(*folder));
    auto store = JobStore::open(folder_->database(), [this] { return now_ms_.load(); });
    ASSERT_TRUE(store) << store.error().message;
    store_ = std::move(*store);
    rules_.check = [this](const std::filesystem::path&) { return check_result_; };
    jobs_ = std::make_unique<JobService>(
        *store_, *folder_, rules_, [this] { return now_ms_.load(); },
        [this] { return now_ms_.load() - jumped_ms_.load(); });
  }

  /// As after kill -9: nothing is told, everything is opened anew.
  void restart() {
    jobs_.reset();
    store_.reset();
    folder_.reset();
    open();
  }

  /// What an upload leaves in tmp/ when all parts are in.
  Upload make_upload() {
    Upload upload{new_job_id(now_ms_), {}};
    const std::filesystem::path input = folder_->upload(upload.id) / "input";
    write_text(input / "scene.obj", "v 0 0 0\n");
    write_text(input / "animation.json", R"({"frames": {"count": 3, "fps": 24}, "cameras": {"front":
        {"position": [0, 0, 5], "target": [0, 0, 0]}}, "images": [{"camera": "front"}]})");
    upload.inputs = {{"scene.obj", InputRole::scene, 8}, {"animation.json", InputRole::animation, 100}};
    return upload;
  }

  Job submit() {
    auto job = jobs_->submit(make_upload());
    EXPECT_TRUE(job) << job.error().message;
    return job ? *job : Job{};
  }

  Claim claim() {
    auto claimed = jobs_->claim();
    EXPECT_TRUE(claimed && *claimed);
    return **claimed;
  }

  Job job(const std::string& id) {
    auto found = jobs_->job(id);
    EXPECT_TRUE(found) << found.error().message;
    return found ? *found : Job{};
  }

  TemporaryFolder temporary_;
  std::atomic<std::int64_t> now_ms_ = 1'700'000'000'000;  ///< also read by the supervisor's threads
  std::atomic<std::int64_t> jumped_ms_ = 0;               ///< how far somebody has set the clock forward
  api::Status check_result_ = api::Done{};
  JobRules rules_;
  std::unique_ptr<DataFolder> folder_;
  std::unique_ptr<JobStore> store_;
  std::unique_ptr<JobService> jobs_;
};

}  // namespace server
