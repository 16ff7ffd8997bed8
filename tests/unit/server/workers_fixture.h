// A supervisor with real processes, for the tests of the workers.
#pragma once

#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "server/workers/child_process.h"
#include "server/workers/supervisor.h"
#include "tests/unit/server/service_fixture.h"

namespace server {

inline bool is_alive(pid_t pid) {
  return bool(identity_of(pid));
}

template <class Condition>
bool becomes_true(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class WorkersTest : public ServiceTest {
 protected:
  void SetUp() override {
    auto bell = Doorbell::create();
    ASSERT_TRUE(bell);
    bell_ = std::make_unique<Doorbell>(std::move(*bell));
    rules_.work_arrived = [this] { bell_->ring(); };
    rules_.cancel_requested = [this] { bell_->ring(); };
    worker_rules_.program = KEYLUME_FAKE_WORKER;
    worker_rules_.stop_grace = std::chrono::milliseconds(300);
    worker_rules_.look_every = std::chrono::milliseconds(10);
    worker_rules_.record_every = std::chrono::milliseconds(20);
    ServiceTest::SetUp();
  }

  void TearDown() override { supervisor_.reset(); }

  void start() {
    supervisor_ = std::make_unique<Supervisor>(*jobs_, *bell_, worker_rules_);
    const api::Status started = supervisor_->start();
    ASSERT_TRUE(started) << started.error().message;
  }

  /// A job whose n-th attempt does what the n-th line says.
  Job submit_that_will(std::string_view behaviour) {
    const Upload upload = make_upload();
    write_text(folder_->upload(upload.id) / "behaviour", behaviour);
    auto submitted = jobs_->submit(upload);
    EXPECT_TRUE(submitted) << submitted.error().message;
    return *submitted;
  }

  Job wait_for(const Job& submitted, api::JobState state) {
    EXPECT_TRUE(becomes_true([&] { return job(submitted.id).state == state; }))
        << api::name_of(job(submitted.id).state) << ", not " << api::name_of(state) << ": "
        << job(submitted.id).message;
    return job(submitted.id);
  }

  Job run_to_end(std::string_view behaviour) {
    const Job submitted = submit_that_will(behaviour);
    start();
    EXPECT_TRUE(becomes_true([&] { return api::is_final(job(submitted.id).state); }))
        << api::name_of(job(submitted.id).state);
    return job(submitted.id);
  }

  pid_t worker_of(const Job& submitted) {
    pid_t pid = 0;
    EXPECT_TRUE(becomes_true([&] {
      pid = std::atoi(read_text(jobs_->folder_of(submitted) / "runs").c_str());
      return pid > 0 && job(submitted.id).fraction > 0;
    }));
    return pid;
  }

  std::unique_ptr<Doorbell> bell_;
  WorkerRules worker_rules_;
  std::unique_ptr<Supervisor> supervisor_;
};

}  // namespace server
