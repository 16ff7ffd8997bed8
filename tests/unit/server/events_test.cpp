// News of jobs: read beside the writing connection, waited for, and streamed to listeners.
#include "server/events/event_hub.h"

#include <map>

#include "api/json/json_text.h"
#include "server/http/routes.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

/// What a stream of events says, taken apart.
struct Said {
  std::vector<std::int64_t> ids;
  std::vector<std::string> states;
  std::vector<std::string> progress;  ///< the data
};

Said read_stream(const std::string& text) {
  Said said;
  std::size_t at = 0;
  for (std::size_t end; (end = text.find("\n\n", at)) != text.npos; at = end + 2) {
    const std::string block = text.substr(at, end - at);
    const std::size_t data = block.find("data: ");
    if (data == block.npos) continue;
    const auto json = api::parse_json(block.substr(data + 6), "event");
    EXPECT_TRUE(json) << block;
    if (block.find("event: progress") != block.npos) {
      said.progress.push_back(block.substr(data + 6));
      continue;
    }
    EXPECT_EQ(block.rfind("id: ", 0), 0u) << block;
    said.ids.push_back(std::atoll(block.c_str() + 4));
    said.states.push_back(json->at("state"));
  }
  return said;
}

class EventsTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    watch();
  }
  void TearDown() override {
    if (hub_) hub_->stop();
  }

  void watch(EventRules rules = {std::chrono::milliseconds(5), 2}) {
    auto reader = EventReader::open(folder_->database());
    ASSERT_TRUE(reader) << reader.error().message;
    reader_ = std::move(*reader);
    hub_ = std::make_unique<EventHub>(*reader_, rules);
    ASSERT_TRUE(hub_->start([this](const JobEvent& event) {
      const std::lock_guard lock(mutex_);
      told_.push_back(event.id);
    }));
    router_ = std::make_unique<Router>();
    add_event_routes(*router_, *jobs_, *hub_);
  }
  void restart_all() {
    hub_->stop();
    hub_.reset();
    reader_.reset();
    restart();
    watch();
  }

  HttpAnswer ask(const std::string& path, const std::string& last = "",
                 std::function<bool()> still_allowed = {}) {
    HttpRequest request{"GET", path, {}, {}};
    request.still_allowed = std::move(still_allowed);
    request.header = [last](std::string_view name) -> std::optional<std::string> {
      return name == "Last-Event-ID" && !last.empty() ? std::optional(last) : std::nullopt;
    };
    return router_->answer(request);
  }
  /// What comes until the end of the stream, or until `enough` says so.
  static std::string listen(const HttpAnswer& answer, const std::function<bool(const std::string&)>& enough) {
    std::string text;
    for (int i = 0; i < 200; ++i) {
      std::string piece;
      const bool more = answer.stream(piece);
      text += piece;
      if (!more || enough(text)) return text;
    }
    ADD_FAILURE() << "no end: " << text;
    return text;
  }
  static std::string to_end(const HttpAnswer& answer) {
    return listen(answer, [](const std::string&) { return false; });
  }
  std::string path_of(const Job& submitted) { return "/v1/jobs/" + submitted.id + "/events"; }

  /// queued -> running -> progress -> failed
  void run_to_failure(const Claim& claimed) {
    ASSERT_TRUE(store_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.25, "half", 3.0}));
    ASSERT_TRUE(store_->fail(claimed.lease, {"invalid_input", "no"}, {}, ""));
  }

  std::mutex mutex_;
  std::vector<std::int64_t> told_;
  std::unique_ptr<EventReader> reader_;
  std::unique_ptr<EventHub> hub_;
  std::unique_ptr<Router> router_;
};

TEST_F(EventsTest, AJobsStreamTellsItsWholeStoryAndEndsWithIt) {
  const Job submitted = submit();
  const Claim claimed = claim();
  const HttpAnswer answer = ask(path_of(submitted));
  ASSERT_TRUE(answer.stream);
  EXPECT_EQ(answer.content_type, "text/event-stream");
  std::string text = listen(answer, [](const std::string& t) { return t.find("running") != t.npos; });
  EXPECT_TRUE(text.starts_with("retry: 3000\n\n")) << text;
  ASSERT_TRUE(store_->record_progress(claimed.lease, {api::Stage::solve, 0.5, 0.25, "half", 3.0}));
  text += listen(answer, [](const std::string& t) { return t.find("\"stage\":\"solve\"") != t.npos; });
  ASSERT_TRUE(store_->fail(claimed.lease, {"invalid_input", "no"}, {}, ""));
  text += to_end(answer);
  const Said said = read_stream(text);
  EXPECT_EQ(said.states, (std::vector<std::string>{"queued", "running", "failed"}));
  EXPECT_NE(said.progress.back().find("\"fraction\":0.25"), std::string::npos);
  EXPECT_TRUE(std::is_sorted(said.ids.begin(), said.ids.end()));
}

TEST_F(EventsTest, AListenerThatComesBackMissesNothingAndHearsNothingTwice) {
  const Job submitted = submit();
  const Said before = read_stream(
      listen(ask(path_of(submitted)), [](const std::string& t) { return t.find("queued") != t.npos; }));
  restart_all();
  run_to_failure(claim());
  const Said after = read_stream(to_end(ask(path_of(submitted), std::to_string(before.ids.back()))));
  EXPECT_EQ(before.states, (std::vector<std::string>{"queued"}));
  EXPECT_EQ(after.states, (std::vector<std::string>{"running", "failed"}));
  EXPECT_GT(after.ids.front(), before.ids.back());
  EXPECT_EQ(ask(path_of(submitted), std::to_string(after.ids.back())).status, 204) << "it is over";
}

TEST_F(EventsTest, TheStreamOfAllJobsBeginsNowOrWhereItsListenerWas) {
  const Job first = submit();
  const HttpAnswer now = ask("/v1/events");
  const HttpAnswer from_start = ask("/v1/events", "0");
  const Job second = submit();
  const auto both = [&](const std::string& t) { return t.find(second.id) != t.npos; };
  const std::string news = listen(now, both);
  EXPECT_EQ(news.find(first.id), std::string::npos) << news;
  EXPECT_NE(listen(from_start, both).find(first.id), std::string::npos);
}

TEST_F(EventsTest, ManyEventsComeInPagesWithoutAGap) {
  for (int i = 0; i < 250; ++i) {
    const std::string id = new_job_id(now_ms_ + i);
    NewJob job;
    job.id = id;
    ASSERT_TRUE(store_->insert(job));
  }
  const std::string last = std::to_string(*reader_->newest());
  const Said said = read_stream(listen(
      ask("/v1/events", "0"), [&](const std::string& t) { return t.find("id: " + last + "\n") != t.npos; }));
  ASSERT_EQ(said.ids.size(), 250u);
  for (std::size_t i = 1; i < said.ids.size(); ++i) EXPECT_EQ(said.ids[i], said.ids[i - 1] + 1);
}

TEST_F(EventsTest, PlacesForListenersAreFewAndComeFree) {
  {
    const HttpAnswer first = ask("/v1/events");
    const HttpAnswer second = ask("/v1/events");
    const HttpAnswer third = ask("/v1/events");
    EXPECT_EQ(third.status, 503);
    EXPECT_EQ(third.headers.back().first, "Retry-After");
    EXPECT_EQ(hub_->listeners(), 2u);
  }
  EXPECT_EQ(hub_->listeners(), 0u);
  EXPECT_EQ(ask("/v1/events").status, 200);
}

TEST_F(EventsTest, WhatIsNoIdOrNoJobIsRefused) {
  EXPECT_EQ(ask("/v1/events", "x").status, 400);
  EXPECT_EQ(ask("/v1/events", "-1").status, 400);
  EXPECT_EQ(ask("/v1/events", "99999999999999999999").status, 400);
  EXPECT_EQ(ask("/v1/jobs/none/events").status, 404);
}

TEST_F(EventsTest, StoppingEndsEveryStreamAtOnce) {
  const HttpAnswer answer = ask("/v1/events");
  std::string piece;
  ASSERT_TRUE(answer.stream(piece));
  hub_->stop();
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_FALSE(answer.stream(piece));
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::milliseconds(500));
}

TEST_F(EventsTest, TheHubTellsOfEveryEventOnceAndInOrder) {
  for (int i = 0; i < 20; ++i) submit();
  const auto all = [&] {
    const std::lock_guard lock(mutex_);
    return told_.size() == 20;
  };
  for (int i = 0; i < 500 && !all(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const std::lock_guard lock(mutex_);
  ASSERT_EQ(told_.size(), 20u);
  for (std::size_t i = 1; i < told_.size(); ++i) EXPECT_EQ(told_[i], told_[i - 1] + 1);
}

TEST_F(EventsTest, AReadingConnectionCannotWrite) {
  auto database = Database::open_to_read(folder_->database());
  ASSERT_TRUE(database);
  EXPECT_FALSE(database->execute("DELETE FROM job"));
  EXPECT_FALSE(Database::open_to_read(folder_->database().parent_path() / "none.db"));
}

TEST_F(EventsTest, AListenerIsToldOfAJobThatWasRemovedAlsoAfterItIsGone) {
  const Job gone = submit();
  const std::int64_t before = *reader_->newest();
  const HttpAnswer live = ask("/v1/events");
  run_to_failure(claim());
  ASSERT_TRUE(jobs_->remove(gone.id));
  const auto until_removed = [](const std::string& text) { return text.find("event: removed") != text.npos; };
  EXPECT_NE(listen(live, until_removed).find(gone.id), std::string::npos);
  restart_all();
  ASSERT_TRUE(jobs_->clean_up());
  const std::string later = listen(ask("/v1/events", std::to_string(before)), until_removed);
  EXPECT_NE(later.find("\"job\":\"" + gone.id + "\""), std::string::npos) << later;
  const std::int64_t removed = *reader_->newest();
  EXPECT_TRUE(reader_->of_owner_after("somebody else", before, 10)->events.empty());
  submit();
  EXPECT_GT(*reader_->newest(), removed) << "its number is not used again";
}

TEST_F(EventsTest, AStreamEndsSoonAfterItsTokenIsNoLongerGood) {
  hub_->stop();
  watch({std::chrono::milliseconds(5), 2, std::chrono::milliseconds(0)});
  bool allowed = true;
  const HttpAnswer answer = ask("/v1/events", "", [&] { return allowed; });
  ASSERT_TRUE(answer.stream);
  const Job seen = submit();
  (void)listen(answer, [&](const std::string& text) { return text.find(seen.id) != text.npos; });
  allowed = false;
  const Job unseen = submit();
  EXPECT_EQ(to_end(answer).find(unseen.id), std::string::npos);
}

TEST_F(EventsTest, AStreamEndsAfterItsTimeAndSaysFromWhereToGoOn) {
  hub_->stop();
  watch({std::chrono::milliseconds(5), 2, std::chrono::seconds(2), std::chrono::milliseconds(0)});
  submit();
  const std::string text = to_end(ask("/v1/events"));
  EXPECT_NE(text.find("id: " + std::to_string(*reader_->newest()) + "\n\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace server
