#include "server/http/ops_routes.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <utility>

#include "api/json/json_text.h"
#include "server/http/problem.h"
#include "server/http/routes.h"
#include "server/log.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

/// Longer than a worker is waited for: a check that hangs that long has an answer.
constexpr std::chrono::seconds kCheckTimeMax{10};

/// The result of a check that strangers may ask for, asked for itself now and then only, by one of them; the
/// others do not wait for a check that takes long.
class Remembered {
 public:
  Remembered(std::function<api::Status()> check, std::chrono::seconds every)
      : check_(std::move(check)), every_(every) {}

  /// Is all well? What is wrong is logged once.
  bool ask() {
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock && answered_) return well_ && !hangs();
    if (!lock) lock.lock();  // there is no answer yet
    const auto now = SteadyClock::now();
    if (!asked_ || now - *asked_ >= every_) {
      begun_at_ = now;
      checking_ = true;
      const api::Status status = check_();
      checking_ = false;
      const std::string trouble = status ? "" : status.error().message;
      if (!trouble.empty() && trouble != trouble_) log_event("not ready", {{"why", trouble}});
      trouble_ = trouble;
      well_ = trouble_.empty();
      asked_ = SteadyClock::now();
      answered_ = true;
    }
    return well_;
  }

 private:
  bool hangs() const { return checking_ && SteadyClock::now() - begun_at_.load() >= kCheckTimeMax; }

  const std::function<api::Status()> check_;
  const std::chrono::seconds every_;
  std::mutex mutex_;  ///< of what follows
  std::optional<SteadyClock::time_point> asked_;
  std::string trouble_;
  std::atomic<bool> answered_ = false;  ///< and these without it
  std::atomic<bool> well_ = false;
  std::atomic<bool> checking_ = false;
  std::atomic<SteadyClock::time_point> begun_at_{};
};

struct Readiness {
  explicit Readiness(const OpsSources& sources)
      : database([&store = sources.store] { return store.can_write(); }, std::chrono::seconds(1)),
        disk([&folder = sources.folder] { return has_room(folder.uploads()); }, std::chrono::seconds(1)),
        worker(sources.start_worker, std::chrono::seconds(10)) {}

  Remembered database;
  Remembered disk;
  Remembered worker;
};

std::string text_of(const IntegrityReport& integrity) {
  if (!integrity.database.empty()) return "the database is damaged; the log says how";
  if (integrity.damaged_files == 0) return "ok";
  return std::to_string(integrity.damaged_files) + " files of jobs are damaged; the log names them";
}

struct Check {
  const char* name;
  Remembered* check;
  const char* trouble;
};

/// GET /readyz, operationId getReadiness.
HttpAnswer readiness_answer(Readiness& readiness, const IntegrityReport& integrity) {
  bool ready = true;
  api::Json checks;
  // Anybody may ask: what it is exactly, with paths and numbers, is for the log.
  for (const auto& [name, check, trouble] :
       {Check{"database", &readiness.database, "it cannot be written to; the log says why"},
        Check{"disk", &readiness.disk, "the disk is full; the log says how much is needed"},
        Check{"worker", &readiness.worker, "it cannot be started; the log says why"}}) {
    const bool well = check->ask();
    ready = ready && well;
    checks[name] = well ? "ok" : trouble;
  }
  // Other jobs can be rendered whatever one file looks like; on a damaged database nothing is to be built.
  ready = ready && integrity.database.empty();
  checks["integrity"] = text_of(integrity);
  HttpAnswer answer =
      json_answer(api::json_text({{"status", ready ? "ready" : "not_ready"}, {"checks", std::move(checks)}}),
                  ready ? 200 : 503);
  if (!ready) answer.headers.emplace_back("Retry-After", "10");
  return answer;
}

std::int64_t bytes_of(const std::filesystem::path& file) {
  std::error_code error;  // never opened: closing a descriptor would drop SQLite's locks
  const auto bytes = std::filesystem::file_size(file, error);
  return error ? 0 : static_cast<std::int64_t>(bytes);
}

void write_jobs(PrometheusText& text, const OpsSources& sources) {
  text.family("keylume_jobs", "gauge", "Jobs by state.");
  for (const api::JobState state : api::kJobStates)
    if (const auto count = sources.store.count(state))
      text.sample(static_cast<double>(*count), {{"state", api::name_of(state)}});
  sources.job_times.write(text);
  const GarbageReport garbage = sources.jobs.garbage();
  text.family("keylume_gc_last_success_timestamp_seconds", "gauge",
              "When all jobs whose time was over were removed last; 0: not yet.");
  text.sample(static_cast<double>(garbage.last_ms) / 1000.0);
  text.family("keylume_gc_removed_jobs_total", "counter", "Jobs removed because their time was over.");
  text.sample(static_cast<double>(garbage.jobs));
  text.family("keylume_gc_removed_bytes_total", "counter", "Their bytes.");
  text.sample(static_cast<double>(garbage.bytes));
  text.family("keylume_evicted_jobs_total", "counter", "Finished jobs removed to make room for others.");
  text.sample(static_cast<double>(garbage.evicted_jobs));
  text.family("keylume_evicted_bytes_total", "counter", "Their bytes.");
  text.sample(static_cast<double>(garbage.evicted_bytes));
}

void write_service(PrometheusText& text, const OpsSources& sources) {
  text.family("keylume_sse_clients", "gauge", "Listeners to events.");
  text.sample(static_cast<double>(sources.hub.listeners()));
  text.family("keylume_uploads_in_flight", "gauge", "Uploads that come in now.");
  text.sample(static_cast<double>(sources.uploads()));
  text.family("keylume_disk_free_bytes", "gauge", "Free on the file system of the data folder.");
  const auto free = free_bytes(sources.folder.uploads());
  text.sample(free ? static_cast<double>(*free) : -1);
  if (const auto bytes = sources.store.total_bytes()) {
    text.family("keylume_stored_bytes", "gauge", "Of all jobs and blobs, as quotas count them.");
    text.sample(static_cast<double>(*bytes));
  }
  if (const auto bytes = sources.store.blob_bytes()) {
    text.family("keylume_blob_bytes", "gauge", "Of the blobs among them.");
    text.sample(static_cast<double>(*bytes));
  }
  text.family("keylume_sqlite_wal_bytes", "gauge", "Of the database's write-ahead log.");
  text.sample(static_cast<double>(bytes_of(sources.folder.database().string() + "-wal")));
  text.family("keylume_log_lines_lost_total", "counter",
              "Lines that standard error did not take: a full disk, or nobody reads.");
  text.sample(static_cast<double>(log_lines_lost()));
  text.family("keylume_build_info", "gauge", "1; the version is in the label.");
  text.sample(1, {{"version", KEYLUME_VERSION}});
}

void write_integrity(PrometheusText& text, const IntegrityReport& integrity) {
  const auto one = [&](std::string_view name, std::string_view kind, std::string_view help, double value) {
    text.family(name, kind, help);
    text.sample(value);
  };
  one("keylume_integrity_check_timestamp_seconds", "gauge",
      "When the last check of database and files ended; 0: not yet.",
      static_cast<double>(integrity.ended_ms) / 1000.0);
  one("keylume_integrity_round_timestamp_seconds", "gauge",
      "When the last file of all had been looked at; 0: not yet.",
      static_cast<double>(integrity.round_ms) / 1000.0);
  one("keylume_integrity_damaged_files", "gauge", "Files of jobs that are no longer what they were.",
      static_cast<double>(integrity.damaged_files));
  one("keylume_integrity_database_findings", "gauge", "What the last check found wrong with the database.",
      static_cast<double>(integrity.database.size()));
  one("keylume_integrity_checked_files_total", "counter", "Files looked at.",
      static_cast<double>(integrity.files));
  one("keylume_integrity_checked_bytes_total", "counter", "Their bytes.",
      static_cast<double>(integrity.bytes));
}

/// GET /metrics, operationId getMetrics.
HttpAnswer metrics_answer(const OpsSources& sources) {
  HttpAnswer answer;
  answer.content_type = "text/plain; version=0.0.4; charset=utf-8";
  answer.body = metrics_text(sources);
  answer.headers.emplace_back("Cache-Control", "no-store");
  return answer;
}

}  // namespace

std::string metrics_text(const OpsSources& sources) {
  PrometheusText text;
  write_jobs(text, sources);
  sources.http.write(text);
  write_service(text, sources);
  write_integrity(text, sources.integrity());
  return text.text();
}

void add_ops_routes(Router& router, OpsSources sources) {
  const auto readiness = std::make_shared<Readiness>(sources);
  router.add("GET", "/readyz", [readiness, integrity = sources.integrity](const auto&, const auto&) {
    return readiness_answer(*readiness, integrity());
  });
  router.add("GET", "/metrics",
             [sources = std::move(sources)](const auto&, const auto&) { return metrics_answer(sources); });
}

}  // namespace server
