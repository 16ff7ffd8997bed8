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
  if (api::Status taken = take_up_orphans(); !taken) return taken;
  thread_ = std::thread([this] { run(); });
  return api::Done{};
}

void Supervisor::stop() {
  stopping_ = true;
  bell_.ring();
  if (thread_.joinable()) thread_.join();
}

api::Status Supervisor::take_up_orphans() {
  const auto orphans = jobs_.orphans();
  if (!orphans) return orphans.error();
  for (const Orphan& orphan : *orphans) {
    // Dead first, queued after: two workers must never share a job's folder.
    if (orphan.worker)
      if (api::Status dead = kill_and_confirm(*orphan.worker); !dead) return dead;
    if (api::Status taken = jobs_.take_up_again(orphan); !taken) return taken;
    log_line(orphan.job.id + " was " + std::string(api::name_of(orphan.job.state)) +
             " when the last server ended; taken up again");
  }
  return api::Done{};
}

void Supervisor::run() {
  while (!stopping_) {
    const auto claim = jobs_.claim();
    if (!claim) log_line("cannot take a job: " + claim.error().message);
    if (claim && *claim)
      run_one(**claim);
    else
      rest();
  }
}

void Supervisor::run_one(const Claim& claim) {
  log_line(claim.job.id + " attempt " + std::to_string(claim.job.attempt) + " begins");
  const AttemptOutcome outcome = run_attempt(jobs_, claim, rules_, bell_, stopping_);
  // The database may be unable to write for a while (full disk). The job must not stay `running` without a
  // worker, so this is tried until it is written or we end; then the next start takes the job up.
  for (;;) {
    const api::Status ended = jobs_.end_attempt(claim.lease, outcome);
    if (ended || ended.error().fault == api::Fault::wrong_state) break;
    log_line(claim.job.id + " cannot record the end of an attempt: " + ended.error().message);
    if (stopping_) break;
    rest();
  }
  const auto job = jobs_.job(claim.job.id);
  if (job) log_line(job->id + " is " + std::string(api::name_of(job->state)) + " " + job->reason);
}

void Supervisor::rest() {
  pollfd event{bell_.descriptor(), POLLIN, 0};
  (void)::poll(&event, 1, static_cast<int>(kRest.count()));
  bell_.clear();
}

}  // namespace server
