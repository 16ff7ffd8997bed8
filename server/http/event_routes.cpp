// Server-sent events (the event stream format of the HTML standard): what happens to jobs, as it happens.
#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "api/job_status.h"
#include "api/json/json_text.h"
#include "server/http/job_json.h"
#include "server/http/parameters.h"
#include "server/http/problem.h"
#include "server/http/routes.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t kPageEvents = 100;
constexpr std::chrono::seconds kPingEvery{15};
// How long a client that has gone, or a server that is to stop, may stay unnoticed.
constexpr std::chrono::seconds kHubLookUp{1};

bool is_final_state(std::string_view name) {
  const auto state = api::job_state_named(name);
  return state && api::is_final(*state);
}

std::string removal_text(const JobEvent& event) {
  const api::Json data{{"job", event.job_id}, {"at", utc_text(event.at_ms)}};
  return "id: " + std::to_string(event.id) + "\nevent: removed\ndata: " + api::json_text(data) + "\n\n";
}

std::string event_text(const JobEvent& event) {
  if (event.to == kRemoved) return removal_text(event);
  const api::Json data{
      {"job", event.job_id},      {"from", event.from ? api::Json(*event.from) : api::Json(nullptr)},
      {"state", event.to},        {"reason", event.reason},
      {"message", event.message}, {"at", utc_text(event.at_ms)}};
  return "id: " + std::to_string(event.id) + "\nevent: state\ndata: " + api::json_text(data) + "\n\n";
}

/// Without an id: progress is not kept, and after a break the newest says it all.
std::string progress_text(const JobProgress& progress) {
  const api::Json data{
      {"job", progress.job_id},
      {"attempt", progress.attempt},
      {"stage", progress.stage ? api::Json(*progress.stage) : api::Json(nullptr)},
      {"stage_fraction", progress.stage_fraction},
      {"fraction", progress.fraction},
      {"seconds_left", progress.seconds_left ? api::Json(*progress.seconds_left) : api::Json(nullptr)}};
  return "event: progress\ndata: " + api::json_text(data) + "\n\n";
}

/// Whose jobs somebody follows: of one job; of one owner; of all.
struct Followed {
  const Job* job = nullptr;
  std::optional<std::string> owner = std::nullopt;
  std::function<bool()> still_allowed = {};
};

/// One listener's stream. Of one job it ends with the job.
class EventStream {
 public:
  EventStream(JobService& jobs, EventHub& hub, std::shared_ptr<void> place, const Followed& followed,
              std::int64_t last)
      : jobs_(jobs),
        hub_(hub),
        place_(std::move(place)),
        owner_(followed.owner),
        still_allowed_(followed.still_allowed),
        last_(last) {
    if (!followed.job) return;
    job_id_ = followed.job->id;
    job_seq_ = followed.job->seq;
  }

  /// As HttpAnswer::stream wants it.
  bool next(std::string& piece) {
    if (!begun_) piece = "retry: 3000\n\n";
    begun_ = true;
    seen_ = hub_.wait(seen_, kHubLookUp);
    if (hub_.stopped()) return false;
    if (!may_go_on(piece)) return false;
    const auto page = next_page();
    if (!page) return false;  // the client comes back, and asks from where it was
    for (const JobEvent& event : page->events) add(event, piece);
    last_ = page->through;
    const bool caught_up = static_cast<std::int64_t>(page->events.size()) < kPageEvents;
    if (!caught_up) {
      seen_ = 0;  // do not wait for news before the next page
    } else if (job_seq_ && over_) {
      return false;
    } else {
      add_progress(piece);
    }
    return keep_alive(piece);
  }

 private:
  /// A token may be revoked, or expire, while somebody listens.
  bool may_go_on(std::string& piece) {
    const auto now = SteadyClock::now();
    if (now - asked_ >= hub_.rules().ask_again) {
      asked_ = now;
      if (still_allowed_ && !still_allowed_()) return false;
    }
    if (now - begun_at_ < hub_.rules().stream_max) return true;
    piece += "id: " + std::to_string(last_) + "\n\n";  // it may have heard of nothing yet
    return false;
  }

  api::Result<EventPage> next_page() {
    if (owner_) return hub_.reader().of_owner_after(*owner_, last_, kPageEvents);
    auto events = hub_.reader().after(last_, job_seq_, kPageEvents);
    if (!events) return events.error();
    const std::int64_t through = events->empty() ? last_ : events->back().id;
    return EventPage{std::move(*events), through};
  }

  void add(const JobEvent& event, std::string& piece) {
    piece += event_text(event);
    over_ = is_final_state(event.to) || event.to == kRemoved;
    // What the hub saw before the job ended must not follow its end.
    if (over_)
      told_[event.job_seq] = INT64_MAX;
    else
      told_.erase(event.job_seq);
  }

  void add_progress(std::string& piece) {
    std::map<std::int64_t, std::int64_t> told;
    for (const JobProgress& progress : hub_.progress()) {
      if (job_seq_ && progress.job_seq != *job_seq_) continue;
      if (owner_ && progress.owner != *owner_) continue;
      const auto known = told_.find(progress.job_seq);
      const std::int64_t version = known == told_.end() ? -1 : known->second;
      if (progress.version > version) piece += progress_text(progress);
      told.emplace(progress.job_seq, std::max(version, progress.version));
    }
    told_ = std::move(told);
  }

  /// False: the job is gone, and nothing more will come.
  bool keep_alive(std::string& piece) {
    const auto now = SteadyClock::now();
    if (!piece.empty()) {
      spoke_ = now;
    } else if (now - spoke_ >= kPingEvery) {
      if (job_seq_ && !jobs_.job(job_id_)) return false;
      piece = ": ping\n\n";
      spoke_ = now;
    }
    return true;
  }

  JobService& jobs_;
  EventHub& hub_;
  std::shared_ptr<void> place_;
  std::string job_id_;
  std::optional<std::int64_t> job_seq_;
  const std::optional<std::string> owner_;
  const std::function<bool()> still_allowed_;
  std::int64_t last_;                          ///< id of the last event that was looked at
  std::map<std::int64_t, std::int64_t> told_;  ///< by job: version of the progress that was sent
  std::uint64_t seen_ = 0;                     ///< of the hub's news
  bool begun_ = false;
  bool over_ = false;
  const SteadyClock::time_point begun_at_ = SteadyClock::now();
  SteadyClock::time_point spoke_ = begun_at_, asked_ = begun_at_;
};

HttpAnswer stream_answer(std::shared_ptr<EventStream> stream) {
  HttpAnswer answer;
  answer.content_type = "text/event-stream";
  answer.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
  answer.stream = [stream = std::move(stream)](std::string& piece) { return stream->next(piece); };
  return answer;
}

/// Last-Event-ID, not beyond the newest event; `otherwise` where there is none; none where it is no number.
std::optional<std::int64_t> start_of(const HttpRequest& request, std::int64_t newest,
                                     std::int64_t otherwise) {
  const auto header = request.header("Last-Event-ID");
  if (!header || header->empty()) return otherwise;
  const auto id = whole_number(*header);
  if (!id || *id < 0) return std::nullopt;
  return std::min(*id, newest);
}

/// GET /v1/events and /v1/jobs/{id}/events, operationIds followJobs and followJob.
HttpAnswer follow(JobService& jobs, EventHub& hub, const HttpRequest& request, const Followed& followed) {
  const Job* job = followed.job;
  const auto newest = hub.reader().newest();
  if (!newest) return problem(newest.error(), request.path);
  const auto last = start_of(request, *newest, job ? 0 : *newest);
  if (!last)
    return bad_parameter("Last-Event-ID", "not_a_number", "Last-Event-ID must be the id of an event",
                         request.path);
  if (job && api::is_final(job->state)) {
    const auto rest = hub.reader().after(*last, job->seq, 1);
    if (!rest) return problem(rest.error(), request.path);
    // 204 tells a browser to come back no more.
    if (rest->empty()) {
      HttpAnswer nothing;
      nothing.status = 204;
      return nothing;
    }
  }
  auto place = hub.take_place();
  if (!place)
    return problem({api::Fault::out_of_resources, "too many listeners at once; poll the job instead"},
                   request.path);
  return stream_answer(std::make_shared<EventStream>(jobs, hub, std::move(place), followed, *last));
}

}  // namespace

void add_event_routes(Router& router, JobService& jobs, EventHub& hub) {
  router.add("GET", "/v1/events", [&jobs, &hub](const HttpRequest& request, const PathValues&) {
    const auto owner = request.sees_all ? std::nullopt : std::optional(request.owner);
    return follow(jobs, hub, request, {nullptr, owner, request.still_allowed});
  });
  router.add("GET", "/v1/jobs/{id}/events",
             [&jobs, &hub](const HttpRequest& request, const PathValues& values) {
               const auto job = jobs.job(values.at("id"));
               return job ? follow(jobs, hub, request, {&*job, std::nullopt, request.still_allowed})
                          : problem(job.error(), request.path);
             });
}

}  // namespace server
