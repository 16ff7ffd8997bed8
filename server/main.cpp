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
#include "server/config.h"
#include "server/events/event_hub.h"
#include "server/http/http_server.h"
#include "server/http/routes.h"
#include "server/jobs/job_service.h"
#include "server/log.h"
#include "server/store/job_store.h"
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
  check.render_threads = config.worker_threads;
  JobRules rules;
  rules.check = make_check(check);
  rules.work_arrived = [&bell] { bell.ring(); };
  rules.cancel_requested = [&bell] { bell.ring(); };
  return rules;
}

WorkerRules worker_rules(const Config& config) {
  WorkerRules rules;
  rules.program = config.worker;
  if (config.worker_threads > 0) rules.render_options = {"--threads", std::to_string(config.worker_threads)};
  return rules;
}

HttpRules http_rules(const Config& config) {
  HttpRules rules;
  rules.host = config.host;
  rules.port = config.port;
  rules.this_machine_only = is_loopback(config.host);
  rules.upload_bytes_max = config.upload_bytes_max;
  return rules;
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
int serve(HttpServer& http, EventHub& hub, Supervisor& supervisor, const sigset_t& signals) {
  bool failed = false;
  std::thread listener([&] {
    failed = !http.run();
    if (failed) ::kill(::getpid(), SIGTERM);
  });
  int signal = 0;
  sigwait(&signals, &signal);
  log_line("stopping");
  const StopDeadline deadline;
  hub.stop();  // or listeners would hold their threads
  http.stop();
  supervisor.stop();
  listener.join();
  return failed ? kFailed : 0;
}

int run(const Config& config) {
  const sigset_t signals = block_stop_signals();
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
  add_service_routes(router);
  UploadLimits limits;
  limits.total_bytes = config.upload_bytes_max;
  add_upload_routes(router, jobs, *folder, limits);
  HttpServer http(router, http_rules(config));
  if (const api::Status bound = http.bind(); !bound) return refuse(bound.error(), kUnavailable);

  if (const api::Status clean = jobs.clean_up(); !clean) return refuse(clean.error(), kFailed);
  if (const api::Status started = hub.start(); !started) return refuse(started.error(), kFailed);
  Supervisor supervisor(jobs, *bell, worker_rules(config));
  if (const api::Status started = supervisor.start(); !started) return refuse(started.error(), kFailed);
  log_line("listening on http://" + config.host + ":" + std::to_string(http.port()) + ", data in " +
           config.data.string() + ", worker " + config.worker.string());
  return serve(http, hub, supervisor, signals);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + (argc > 0 ? 1 : 0), argv + argc);
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
