// The part of JobStore that knows when results and blobs were used last.
#include "server/store/job_store.h"

namespace server {
namespace {

// A blob's last use is noted no more often.
constexpr std::int64_t kUsedEveryMs = 3'600'000;

}  // namespace

JobStore::~JobStore() {
  (void)keep_uses();
}

void JobStore::record_use(std::int64_t job_seq) {
  const std::int64_t now = clock_();
  const std::lock_guard lock(using_);
  uses_.of_jobs[job_seq] = now;
}

api::Result<bool> JobStore::use_blob(std::string_view owner, std::string_view sha256) {
  const std::int64_t now = clock_();
  bool found = false;
  std::int64_t used_ms = 0;
  {
    Reading reading(*readers_);
    Statement select = reading.prepare("SELECT used_ms FROM blob WHERE owner = ? AND sha256 = ?");
    found = select.bind(owner).bind(sha256).next();
    if (found) used_ms = select.integer(0);
    if (const api::Status ok = select.status(); !ok) return ok.error();
  }
  if (!found || now - used_ms < kUsedEveryMs) return found;
  const std::lock_guard lock(using_);
  uses_.of_blobs[{std::string(owner), std::string(sha256)}] = now;
  return true;
}

api::Status JobStore::keep_uses() {
  const std::lock_guard lock(mutex_);
  return keep_uses_locked();
}

api::Status JobStore::keep_uses_locked() {
  Uses uses;
  {
    const std::lock_guard lock(using_);
    uses = std::exchange(uses_, {});
  }
  if (uses.of_jobs.empty() && uses.of_blobs.empty()) return api::Done{};
  api::Status written = write_uses(uses);
  if (written) return written;
  // Once more next time; what was used again meanwhile counts from then.
  const std::lock_guard lock(using_);
  uses_.of_jobs.merge(uses.of_jobs);
  uses_.of_blobs.merge(uses.of_blobs);
  return written;
}

api::Status JobStore::write_uses(const Uses& uses) {
  Transaction transaction(database_);
  if (api::Status begun = transaction.begin(); !begun) return begun;
  Statement job = database_.prepare("UPDATE job SET used_ms = ? WHERE seq = ?");
  for (const auto& [seq, used_ms] : uses.of_jobs) {
    if (api::Status done = job.bind(used_ms).bind(seq).run(); !done) return done;
    job.reset();
  }
  Statement blob =
      database_.prepare("UPDATE blob SET used_ms = max(used_ms, ?) WHERE owner = ? AND sha256 = ?");
  for (const auto& [key, used_ms] : uses.of_blobs) {
    if (api::Status done = blob.bind(used_ms).bind(key.first).bind(key.second).run(); !done) return done;
    blob.reset();
  }
  return transaction.commit();
}

}  // namespace server
