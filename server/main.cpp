// keylume-server: accepts jobs over HTTP, keeps them, and has them rendered by worker processes.
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include "server/artefacts/data_folder.h"
#include "server/auth/token_folder.h"
#include "server/commands.h"
#include "server/config.h"
#include "server/events/event_hub.h"
#include "server/first_token.h"
#include "server/http/dashboard_routes.h"
#include "server/http/http_server.h"
#include "server/http/ops_routes.h"
#include "server/http/routes.h"
#include "server/jobs/job_service.h"
#include "server/log.h"
#include "server/metrics/http_metrics.h"
#include "server/metrics/job_metrics.h"
#include "server/setup.h"
#include "server/stop_deadline.h"
#include "server/store/job_store.h"
#include "server/workers/supervisor.h"
#include "server/workers/view_service.h"

namespace {

using namespace server;

constexpr std::chrono::seconds kStopPatience{10};
// Of it, for requests that are being answered.
constexpr std::chrono::seconds kRequestPatience{3};
constexpr std::chrono::seconds kHangingPatience{1};

/// A body of a megabyte that is freed goes back to the system at once. By default the allocator learns from
/// the first one to keep such blocks, in every thread's own heap.
void give_back_large_blocks() {
  ::mallopt(M_MMAP_THRESHOLD, 128 << 10);
  ::mallopt(M_TRIM_THRESHOLD, 128 << 10);
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

/// What is running, and has to be stopped in order.
struct Running {
  HttpServer& http;
  HttpServer* ops;  ///< may be none
  JobStore& store;
  JobService& jobs;
  EventHub& hub;
  Supervisor& supervisor;
};

/// Answers requests until a signal comes, then drains. -> exit code
int serve(const Running& running, const sigset_t& signals) {
  std::atomic<bool> failed = false;
  std::thread listener([&] {
    failed = !running.http.run();
    if (failed) ::kill(::getpid(), SIGTERM);
  });
  std::thread ops_listener([&] {
    if (running.ops) (void)running.ops->run();
  });
  int signal = 0;
  sigwait(&signals, &signal);
  log_line("stopping");
  const StopDeadline deadline(kStopPatience, kExitFailed);
  // Who asks a second time does not want to wait.
  std::thread([signals] {
    int again = 0;
    sigwait(&signals, &again);
    ::_exit(kExitFailed);
  }).detach();
  running.hub.stop();           // or listeners would hold their threads
  running.jobs.stop_waiting();  // likewise
  running.http.drain(kRequestPatience);
  running.supervisor.stop();
  running.http.stop();
  if (running.ops) running.ops->stop();
  (void)running.store.keep_uses();  // those of the last minute are no more than that
  // Everything is safe by now; a client that hangs is no reason to wait longer, nor a failure.
  const StopDeadline hanging(kHangingPatience, failed ? kExitFailed : 0);
  listener.join();
  ops_listener.join();
  log_line("stopped");
  return failed ? kExitFailed : 0;
}

/// The second listener, bound. None: not wanted, or its port was not free and nobody insists on it.
api::Result<std::unique_ptr<HttpServer>> bind_ops(const Config& config, const Address& ops,
                                                  const Router& router, Gate& gate) {
  if (ops.host.empty()) return std::unique_ptr<HttpServer>();
  auto http = std::make_unique<HttpServer>(router, gate, ops_http_rules(ops));
  const api::Status bound = http->bind();
  if (bound) return http;
  if (config.ops) return bound.error();
  log_line("no second listener: " + bound.error().message);
  return std::unique_ptr<HttpServer>();
}

/// Without it the service serves all the same; the page at / says how to get it.
DashboardFiles dashboard_of(const Config& config) {
  if (config.dashboard.empty()) return {};
  auto files = read_dashboard(config.dashboard);
  if (files) return std::move(*files);
  log_line("no dashboard: " + files.error().message);
  return {};
}

void tell_of_exchange(HttpMetrics& metrics, const Exchange& exchange) {
  metrics.count(exchange.route, exchange.status, exchange.seconds);
  // What asks every few seconds whether we are well would fill the log.
  if (exchange.status == 200 &&
      (exchange.path == "/healthz" || exchange.path == "/readyz" || exchange.path == "/metrics"))
    return;
  log_event("request", {{"request_id", exchange.request_id},
                        {"method", exchange.method},
                        {"path", exchange.path},
                        {"route", exchange.route},
                        {"status", std::int64_t{exchange.status}},
                        {"duration_ms", exchange.seconds * 1000},
                        {"owner", exchange.owner},
                        {"address", exchange.address}});
}

int run(const Config& config) {
  give_back_large_blocks();
  const sigset_t signals = block_stop_signals();
  set_log_format(config.log_format);
  TokenFolder tokens(config.data);
  if (const api::Status made = make_first_token(config, tokens); !made)
    return refuse_command(made.error(),
                          made.error().fault == api::Fault::invalid_request ? kExitUsage : kExitFailed);
  if (const api::Status told = check_who_may_enter(config, tokens); !told)
    return refuse_command(told.error(), kExitUsage);
  const auto folder = DataFolder::open(config.data);
  if (!folder)
    return refuse_command(folder.error(),
                          folder.error().fault == api::Fault::wrong_state ? kExitInUse : kExitFailed);
  const auto store = JobStore::open(folder->database());
  if (!store) return refuse_command(store.error(), kExitFailed);
  const auto events = EventReader::open(folder->database());
  if (!events) return refuse_command(events.error(), kExitFailed);
  const auto bell = Doorbell::create();
  if (!bell) return refuse_command(bell.error(), kExitFailed);

  const JobRules rules = job_rules(config, *bell);
  JobService jobs(**store, *folder, rules);
  // Before the hub: its thread tells them of events until it ends.
  HttpMetrics http_metrics;
  JobMetrics job_metrics;
  EventHub hub(**events);
  Router router, ops_router;
  add_job_routes(router, jobs);
  ViewService views(jobs, *folder, view_rules(config));
  IntegrityCheck integrity(**store, *folder, integrity_rules(config));  // after what it looks at
  integrity.also([&](std::chrono::milliseconds time_max, const std::atomic<bool>& stopping) {
    return views.check_made(time_max, stopping);
  });
  add_result_routes(router, jobs, &views);
  add_view_routes(router, jobs, views);
  add_event_routes(router, jobs, hub);
  add_login_routes(router, tokens, system_clock_ms);
  add_dashboard_routes(router, dashboard_of(config));
  UploadLimits limits;
  limits.total_bytes = config.upload_bytes_max;
  add_upload_routes(router, jobs, *folder, limits);
  const GateRules gate_config = gate_rules(config);
  const HttpRules http_config = http_rules(config);
  add_limits_route(
      router, {limits, http_config.uploads_max, http_config.small_body_bytes_max, EventRules().listeners_max,
               gate_config.rate, rules.blobs, http_config, view_rules(config), rules});
  Gate gate(tokens, gate_config, system_clock_ms);
  HttpServer http(router, gate, http_config,
                  [&](const Exchange& exchange) { tell_of_exchange(http_metrics, exchange); });
  const OpsSources sources{jobs,
                           **store,
                           *folder,
                           hub,
                           http_metrics,
                           job_metrics,
                           [&integrity] { return integrity.report(); },
                           [&http] { return http.uploads(); },
                           [&config] { return start_worker_once(config.worker); }};
  for (Router* each : {&router, &ops_router}) {
    add_service_routes(*each);
    add_ops_routes(*each, sources);
  }
  if (const api::Status bound = http.bind(); !bound) return refuse_command(bound.error(), kExitUnavailable);
  const Address ops = config.ops.value_or(Address{"127.0.0.1", config.port == 0 ? 0 : http.port() + 1});
  Gate ops_gate(tokens, ops_gate_rules(config, ops), system_clock_ms);
  const auto ops_http = bind_ops(config, ops, ops_router, ops_gate);
  if (!ops_http) return refuse_command(ops_http.error(), kExitUnavailable);

  if (const api::Status clean = jobs.clean_up(); !clean) return refuse_command(clean.error(), kExitFailed);
  const api::Status watching = hub.start([&](const JobEvent& event) { job_metrics.take(event); });
  if (!watching) return refuse_command(watching.error(), kExitFailed);
  views.take_up_again();
  Supervisor supervisor(jobs, *bell, worker_rules(config));
  if (const api::Status started = supervisor.start(); !started)
    return refuse_command(started.error(), kExitFailed);
  integrity.start();
  log_line("listening on http://" + config.host + ":" + std::to_string(http.port()) + ", data in " +
           config.data.string() + ", worker " + config.worker.string());
  if (*ops_http)
    log_line("/healthz, /readyz and /metrics also on http://" + ops.host + ":" +
             std::to_string((*ops_http)->port()));
  return serve({http, ops_http->get(), **store, jobs, hub, supervisor}, signals);
}

int refuse_usage(const api::Error& error) {
  std::cerr << "keylume-server: " << error.message << "\ntry keylume-server --help\n";
  return kExitUsage;
}

int tell(const CommandLine& asked) {
  if (std::holds_alternative<ShowHelp>(asked))
    std::cout << help_text();
  else
    std::cout << "keylume-server " KEYLUME_VERSION "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  server::hold_standard_descriptors();
  std::vector<std::string_view> given(argv + (argc > 0 ? 1 : 0), argv + argc);
  if (const auto exit_code = server::run_command(given)) return *exit_code;
  const bool health = !given.empty() && given.front() == "health";
  if (health) given.erase(given.begin());
  if (const auto asked = server::asked_to_tell(given)) return tell(*asked);
  const auto words = server::with_settings(given, server::own_environment(), server::option_names());
  if (!words) return refuse_usage(words.error());
  const std::vector<std::string_view> all(words->begin(), words->end());
  if (health) return server::run_health_command(all);
  const auto command = server::parse_command_line(all);
  if (!command) return refuse_usage(command.error());
  return run(std::get<server::Config>(*command));
}
