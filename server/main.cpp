// keylume-server: accepts jobs over HTTP, keeps them, and has them rendered by worker processes.
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <iostream>
#include <mutex>
#include <thread>
#include <vector>

#include "server/artefacts/data_folder.h"
#include "server/auth/token_folder.h"
#include "server/commands.h"
#include "server/config.h"
#include "server/events/event_hub.h"
#include "server/http/http_server.h"
#include "server/http/routes.h"
#include "server/jobs/job_service.h"
#include "server/log.h"
#include "server/store/job_store.h"
#include "server/workers/budget.h"
#include "server/workers/check_command.h"
#include "server/workers/supervisor.h"

namespace {

using namespace server;

// As in sysexits.h.
constexpr int kFailed = 1;
constexpr int kUsage = 64;
constexpr int kUnavailable = 69;
constexpr int kInUse = 75;

constexpr std::chrono::seconds kStopPatience{10};

int refuse(const api::Error& error, int exit_code) {
  std::cerr << "keylume-server: " << error.message << "\n";
  return exit_code;
}

/// SIGTERM and SIGINT are waited for, by this thread alone; threads started later inherit the mask.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  return signals;
}

JobRules job_rules(const Config& config, const Doorbell& bell) {
  CheckRules check;
  check.program = config.worker;
  check.render_threads = config.worker_threads > 0 ? config.worker_threads : config.worker_threads_total;
  JobRules rules;
  rules.queued_of_one_owner_max = config.queued_per_owner_max;
  rules.bytes_max = config.stored_bytes_max;
  rules.bytes_of_one_owner_max = config.stored_bytes_per_owner_max;
  rules.budget = make_budget(config.worker_threads_total, config.worker_memory_mb);
  rules.check = make_check(check);
  rules.work_arrived = [&bell] { bell.ring(); };
  rules.cancel_requested = [&bell] { bell.ring(); };
  return rules;
}

WorkerRules worker_rules(const Config& config) {
  WorkerRules rules;
  rules.program = config.worker;
  rules.budget = make_budget(config.worker_threads_total, config.worker_memory_mb);
  rules.cores_per_job = config.worker_threads > 0 ? config.worker_threads : rules.budget.cores;
  if (config.worker_threads > 0 || config.worker_threads_total > 0)
    rules.render_options = {"--threads", std::to_string(rules.cores_per_job)};
  return rules;
}

HttpRules http_rules(const Config& config) {
  HttpRules rules;
  rules.host = config.host;
  rules.port = config.port;
  rules.upload_bytes_max = config.upload_bytes_max;
  return rules;
}

GateRules gate_rules(const Config& config) {
  GateRules rules;
  rules.this_machine_only = is_loopback(config.host);
  rules.tokens_required = !rules.this_machine_only && !config.insecure_public;
  rules.proxies = config.proxies;
  rules.rate.per_second = rate_limit(config);
  rules.rate.burst = 4 * rules.rate.per_second;
  return rules;
}

/// A service that others can reach must be able to tell who may use it.
api::Status check_who_may_enter(const Config& config, const TokenFolder& tokens) {
  if (is_loopback(config.host) || config.insecure_public) return api::Done{};
  const auto known = tokens.list();
  if (!known) return known.error();
  const std::int64_t now = system_clock_ms();
  for (const Token& token : *known)
    if (!token.expires_ms || now < *token.expires_ms) return api::Done{};
  return api::Error{
      api::Fault::invalid_request,
      "--listen: " + config.host +
          " can be reached from other machines and there is no valid token, so nobody could be told "
          "from a stranger; make one with\n  keylume-server token create NAME --data " +
          config.data.string() +
          "\nor listen on 127.0.0.1, or give --insecure-public where something else keeps strangers "
          "out"};
}

/// Ends the process if stopping takes too long: whatever is under way, the data folder survives it.
class StopDeadline {
 public:
  StopDeadline()
      : thread_([this] {
          std::unique_lock lock(mutex_);
          if (!done_.wait_for(lock, kStopPatience, [this] { return stopped_; })) ::_exit(kFailed);
        }) {}
  ~StopDeadline() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    done_.notify_one();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable done_;
  bool stopped_ = false;
  std::thread thread_;
};

/// Answers requests until a signal comes. -> exit code
int serve(HttpServer& http, JobService& jobs, EventHub& hub, Supervisor& supervisor,
          const sigset_t& signals) {
  bool failed = false;
  std::thread listener([&] {
    failed = !http.run();
    if (failed) ::kill(::getpid(), SIGTERM);
  });
  int signal = 0;
  sigwait(&signals, &signal);
  log_line("stopping");
  const StopDeadline deadline;
  hub.stop();           // or listeners would hold their threads
  jobs.stop_waiting();  // likewise
  http.stop();
  supervisor.stop();
  listener.join();
  return failed ? kFailed : 0;
}

int run(const Config& config) {
  const sigset_t signals = block_stop_signals();
  TokenFolder tokens(config.data);
  if (const api::Status told = check_who_may_enter(config, tokens); !told)
    return refuse(told.error(), kUsage);
  const auto folder = DataFolder::open(config.data);
  if (!folder)
    return refuse(folder.error(), folder.error().fault == api::Fault::wrong_state ? kInUse : kFailed);
  const auto store = JobStore::open(folder->database());
  if (!store) return refuse(store.error(), kFailed);
  const auto events = EventReader::open(folder->database());
  if (!events) return refuse(events.error(), kFailed);
  const auto bell = Doorbell::create();
  if (!bell) return refuse(bell.error(), kFailed);

  JobService jobs(**store, *folder, job_rules(config, *bell));
  Router router;
  add_job_routes(router, jobs);
  add_result_routes(router, jobs);
  EventHub hub(**events);
  add_event_routes(router, jobs, hub);
  add_login_routes(router, tokens, system_clock_ms);
  add_service_routes(router);
  UploadLimits limits;
  limits.total_bytes = config.upload_bytes_max;
  add_upload_routes(router, jobs, *folder, limits);
  Gate gate(tokens, gate_rules(config), system_clock_ms);
  HttpServer http(router, gate, http_rules(config));
  if (const api::Status bound = http.bind(); !bound) return refuse(bound.error(), kUnavailable);

  if (const api::Status clean = jobs.clean_up(); !clean) return refuse(clean.error(), kFailed);
  if (const api::Status started = hub.start(); !started) return refuse(started.error(), kFailed);
  Supervisor supervisor(jobs, *bell, worker_rules(config));
  if (const api::Status started = supervisor.start(); !started) return refuse(started.error(), kFailed);
  log_line("listening on http://" + config.host + ":" + std::to_string(http.port()) + ", data in " +
           config.data.string() + ", worker " + config.worker.string());
  return serve(http, jobs, hub, supervisor, signals);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
  if (const auto exit_code = server::run_command(words)) return *exit_code;
  const auto command = server::parse_command_line(words);
  if (!command) {
    std::cerr << "keylume-server: " << command.error().message << "\ntry keylume-server --help\n";
    return kUsage;
  }
  if (std::holds_alternative<server::ShowHelp>(*command)) {
    std::cout << server::help_text();
    return 0;
  }
  if (std::holds_alternative<server::ShowVersion>(*command)) {
    std::cout << "keylume-server " KEYLUME_VERSION "\n";
    return 0;
  }
  return run(std::get<server::Config>(*command));
}
