// The part of JobStore that takes the next job from the queue.
#include "api/fault_point.h"
#include "server/store/job_store.h"
#include "server/store/turns.h"

namespace server {
namespace {

using api::JobState;

/// Owners with queued jobs. A step of the index each, not a scan of the queue.
api::Result<std::vector<std::string>> owners_waiting(Database& database) {
  Statement select = database.prepare(
      "WITH RECURSIVE waiting(owner) AS ("
      "SELECT min(owner) FROM job INDEXED BY job_urgency WHERE state = 'queued' UNION ALL "
      "SELECT (SELECT min(owner) FROM job INDEXED BY job_urgency WHERE state = 'queued' AND "
      "owner > waiting.owner) FROM waiting WHERE waiting.owner IS NOT NULL) "
      "SELECT owner FROM waiting WHERE owner IS NOT NULL");
  std::vector<std::string> owners;
  while (select.next()) owners.push_back(select.text(0));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return owners;
}

/// Looks at the first job of one owner after the other.
class Chooser {
 public:
  // INDEXED BY: without it the planner may sort the whole queue for every claim.
  Chooser(Database& database, std::int64_t now_ms)
      : now_ms_(now_ms),
        first_(database.prepare(
            "SELECT seq, rank_ms, queued_ms, memory_bytes FROM job INDEXED BY job_turn "
            "WHERE state = 'queued' AND owner = ? AND not_before_ms <= ? AND memory_bytes <= ? "
            "ORDER BY rank_ms, seq LIMIT 1")),
        most_urgent_(database.prepare(
            "SELECT max(priority) FROM job INDEXED BY job_urgency WHERE state = 'queued' AND owner = ?")) {}

  /// The first of all, of those that need no more than `memory_bytes`.
  std::optional<Candidate> choose(const std::vector<OwnerTurn>& owners, std::int64_t memory_bytes) {
    std::optional<Candidate> best;
    for (const OwnerTurn& owner : owners) {
      const auto candidate = candidate_of(owner, memory_bytes);
      if (!candidate || (best && !goes_before(*candidate, *best, now_ms_))) continue;
      best = candidate;
      needs_bytes_ = last_needs_bytes_;
    }
    return best;
  }
  /// By the one that was chosen.
  std::int64_t needs_bytes() const { return needs_bytes_; }
  api::Status status() const {
    const api::Status first = first_.status();
    return first ? most_urgent_.status() : first;
  }

 private:
  std::optional<Candidate> candidate_of(const OwnerTurn& owner, std::int64_t memory_bytes) {
    std::optional<Candidate> candidate;
    if (first_.bind(owner.owner).bind(now_ms_).bind(memory_bytes).next()) {
      candidate = Candidate{owner, 0, first_.integer(1), first_.integer(2), first_.integer(0)};
      last_needs_bytes_ = first_.integer(3);
      if (most_urgent_.bind(owner.owner).next())
        candidate->most_urgent = static_cast<std::uint32_t>(most_urgent_.integer(0));
      most_urgent_.reset();
    }
    first_.reset();
    return candidate;
  }

  std::int64_t now_ms_;
  Statement first_;
  Statement most_urgent_;
  std::int64_t needs_bytes_ = 0;
  std::int64_t last_needs_bytes_ = 0;
};

/// With how they were served, where they were.
std::vector<OwnerTurn> turns_of(const std::vector<std::string>& owners, const std::vector<OwnerTurn>& known) {
  std::map<std::string_view, const OwnerTurn*> by_name;
  for (const OwnerTurn& turn : known) by_name[turn.owner] = &turn;
  std::vector<OwnerTurn> turns;
  for (const std::string& owner : owners) {
    const auto found = by_name.find(owner);
    turns.push_back(found == by_name.end() ? OwnerTurn{owner} : *found->second);
  }
  return turns;
}

}  // namespace

api::Result<std::optional<JobStore::Chosen>> JobStore::choose(const Room& room, std::int64_t now) {
  const auto waiting = owners_waiting(database_);
  if (!waiting) return waiting.error();
  if (waiting->empty()) return std::optional<Chosen>();
  const auto known = owner_turns_in(database_);
  if (!known) return known.error();
  const std::vector<OwnerTurn> owners = turns_of(*waiting, *known);

  Chooser chooser(database_, now);
  auto best = chooser.choose(owners, INT64_MAX);
  const bool fits = room.all || chooser.needs_bytes() <= room.memory_bytes;
  if (best && !fits) {
    // Small jobs use the room that is left, but not for so long that the large one never gets its turn.
    const bool may_be_overtaken = now - best->queued_ms < kOvertakenMaxMs;
    best = may_be_overtaken ? chooser.choose(owners, room.memory_bytes) : std::nullopt;
  }
  if (const api::Status ok = chooser.status(); !ok) return ok.error();
  if (!best) return std::optional<Chosen>();
  Statement id = database_.prepare("SELECT id FROM job WHERE seq = ?");
  id.bind(best->seq);
  Chosen chosen{best->seq, id.next() ? id.text(0) : "", best->owner.owner};
  if (const api::Status ok = id.status(); !ok) return ok.error();
  return std::optional(std::move(chosen));
}

api::Result<Lease> JobStore::begin_attempt(const Chosen& chosen, std::int64_t now) {
  const api::Status stepped = step({chosen.seq, JobState::queued, JobState::running, {}});
  if (!stepped) return stepped.error();
  Statement lease = database_.prepare(
      "UPDATE job SET attempt = attempt + 1, attempts_without_progress = attempts_without_progress + 1, "
      "lease = lease + 1, started_ms = coalesce(started_ms, ?), stage = NULL, stage_fraction = 0, "
      "fraction = 0, progress_message = '', seconds_left = NULL WHERE seq = ?");
  if (const api::Status done = lease.bind(now).bind(chosen.seq).run(); !done) return done.error();
  Statement turn = database_.prepare(
      "INSERT INTO owner_turn(owner, started_ms) VALUES (?, ?) "
      "ON CONFLICT(owner) DO UPDATE SET started_ms = excluded.started_ms");
  if (const api::Status done = turn.bind(chosen.owner).bind(now).run(); !done) return done.error();
  Statement attempt = database_.prepare(
      "INSERT INTO attempt(job_seq, number, lease, started_ms) SELECT seq, attempt, lease, ? FROM job "
      "WHERE seq = ? RETURNING lease");
  attempt.bind(now).bind(chosen.seq);
  const std::int64_t token = attempt.next() ? attempt.integer(0) : 0;
  if (const api::Status done = attempt.run(); !done) return done.error();
  return Lease{chosen.seq, token};
}

api::Result<std::optional<Claim>> JobStore::claim(const Room& room) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = clock_();
  const auto queue = queue_in(database_);
  if (!queue) return queue.error();
  if (queue->paused) return std::optional<Claim>();
  // Looked for outside of the transaction: nobody else writes, and an empty queue is asked often.
  const auto chosen = choose(room, now);
  if (!chosen) return chosen.error();
  if (!*chosen) return std::optional<Claim>();
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  const auto lease = begin_attempt(**chosen, now);
  if (!lease) return lease.error();
  const auto job = job_in(database_, (*chosen)->id);
  if (!job) return job.error();
  if (const api::Status done = transaction.commit(); !done) return done.error();
  api::fault_point("claimed");
  return std::optional<Claim>(Claim{*job, *lease});
}

}  // namespace server
