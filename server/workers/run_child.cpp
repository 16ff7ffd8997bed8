#include "server/workers/run_child.h"

#include <poll.h>
#include <signal.h>

#include <array>

#include "server/workers/worker_log.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int kLookEveryMs = 100;

}  // namespace

api::Result<ChildOutcome> run_child(const ChildTask& task, const std::atomic<bool>& stopping) {
  auto child = ChildProcess::start(task.program, task.arguments, task.limits);
  if (!child) return child.error();
  WorkerLog log(task.log_folder, task.log_title);
  const auto deadline = SteadyClock::now() + task.time_max;
  bool log_open = true, late = false;
  while (!child->has_ended() && !stopping && !late) {
    std::array<pollfd, 2> events{pollfd{child->ended_descriptor(), POLLIN, 0},
                                 pollfd{log_open ? child->output().get() : -1, POLLIN, 0}};
    (void)::poll(events.data(), events.size(), kLookEveryMs);
    log_open = log_open && log.take_from(child->output());
    late = SteadyClock::now() > deadline;
  }
  const bool ended = child->has_ended();
  if (!ended) child->signal_group(SIGKILL);
  if (log_open) (void)log.take_from(child->output());
  const ProcessEnd end = child->reap();
  if (ended) return ChildOutcome{end, log.tail()};
  if (stopping) return api::Error{api::Fault::stopped, "the server is stopping"};
  return api::Error{api::Fault::out_of_resources,
                    "it took more than " + std::to_string(task.time_max.count() / 1000) + " s"};
}

}  // namespace server
