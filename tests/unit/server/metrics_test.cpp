// Counts and times as Prometheus reads them, and whether the service is ready.
#include <set>
#include <sstream>

#include "api/json/json_text.h"
#include "server/http/ops_routes.h"
#include "server/metrics/histogram.h"
#include "server/metrics/http_metrics.h"
#include "server/metrics/job_metrics.h"
#include "tests/unit/server/service_fixture.h"

namespace server {
namespace {

bool has_line(const std::string& text, const std::string& line) {
  return ("\n" + text).find("\n" + line + "\n") != std::string::npos;
}

TEST(PrometheusText, EscapesWhatLabelsMayHold) {
  PrometheusText text;
  text.family("a_total", "counter", "Of a.");
  text.sample(3, {{"path", "a\\b\"c\nd"}});
  EXPECT_EQ(text.text(),
            "# HELP a_total Of a.\n# TYPE a_total counter\na_total{path=\"a\\\\b\\\"c\\nd\"} 3\n");
}

TEST(PrometheusText, AHistogramsBucketsAreSums) {
  constexpr std::array kBounds{1.0, 2.0};
  Histogram histogram(kBounds);
  for (const double value : {0.5, 1.0, 1.5, 9.0}) histogram.add(value);
  PrometheusText text;
  text.family("t_seconds", "histogram", "T.");
  text.sample(histogram, {{"a", "b"}});
  for (const char* line :
       {"t_seconds_bucket{a=\"b\",le=\"1\"} 2", "t_seconds_bucket{a=\"b\",le=\"2\"} 3",
        "t_seconds_bucket{a=\"b\",le=\"+Inf\"} 4", "t_seconds_sum{a=\"b\"} 12", "t_seconds_count{a=\"b\"} 4"})
    EXPECT_TRUE(has_line(text.text(), line)) << line << "\n" << text.text();
}

JobEvent event_of(std::int64_t job, std::int64_t at_ms, std::optional<std::string> from, std::string to,
                  std::string reason = "") {
  return {0, at_ms, job, "", std::move(from), std::move(to), std::move(reason), ""};
}

TEST(JobMetrics, MeasuresWaitingAndRunningApart) {
  JobMetrics metrics;
  metrics.take(event_of(1, 0, {}, "queued"));
  metrics.take(event_of(1, 4'000, "queued", "running"));
  metrics.take(event_of(1, 10'000, "running", "queued", "worker_crashed"));
  metrics.take(event_of(1, 11'000, "queued", "running"));
  metrics.take(event_of(1, 41'000, "running", "succeeded"));
  metrics.take(event_of(2, 50'000, "running", "failed"));  // began before we looked
  PrometheusText text;
  metrics.write(text);
  for (const char* line : {"keylume_job_wait_seconds_sum 5", "keylume_job_wait_seconds_count 2",
                           "keylume_job_duration_seconds_sum{state=\"succeeded\"} 30",
                           "keylume_job_duration_seconds_sum{state=\"queued\"} 6",
                           "keylume_worker_restarts_total{reason=\"worker_crashed\"} 1"})
    EXPECT_TRUE(has_line(text.text(), line)) << line << "\n" << text.text();
  EXPECT_EQ(text.text().find("failed"), std::string::npos);
}

TEST(JobMetrics, AClockThatWasSetBackMakesNoNegativeTime) {
  JobMetrics metrics;
  metrics.take(event_of(1, 9'000, {}, "queued"));
  metrics.take(event_of(1, 4'000, "queued", "running"));
  PrometheusText text;
  metrics.write(text);
  EXPECT_TRUE(has_line(text.text(), "keylume_job_wait_seconds_sum 0"));
}

TEST(HttpMetrics, CountsByRouteAndStatus) {
  HttpMetrics metrics;
  metrics.count("GET /v1/jobs/{id}", 200, 0.002);
  metrics.count("GET /v1/jobs/{id}", 200, 0.002);
  metrics.count("GET /v1/jobs/{id}", 404, 0.02);
  metrics.count("", 400, 0);
  PrometheusText text;
  metrics.write(text);
  for (const char* line : {"keylume_http_requests_total{route=\"GET /v1/jobs/{id}\",code=\"200\"} 2",
                           "keylume_http_requests_total{route=\"GET /v1/jobs/{id}\",code=\"404\"} 1",
                           "keylume_http_requests_total{route=\"\",code=\"400\"} 1",
                           "keylume_http_request_seconds_bucket{route=\"GET /v1/jobs/{id}\",le=\"0.005\"} 2",
                           "keylume_http_request_seconds_count{route=\"GET /v1/jobs/{id}\"} 3"})
    EXPECT_TRUE(has_line(text.text(), line)) << line << "\n" << text.text();
}

class OpsTest : public ServiceTest {
 protected:
  void SetUp() override {
    ServiceTest::SetUp();
    reader_ = std::move(*EventReader::open(folder_->database()));
    hub_ = std::make_unique<EventHub>(*reader_);
    add_ops_routes(router_, {*jobs_, *store_, *folder_, *hub_, http_, job_times_,
                             [] { return IntegrityReport{}; }, [] { return std::size_t{5}; },
                             [this] {
                               ++asked_;
                               return worker_;
                             }});
  }
  HttpAnswer ask(const std::string& path) {
    HttpRequest request{"GET", path, {}, {}};
    request.header = [](std::string_view) { return std::optional<std::string>(); };
    return router_.answer(request);
  }

  std::unique_ptr<EventReader> reader_;
  std::unique_ptr<EventHub> hub_;
  HttpMetrics http_;
  JobMetrics job_times_;
  api::Status worker_ = api::Done{};
  int asked_ = 0;
  Router router_;
};

TEST_F(OpsTest, ReadinessNamesWhatIsWrongAndDoesNotAskAgainAtOnce) {
  worker_ = api::Error{api::Fault::internal, "/srv/keylume/secret: no such file"};
  for (int i = 0; i < 3; ++i) {
    const HttpAnswer answer = ask("/readyz");
    EXPECT_EQ(answer.status, 503);
    const auto json = api::parse_json(answer.body, "readyz");
    EXPECT_EQ(json->at("status"), "not_ready");
    EXPECT_EQ(json->at("checks").at("worker"), "it cannot be started; the log says why") << "and no path";
    EXPECT_EQ(json->at("checks").at("database"), "ok");
  }
  EXPECT_EQ(asked_, 1);
}

TEST_F(OpsTest, ReadyWhereAllIsWell) {
  EXPECT_EQ(ask("/readyz").status, 200);
}

TEST_F(OpsTest, EverySampleBelongsToAFamilyAndTheGaugesSayWhatIs) {
  submit();
  submit();
  claim();
  const std::string text = ask("/metrics").body;
  for (const char* line : {"keylume_jobs{state=\"queued\"} 1", "keylume_jobs{state=\"running\"} 1",
                           "keylume_uploads_in_flight 5", "keylume_sse_clients 0"})
    EXPECT_TRUE(has_line(text, line)) << line << "\n" << text;
  std::set<std::string> families;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      EXPECT_TRUE(families.insert(line.substr(7, line.find(' ', 7) - 7)).second);
    }
    if (line.starts_with("#")) continue;
    std::string name = line.substr(0, line.find_first_of("{ "));
    for (const char* suffix : {"_bucket", "_sum", "_count"})
      if (name.ends_with(suffix) &&
          families.contains(name.substr(0, name.size() - std::string(suffix).size())))
        name.resize(name.size() - std::string(suffix).size());
    EXPECT_TRUE(families.contains(name)) << line;
  }
  for (const char* name : {"keylume_disk_free_bytes", "keylume_sqlite_wal_bytes", "keylume_build_info",
                           "keylume_gc_last_success_timestamp_seconds", "keylume_job_wait_seconds"})
    EXPECT_TRUE(families.contains(name)) << name;
}

}  // namespace
}  // namespace server
