#include "server/setup.h"

#include <poll.h>

#include <string>
#include <utility>

#include "server/store/job_store.h"
#include "server/workers/budget.h"
#include "server/workers/check_command.h"
#include "server/workers/child_process.h"

namespace server {
namespace {

constexpr std::size_t kOpsThreads = 8;
constexpr std::int64_t kHourMs = 3'600'000;

RateRules rate_rules(const Config& config, std::string_view host) {
  const double per_second = rate_limit(config, host);
  return {per_second, 4 * per_second};
}

WorkerBudget budget_of(const Config& config) {
  return make_budget(config.worker_threads_total, config.worker_memory_mb);
}

// Always said: a worker itself sees the machine's cores, not what a container may use of them.
unsigned threads_per_job(const Config& config, const WorkerBudget& budget) {
  return config.worker_threads > 0 ? config.worker_threads : static_cast<unsigned>(budget.cores);
}

}  // namespace

JobRules job_rules(const Config& config, const Doorbell& bell) {
  CheckRules check;
  check.program = config.worker;
  JobRules rules;
  rules.queued_of_one_owner_max = config.queued_per_owner_max;
  rules.bytes_max = config.stored_bytes_max;
  rules.bytes_of_one_owner_max = config.stored_bytes_per_owner_max;
  rules.evict = config.evict;
  if (config.ttl_days) rules.ttl_ms = *config.ttl_days * 24 * kHourMs;
  rules.blobs = {config.blob_bytes_max, config.blob_hours * kHourMs};
  rules.budget = budget_of(config);
  check.render_threads = threads_per_job(config, rules.budget);
  auto [check_job, preview_job] = make_checks(check);
  rules.check = std::move(check_job);
  rules.preview = std::move(preview_job);
  rules.work_arrived = [&bell] { bell.ring(); };
  rules.cancel_requested = [&bell] { bell.ring(); };
  return rules;
}

ViewRules view_rules(const Config& config) {
  ViewRules rules;
  rules.program = config.worker;
  rules.threads = threads_per_job(config, budget_of(config));
  rules.ffmpeg = find_ffmpeg();
  return rules;
}

IntegrityRules integrity_rules(const Config& config) {
  constexpr int kShareOfTime = 24;  // an hour a day
  IntegrityRules rules;
  rules.every = std::chrono::seconds(config.check_seconds);
  rules.time_max = rules.every / kShareOfTime;
  return rules;
}

WorkerRules worker_rules(const Config& config) {
  WorkerRules rules;
  rules.program = config.worker;
  rules.budget = budget_of(config);
  rules.cores_per_job = threads_per_job(config, rules.budget);
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
  rules.hosts = {is_loopback(config.host), config.public_hosts};
  rules.tokens_required = !rules.hosts.this_machine_only && !config.insecure_public;
  rules.proxies = config.proxies;
  rules.rate = rate_rules(config, config.host);
  return rules;
}

GateRules ops_gate_rules(const Config& config, const Address& ops) {
  GateRules rules;
  rules.hosts = {is_loopback(ops.host), config.public_hosts};
  rules.tokens_required = !rules.hosts.this_machine_only && !config.insecure_public;
  rules.never_asks = rules.hosts.this_machine_only || config.ops_open;
  rules.rate = rate_rules(config, ops.host);
  return rules;
}

HttpRules ops_http_rules(const Address& ops) {
  HttpRules rules;
  rules.host = ops.host;
  rules.port = ops.port;
  rules.threads = kOpsThreads;
  return rules;
}

api::Status start_worker_once(const std::filesystem::path& program) {
  constexpr int kPatienceMs = 5000;
  auto worker = ChildProcess::start(program, {"--version"});
  if (!worker) return worker.error();
  pollfd ended{worker->ended_descriptor(), POLLIN, 0};
  if (::poll(&ended, 1, kPatienceMs) != 1) return api::Error{api::Fault::internal, "the worker hangs"};
  if (worker->reap().exit_code != 0) return api::Error{api::Fault::internal, "the worker cannot be run"};
  return api::Done{};
}

api::Status check_who_may_enter(const Config& config, const TokenFolder& tokens) {
  if (!asks_for_tokens(config)) return api::Done{};
  const auto known = tokens.list();
  if (!known) return known.error();
  const std::int64_t now = system_clock_ms();
  for (const Token& token : *known)
    if (!token.expires_ms || now < *token.expires_ms) return api::Done{};
  return api::Error{
      api::Fault::invalid_request,
      (is_loopback(config.host) ? "--ops-listen: " + config.ops->host : "--listen: " + config.host) +
          " can be reached from other machines and there is no valid token, so nobody could be told "
          "from a stranger; make one with\n  keylume-server token create NAME --data " +
          config.data.string() +
          "\nor listen on 127.0.0.1, or give --insecure-public where something else keeps strangers "
          "out"};
}

}  // namespace server
