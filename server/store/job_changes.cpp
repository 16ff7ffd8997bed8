// The part of JobStore that changes a job as its owner wishes.
#include "server/store/job_store.h"

namespace server {
namespace {

using api::Fault;
using api::JobEvent;
using api::JobState;

template <class Given, class Kept>
void take(const api::Setting<Given>& setting, std::int64_t unit, std::optional<Kept>& kept) {
  if (!setting.given) return;
  kept.reset();
  if (setting.value) kept = static_cast<Kept>(*setting.value) * unit;
}

api::Error cannot(JobState state, JobEvent event) {
  const std::string still = state == JobState::pause_requested ? "still being paused" : "";
  return {Fault::wrong_state, "the job is " + (still.empty() ? std::string(api::name_of(state)) : still) +
                                  "; it cannot take '" + std::string(api::name_of(event)) + "' now"};
}

}  // namespace

// It takes its place anew; what it knew of its last attempt is over.
api::Status JobStore::enter_queue(std::int64_t seq) {
  Statement update = database_.prepare(
      "UPDATE job SET queued_ms = ?, not_before_ms = 0, stage = NULL, stage_fraction = 0, fraction = 0, "
      "progress_message = '', seconds_left = NULL WHERE seq = ?");
  return update.bind(clock_()).bind(seq).run();
}

api::Result<Job> JobStore::wish(std::string_view id, JobEvent event, const StepReason& why) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  const auto job = job_in(database_, id);
  if (!job) return job;
  const auto to = api::after(job->state, event);
  if (!to) return cannot(job->state, event);
  // Asking twice is no error: the second request may be the first one's repetition.
  if (*to == job->state) return job;

  if (const api::Status stepped = step({job->seq, job->state, *to, why}); !stepped) return stepped.error();
  if (*to == JobState::queued)
    if (const api::Status entered = enter_queue(job->seq); !entered) return entered.error();
  if (event == JobEvent::retry) {
    // All chances anew; a deadline that has passed would end it at once.
    Statement anew = database_.prepare(
        "UPDATE job SET attempts_without_progress = 0, best_fraction = 0, run_ms = 0, report = NULL, "
        "forgiven_attempt = attempt, "
        "deadline_ms = CASE WHEN deadline_ms > ? THEN deadline_ms END WHERE seq = ?");
    if (const api::Status done = anew.bind(clock_()).bind(job->seq).run(); !done) return done.error();
  }
  auto changed = job_in(database_, id);
  if (!changed) return changed;
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return changed;
}

api::Status JobStore::write_settings(const Job& job) {
  const JobSettings& settings = job.settings;
  Statement update = database_.prepare(
      "UPDATE job SET name = ?, priority = ?, deadline_ms = ?, max_run_ms = ?, ttl_ms = ?, pinned = ?, "
      "version = version + 1, updated_ms = ? WHERE seq = ?");
  update.bind(settings.name).bind(std::int64_t{settings.priority}).bind_optional(settings.deadline_ms);
  update.bind_optional(settings.max_run_ms).bind_optional(settings.ttl_ms);
  update.bind(std::int64_t{settings.pinned}).bind(clock_()).bind(job.seq);
  if (api::Status done = update.run(); !done) return done;
  Statement labels = database_.prepare("DELETE FROM job_label WHERE job_seq = ?");
  if (api::Status done = labels.bind(job.seq).run(); !done) return done;
  return insert_labels(job.seq, settings.labels);
}

api::Result<Job> JobStore::change(std::string_view id, const api::JobOptions& options,
                                  std::optional<std::int64_t> version) {
  const std::lock_guard lock(mutex_);
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  auto job = job_in(database_, id);
  if (!job) return job;
  if (version && *version != job->version)
    return api::Error{Fault::changed, "the job is at version " + std::to_string(job->version) +
                                          " by now, not at " + std::to_string(*version)};
  apply(options, job->settings);
  if (const api::Status done = write_settings(*job); !done) return done.error();
  auto changed = job_in(database_, id);
  if (!changed) return changed;
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return changed;
}

void apply(const api::JobOptions& options, JobSettings& settings) {
  constexpr std::int64_t kSecondMs = 1000;
  if (options.name) settings.name = *options.name;
  if (options.priority) settings.priority = *options.priority;
  if (options.labels) settings.labels = *options.labels;
  if (options.pinned) settings.pinned = *options.pinned;
  take(options.deadline_ms, 1, settings.deadline_ms);
  take(options.max_run_seconds, kSecondMs, settings.max_run_ms);
  take(options.ttl_seconds, kSecondMs, settings.ttl_ms);
}

}  // namespace server
