#include "server/workers/supervisor.h"

#include <poll.h>

#include <chrono>
#include <string>
#include <utility>

#include "server/log.h"

namespace server {
namespace {

// The bell tells of new work; this only bounds how long a job that waits for disk space waits too long.
constexpr std::chrono::milliseconds kRest{1000};

}  // namespace

Supervisor::Supervisor(JobService& jobs, const Doorbell& bell, WorkerRules rules)
    : jobs_(jobs), bell_(bell), rules_(std::move(rules)) {}

api::Status Supervisor::start() {
  auto orphans = jobs_.orphans();
  if (!orphans) return orphans.error();
  orphans_ = std::move(*orphans);
  catch_up();
  thread_ = std::thread([this] { run(); });
  return api::Done{};
}

void Supervisor::stop() {
  stopping_ = true;
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

// The database may be unable to write for a while (full disk). That must neither end the service nor hold up
// the other jobs; a job whose end is not written stays `running` until then, or until the next start.
void Supervisor::catch_up() {
  std::erase_if(orphans_, [this](const Orphan& orphan) { return take_up(orphan); });
  std::erase_if(unrecorded_, [this](const EndedAttempt& ended) { return record(ended); });
  catch_up_at_ = SteadyClock::now() + rules_.retry_every;
}

bool Supervisor::take_up(const Orphan& orphan) {
  // Dead first, queued after: two workers must never share a job's folder.
  api::Status taken = orphan.worker ? kill_and_confirm(*orphan.worker) : api::Status(api::Done{});
  if (taken) taken = jobs_.take_up_again(orphan);
  if (!taken && taken.error().fault != api::Fault::wrong_state) {
    complain(orphan.job.id + " cannot be taken up again yet: " + taken.error().message);
    return false;
  }
  log_line(orphan.job.id + " was " + std::string(api::name_of(orphan.job.state)) +
           " when the last server ended; taken up again");
  return true;
}

bool Supervisor::record(const EndedAttempt& ended) {
  const api::Status recorded = jobs_.end_attempt(ended.lease, ended.outcome);
  if (!recorded && recorded.error().fault != api::Fault::wrong_state) {
    complain(ended.id + " cannot record the end of an attempt yet: " + recorded.error().message);
    return false;
  }
  const auto job = jobs_.job(ended.id);
  if (!job) return true;
  const std::string why = job->reason.empty() ? "" : " (" + job->reason + ")";
  log_line(job->id + ": " + std::string(api::name_of(job->state)) + why);
  return true;
}

void Supervisor::complain(const std::string& trouble) {
  if (trouble != last_complaint_) log_line(trouble);
  last_complaint_ = trouble;
}

void Supervisor::run() {
  while (!stopping_) {
    if (SteadyClock::now() >= catch_up_at_) catch_up();
    const auto claim = jobs_.claim();
    if (!claim) complain("cannot take a job: " + claim.error().message);
    if (claim && *claim)
      run_one(**claim);
    else
      rest();
  }
}

void Supervisor::run_one(const Claim& claim) {
  log_line(claim.job.id + " attempt " + std::to_string(claim.job.attempt) + " begins");
  EndedAttempt ended{claim.job.id, claim.lease, run_attempt(jobs_, claim, rules_, bell_, stopping_)};
  if (!record(ended)) unrecorded_.push_back(std::move(ended));
}

void Supervisor::rest() {
  pollfd event{bell_.descriptor(), POLLIN, 0};
  (void)::poll(&event, 1, static_cast<int>(kRest.count()));
  bell_.clear();
}

}  // namespace server
