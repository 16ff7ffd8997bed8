#include "server/workers/supervisor.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include "server/log.h"

namespace server {
namespace {

// The bell tells of new work; this only bounds how long a job that waits for disk space, or a deadline, waits
// too long.
constexpr std::chrono::milliseconds kRest{1000};

}  // namespace

Supervisor::Supervisor(JobService& jobs, const Doorbell& bell, WorkerRules rules)
    : jobs_(jobs),
      bell_(bell),
      rules_(std::move(rules)),
      recorder_(jobs, {rules_.retry_every, rules_.collect_every}, [&bell] { bell.ring(); }) {}

api::Status Supervisor::start() {
  auto orphans = jobs_.orphans();
  if (!orphans) return orphans.error();
  recorder_.start(std::move(*orphans));
  thread_ = std::thread([this] { run(); });
  return api::Done{};
}

void Supervisor::stop() {
  stopping_ = true;
  bell_.ring();
  if (thread_.joinable()) thread_.join();
  recorder_.stop();
}

void Supervisor::run() {
  auto overdue_at = std::chrono::steady_clock::now();
  while (!stopping_ || !running_.empty()) {
    if (std::chrono::steady_clock::now() >= overdue_at) {
      if (const api::Status failed = jobs_.fail_overdue(); !failed)
        complain("cannot look for jobs that are overdue: " + failed.error().message);
      overdue_at = std::chrono::steady_clock::now() + kRest;
    }
    while (!stopping_ && start_next()) {
    }
    wait();
    look_at_all();
  }
}

WorkerUse Supervisor::use() const {
  WorkerUse use;
  for (const auto& attempt : running_) use.memory_bytes += attempt->memory_bytes();
  use.workers = static_cast<std::int64_t>(running_.size());
  use.cores = use.workers * rules_.cores_per_job;
  return use;
}

bool Supervisor::start_next() {
  if (std::chrono::steady_clock::now() < start_again_at_) return false;
  const WorkerUse used = use();
  const bool alone = running_.empty();
  if (!alone && used.cores + rules_.cores_per_job > rules_.budget.cores) return false;
  auto claim = jobs_.claim({rules_.budget.memory_bytes - used.memory_bytes, alone});
  if (!claim) complain("cannot take a job: " + claim.error().message);
  if (!claim || !*claim) return false;
  log_line((*claim)->job.id + " attempt " + std::to_string((*claim)->job.attempt) + " begins");
  running_.push_back(std::make_unique<RunningAttempt>(jobs_, std::move(**claim), rules_));
  notice_start(running_.back()->why_not_started());
  jobs_.set_use(use());
  return true;
}

// A program that is missing while it is replaced, or no memory for a process: no job's fault, and for the
// next job it would be the same. So all wait.
void Supervisor::notice_start(const std::string& why_not) {
  if (why_not.empty()) {
    if (start_again_after_.count() > 0) jobs_.set_trouble("");
    start_again_after_ = {};
    return;
  }
  start_again_after_ = start_again_after_.count() == 0
                           ? rules_.start_again_after
                           : std::min(2 * start_again_after_, rules_.start_again_after_max);
  start_again_at_ = std::chrono::steady_clock::now() + start_again_after_;
  jobs_.set_trouble("no worker can be started: " + why_not);
}

void Supervisor::wait() {
  // A descriptor of -1 is passed over: a closed pipe would always be readable.
  std::vector<pollfd> events{pollfd{bell_.descriptor(), POLLIN, 0}};
  bool ended = false;
  for (const auto& attempt : running_) {
    ended = ended || attempt->has_ended();
    events.push_back({attempt->ended_descriptor(), POLLIN, 0});
    events.push_back({attempt->output_descriptor(), POLLIN, 0});
  }
  const auto patience = running_.empty() ? kRest : rules_.look_every;
  (void)::poll(events.data(), events.size(), ended ? 0 : static_cast<int>(patience.count()));
  rung_ = (events.front().revents & POLLIN) != 0;
  if (rung_) bell_.clear();
}

void Supervisor::look_at_all() {
  for (const auto& attempt : running_) attempt->look(stopping_, rung_);
  const auto has_ended = [](const std::unique_ptr<RunningAttempt>& attempt) { return attempt->has_ended(); };
  const auto first_ended = std::stable_partition(running_.begin(), running_.end(), std::not_fn(has_ended));
  std::vector<EndedAttempt> ended;
  for (auto attempt = first_ended; attempt != running_.end(); ++attempt) {
    AttemptOutcome outcome = (*attempt)->end();
    ended.push_back({std::move(*attempt), std::move(outcome)});
  }
  running_.erase(first_ended, running_.end());
  explain_kills(ended);
  // After that: however long the attempts were looked at, a kill is not too old for them.
  memory_kills_.look();
  for (EndedAttempt& each : ended)
    recorder_.add({each.attempt->claim().job.id, each.attempt->claim().lease, std::move(each.outcome)});
  if (!ended.empty()) jobs_.set_use(use());
}

void Supervisor::explain_kills(std::vector<EndedAttempt>& ended) {
  std::vector<std::int64_t> peaks_bytes;
  for (const EndedAttempt& each : ended)
    if (is_unexplained_kill(each.outcome)) peaks_bytes.push_back(each.attempt->peak_bytes());
  if (peaks_bytes.empty()) return;
  std::int64_t largest_alive_bytes = 0;
  for (const auto& attempt : running_)
    largest_alive_bytes = std::max(largest_alive_bytes, attempt->peak_bytes());
  const std::vector<KilledFor> why = memory_kills_.judge(peaks_bytes, largest_alive_bytes);
  auto next = why.begin();
  for (EndedAttempt& each : ended)
    if (is_unexplained_kill(each.outcome)) explain(*next++, each.outcome);
}

void Supervisor::complain(const std::string& trouble) {
  if (trouble != last_complaint_) log_line(trouble);
  last_complaint_ = trouble;
}

}  // namespace server
