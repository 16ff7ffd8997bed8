// The part of JobStore that sees the queue as a whole.
#include <algorithm>
#include <utility>

#include "server/store/job_store.h"
#include "server/store/turns.h"

namespace server {

using api::JobState;

api::Result<QueueSwitch> JobStore::queue_in(Database& database) {
  Statement select = database.prepare("SELECT paused, reason, changed_ms FROM queue");
  QueueSwitch queue;
  if (select.next()) queue = {select.integer(0) != 0, select.text(1), select.integer(2)};
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return queue;
}

api::Result<QueueSwitch> JobStore::queue() {
  Reading reading(*readers_);
  return queue_in(reading.database());
}

api::Result<QueueSwitch> JobStore::set_queue(bool paused, std::string_view reason) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = clock_();
  // Said again: the time of the change stays.
  Statement update = database_.prepare(
      "UPDATE queue SET changed_ms = CASE WHEN paused = ? THEN changed_ms ELSE ? END, paused = ?, reason = "
      "?");
  const std::int64_t flag = paused ? 1 : 0;
  if (const api::Status done = update.bind(flag).bind(now).bind(flag).bind(reason).run(); !done)
    return done.error();
  return queue_in(database_);
}

api::Result<std::map<JobState, std::int64_t>> JobStore::counts(std::optional<std::string_view> owner) {
  Reading reading(*readers_);
  std::map<JobState, std::int64_t> counts;
  for (const JobState state : api::kJobStates) counts[state] = 0;
  Statement select = reading.prepare(owner ? "SELECT state, count(*) FROM job WHERE owner = ? GROUP BY state"
                                           : "SELECT state, count(*) FROM job GROUP BY state");
  if (owner) select.bind(*owner);
  while (select.next())
    if (const auto state = api::job_state_named(select.text(0))) counts[*state] = select.integer(1);
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return counts;
}

api::Result<std::vector<Waiting>> JobStore::waiting() {
  Reading reading(*readers_);
  // In the order of the index, from which alone it is read; there are few priorities, so the rest is soon
  // done.
  Statement select = reading.prepare(
      "SELECT seq, owner, priority, queued_ms FROM job INDEXED BY job_urgency WHERE state = 'queued' "
      "ORDER BY owner, priority, queued_ms, seq");
  std::vector<Waiting> waiting;
  while (select.next())
    waiting.push_back({select.integer(0), select.text(1), static_cast<std::uint32_t>(select.integer(2)),
                       select.integer(3)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  for (auto first = waiting.begin(); first != waiting.end();) {
    const auto end =
        std::find_if(first, waiting.end(), [&](const Waiting& job) { return job.owner != first->owner; });
    std::sort(first, end, [](const Waiting& a, const Waiting& b) {
      return std::pair(rank_ms(a), a.seq) < std::pair(rank_ms(b), b.seq);
    });
    first = end;
  }
  return waiting;
}

api::Result<std::vector<OwnerTurn>> JobStore::owner_turns_in(Database& database) {
  std::map<std::string, OwnerTurn> turns;
  Statement served = database.prepare("SELECT owner, started_ms FROM owner_turn");
  while (served.next()) turns[served.text(0)] = {served.text(0), 0, served.integer(1)};
  if (const api::Status ok = served.status(); !ok) return ok.error();
  Statement running = database.prepare(
      "SELECT owner, count(*) FROM job WHERE state IN ('running', 'pause_requested', 'cancel_requested') "
      "GROUP BY owner");
  while (running.next()) {
    OwnerTurn& turn = turns[running.text(0)];
    turn.owner = running.text(0);
    turn.running = running.integer(1);
  }
  if (const api::Status ok = running.status(); !ok) return ok.error();
  std::vector<OwnerTurn> list;
  for (auto& [owner, turn] : turns) list.push_back(std::move(turn));
  return list;
}

api::Result<std::vector<OwnerTurn>> JobStore::owner_turns() {
  Reading reading(*readers_);
  return owner_turns_in(reading.database());
}

api::Result<std::int64_t> JobStore::fail_overdue() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare(
      "SELECT seq, state FROM job INDEXED BY job_deadline WHERE deadline_ms IS NOT NULL AND deadline_ms <= ? "
      "AND state IN ('queued', 'paused') LIMIT 100");
  std::vector<std::pair<std::int64_t, JobState>> overdue;
  select.bind(clock_());
  while (select.next())
    if (const auto state = api::job_state_named(select.text(1)))
      overdue.emplace_back(select.integer(0), *state);
  if (const api::Status ok = select.status(); !ok) return ok.error();
  if (overdue.empty()) return std::int64_t{0};
  Transaction transaction(database_);
  if (const api::Status begun = transaction.begin(); !begun) return begun.error();
  for (const auto& [seq, state] : overdue) {
    const Step wanted{seq,
                      state,
                      *api::after(state, api::JobEvent::deadline_passed),
                      {"deadline_passed", "it had not been started by then"}};
    if (const api::Status stepped = step(wanted); !stepped) return stepped.error();
  }
  if (const api::Status done = transaction.commit(); !done) return done.error();
  return static_cast<std::int64_t>(overdue.size());
}

api::Status JobStore::mend_times(std::int64_t wait_ms_max) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = clock_();
  Statement jobs = database_.prepare("UPDATE job SET queued_ms = ? WHERE state = 'queued' AND queued_ms > ?");
  if (api::Status done = jobs.bind(now).bind(now).run(); !done) return done;
  const std::int64_t latest = now > INT64_MAX - wait_ms_max ? INT64_MAX : now + wait_ms_max;
  Statement waits =
      database_.prepare("UPDATE job SET not_before_ms = ? WHERE state = 'queued' AND not_before_ms > ?");
  if (api::Status done = waits.bind(latest).bind(latest).run(); !done) return done;
  Statement turns = database_.prepare("UPDATE owner_turn SET started_ms = ? WHERE started_ms > ?");
  return turns.bind(now).bind(now).run();
}

}  // namespace server
