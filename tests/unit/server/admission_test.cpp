#include <barrier>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

using api::Fault;

class Admission : public ServiceTest {
 protected:
  // Every check waits until all have begun, so that all were admitted before the first was kept.
  std::map<Fault, int> submit_at_once(int count, const std::string& owner) {
    std::barrier all_here(count);
    rules_.check = [&](const std::filesystem::path&) -> api::Status {
      all_here.arrive_and_wait();
      return api::Done{};
    };
    jobs_ = std::make_unique<JobService>(*store_, *folder_, rules_, [this] { return now_ms_.load(); });
    std::mutex mutex;
    std::map<Fault, int> refused;
    std::vector<std::thread> senders;
    for (int i = 0; i < count; ++i) {
      Upload upload = make_upload();
      upload.owner = owner;
      senders.emplace_back([&, upload] {
        const auto job = jobs_->submit(upload);
        const std::lock_guard lock(mutex);
        if (!job) ++refused[job.error().fault];
      });
    }
    for (std::thread& sender : senders) sender.join();
    return refused;
  }
};

TEST_F(Admission, UploadsThatComeAtOnceDoNotGetPastAQuotaTogether) {
  rules_.bytes_of_one_owner_max = 350;  // three of 108 bytes
  EXPECT_EQ(submit_at_once(8, "anna"), (std::map<Fault, int>{{Fault::over_quota, 5}}));
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 3u);
  rules_.bytes_of_one_owner_max = INT64_MAX;
  rules_.bytes_max = 600;
  EXPECT_EQ(submit_at_once(8, "bert"), (std::map<Fault, int>{{Fault::over_quota, 6}}));
  EXPECT_EQ(jobs_->list({}, 10)->jobs.size(), 5u);
  const auto folders = std::filesystem::directory_iterator(folder_->jobs());
  EXPECT_EQ(std::distance(begin(folders), end(folders)), 5) << "nothing is left of the others";
}

TEST_F(Admission, UploadsThatComeAtOnceDoNotGetPastTheLimitsOfTheQueueTogether) {
  rules_.queued_of_one_owner_max = 3;
  EXPECT_EQ(submit_at_once(8, "anna"), (std::map<Fault, int>{{Fault::too_many, 5}}));
  rules_.queued_max = 5;
  EXPECT_EQ(submit_at_once(8, "bert"), (std::map<Fault, int>{{Fault::out_of_resources, 6}}));
}

}  // namespace
}  // namespace server
