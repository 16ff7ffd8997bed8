#include "server/jobs/integrity_check.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/log.h"

namespace server {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr std::int64_t kFilesAtOnce = 200;
constexpr std::chrono::milliseconds kAfterFailureMax{600'000};

/// Of this thread: whatever else wants the processor or the disk goes first.
void step_back() {
  constexpr int kThisThread = 1, kIdleClass = 3 << 13;  // ioprio_set(2)
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), 19);
  (void)::syscall(SYS_ioprio_set, kThisThread, 0, kIdleClass);
}

}  // namespace

IntegrityCheck::IntegrityCheck(JobStore& store, const DataFolder& folder, IntegrityRules rules, Clock clock)
    : store_(store), folder_(folder), rules_(rules), clock_(std::move(clock)) {
  if (const auto state = store_.integrity()) {
    report_.ended_ms = state->ended_ms;
    report_.round_ms = state->round_ms;
  }
  if (const auto damaged = store_.count_damaged()) report_.damaged_files = *damaged;
}

void IntegrityCheck::start() {
  if (rules_.every.count() > 0) thread_ = std::thread([this] { run(); });
}

void IntegrityCheck::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  stopped_.notify_all();
  if (thread_.joinable()) thread_.join();
}

IntegrityReport IntegrityCheck::report() const {
  const std::lock_guard lock(mutex_);
  return report_;
}

// The wall clock may have jumped: never longer than from one check to the next.
std::chrono::milliseconds IntegrityCheck::until_next() const {
  const std::lock_guard lock(mutex_);
  const std::chrono::milliseconds since(clock_() - report_.ended_ms);
  return std::clamp(rules_.every - since, std::chrono::milliseconds(0), rules_.every);
}

void IntegrityCheck::run() {
  step_back();
  auto next = SteadyClock::now() + until_next();
  while (!stopping_) {
    {
      std::unique_lock lock(mutex_);
      if (stopped_.wait_until(lock, next, [this] { return stopping_.load(); })) return;
    }
    const api::Status checked = check();
    next = SteadyClock::now() + rules_.every;
    if (checked || checked.error().fault == api::Fault::stopped) continue;
    log_line("the integrity check was broken off: " + checked.error().message);
    next = SteadyClock::now() + std::min(rules_.every, kAfterFailureMax);
  }
}

api::Status IntegrityCheck::check() {
  if (api::Status done = check_database(); !done) return done;
  if (api::Status done = check_files(); !done || !beside_) return done;
  return beside_(rules_.time_max, stopping_);
}

api::Status IntegrityCheck::check_database() {
  auto database = Database::open_to_read(folder_.database());
  if (!database) return database.error();
  auto damage = damage_of(*database);
  if (!damage) return damage.error();
  for (const std::string& sentence : *damage) log_line("integrity check: " + sentence);
  const std::lock_guard lock(mutex_);
  report_.database = std::move(*damage);
  return api::Done{};
}

api::Status IntegrityCheck::look_at(const KeptFile& file) {
  const api::Status same =
      verify_file(folder_.job(file.job_id) / file.folder(),
                  {file.path, file.bytes, file.sha256, file.is_input ? "input" : "artefact"}, stopping_);
  if (!same && same.error().fault == api::Fault::stopped) return same;
  // Removed while it was read?
  if (!same && !store_.job(file.job_id)) return api::Done{};
  if (!same) log_line("integrity check: " + file.job_id + ": " + same.error().message);
  // Want of memory or descriptors, say, proves nothing: what is known of it stays until the next round.
  if (!same && same.error().fault != api::Fault::invalid_request) return api::Done{};
  if (api::Status kept =
          store_.record_look({file.job_seq, file.is_input, file.path, same ? "" : same.error().message});
      !kept)
    return kept;
  const std::lock_guard lock(mutex_);
  ++report_.files;
  report_.bytes += file.bytes;
  return api::Done{};
}

// Up to the last file or the end of the time; at the end the next check begins with the first file again.
api::Status IntegrityCheck::check_share(Database& database, IntegrityState& state) {
  const auto enough = SteadyClock::now() + rules_.time_max;
  for (;;) {
    const auto files =
        kept_files_after(database, state.at_inputs, state.after_seq, state.after_path, kFilesAtOnce);
    if (!files) return files.error();
    if (files->empty() && !state.at_inputs) {
      state = {state.ended_ms, state.round_ms, true, 0, ""};
      continue;
    }
    if (files->empty()) {
      state = {clock_(), clock_(), false, 0, ""};
      return api::Done{};
    }
    for (const KeptFile& file : *files) {
      if (api::Status looked = look_at(file); !looked) return looked;
      state.after_seq = file.job_seq;
      state.after_path = file.path;
      state.ended_ms = clock_();
      if (SteadyClock::now() >= enough) return api::Done{};
    }
  }
}

api::Status IntegrityCheck::check_files() {
  auto database = Database::open_to_read(folder_.database());
  if (!database) return database.error();
  auto state = store_.integrity();
  if (!state) return state.error();
  const std::int64_t ended_before_ms = state->ended_ms;
  api::Status done = check_share(*database, *state);
  if (!done) state->ended_ms = ended_before_ms;  // broken off, it goes on from there at the next start
  if (const api::Status kept = store_.keep_integrity(*state); !kept) return kept;
  const auto damaged = store_.count_damaged();
  if (!damaged) return damaged.error();
  const std::lock_guard lock(mutex_);
  report_.ended_ms = state->ended_ms;
  report_.round_ms = state->round_ms;
  report_.damaged_files = *damaged;
  return done;
}

}  // namespace server
