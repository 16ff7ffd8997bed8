#include "server/workers/check_command.h"

#include <unistd.h>

#include <poll.h>
#include <signal.h>

#include <array>
#include <semaphore>
#include <string>
#include <utility>
#include <vector>

#include "api/exit_code.h"
#include "server/jobs/collect_results.h"
#include "server/workers/child_process.h"
#include "server/workers/worker_log.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::ptrdiff_t kAtOnceMax = 64;
constexpr std::chrono::seconds kWaitMax{60};

using Slots = std::counting_semaphore<kAtOnceMax>;

/// False: killed because it took too long.
bool wait_for(ChildProcess& worker, WorkerLog& log, std::chrono::milliseconds time_max) {
  const auto deadline = SteadyClock::now() + time_max;
  bool log_open = true;
  while (!worker.has_ended()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - SteadyClock::now());
    if (left.count() <= 0) {
      worker.signal_group(SIGKILL);
      return false;
    }
    std::array<pollfd, 2> events{pollfd{worker.ended_descriptor(), POLLIN, 0},
                                 pollfd{log_open ? worker.output().get() : -1, POLLIN, 0}};
    (void)::poll(events.data(), events.size(), static_cast<int>(left.count()));
    log_open = log_open && log.take_from(worker.output());
  }
  if (log_open) (void)log.take_from(worker.output());
  return true;
}

api::Error refusal_of(const std::filesystem::path& folder, api::Fault fault, std::string_view otherwise) {
  api::JobReport report = read_check_report(folder);
  const std::string message = report.message.empty() ? std::string(otherwise) : report.message;
  return {fault, message, std::move(report.violations)};
}

api::Status verdict(const std::filesystem::path& folder, const ProcessEnd& end, const WorkerLog& log) {
  // A limit that the check runs into is the job's doing too: it must not be tried again as it is.
  constexpr std::string_view kTooLarge =
      "the job needs more time or memory to be checked than the limits allow";
  if (end.signal == SIGXCPU) return refusal_of(folder, api::Fault::invalid_request, kTooLarge);
  switch (static_cast<api::ExitCode>(end.exit_code.value_or(-1))) {
    case api::ExitCode::ok:
      return api::Done{};
    case api::ExitCode::invalid_input:
      return refusal_of(folder, api::Fault::invalid_request, "the job is wrong");
    case api::ExitCode::limit_exceeded:
      return refusal_of(folder, api::Fault::invalid_request, kTooLarge);
    case api::ExitCode::disk_full:
      return refusal_of(folder, api::Fault::disk_full, "the disk is full");
    default:
      break;
  }
  const std::string how =
      end.signal ? signal_name(*end.signal) : "exit code " + std::to_string(*end.exit_code);
  return api::Error{api::Fault::internal, "the check of the job failed with " + how + ": " + log.tail()};
}

api::Status run_check(const CheckRules& rules, const std::filesystem::path& folder, bool preview) {
  std::vector<std::string> arguments{"check",       folder.string(),
                                     "--memory-mb", std::to_string(rules.memory_mb),
                                     "--seconds",   std::to_string(rules.processor_seconds),
                                     "--parent",    std::to_string(getpid()),
                                     "--sandbox"};
  if (rules.render_threads > 0)
    arguments.insert(arguments.end(), {"--threads", std::to_string(rules.render_threads)});
  if (preview) arguments.emplace_back("--preview");
  auto worker = ChildProcess::start(rules.program, arguments);
  if (!worker) return worker.error();
  WorkerLog log(folder, "check");
  const bool in_time = wait_for(*worker, log, rules.time_max);
  const ProcessEnd end = worker->reap();
  if (!in_time) return api::Error{api::Fault::invalid_request, "the check of the job took too long"};
  return verdict(folder, end, log);
}

}  // namespace

Checks make_checks(const CheckRules& rules) {
  auto slots = std::make_shared<Slots>(rules.at_once);
  const auto checks = [&](bool preview) -> CheckJob {
    return [rules, slots, preview](const std::filesystem::path& folder) -> api::Status {
      if (!slots->try_acquire_for(kWaitMax))
        return api::Error{api::Fault::out_of_resources, "too many uploads are being checked"};
      // Also where memory is short and something throws.
      const std::unique_ptr<Slots, void (*)(Slots*)> held(slots.get(), [](Slots* one) { one->release(); });
      return run_check(rules, folder, preview);
    };
  };
  return {checks(false), checks(true)};
}

CheckJob make_check(const CheckRules& rules) {
  return make_checks(rules).check;
}

}  // namespace server
