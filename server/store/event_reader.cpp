#include "server/store/event_reader.h"

#include <algorithm>
#include <utility>

namespace server {
namespace {

// CROSS: events first. A listener asks for the newest few again and again; all jobs of an owner are many.
constexpr const char* kSelectEvents =
    "SELECT event.id, event.at_ms, job.seq, job.id, from_state, to_state, event.reason, event.message "
    "FROM event CROSS JOIN job ON job.seq = event.job_seq WHERE event.id > ?";

api::Result<std::vector<JobEvent>> read_events(Statement& select) {
  std::vector<JobEvent> events;
  while (select.next()) {
    JobEvent event{select.integer(0), select.integer(1), select.integer(2), select.text(3), {},
                   select.text(5),    select.text(6),    select.text(7)};
    if (!select.is_null(4)) event.from = select.text(4);
    events.push_back(std::move(event));
  }
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return events;
}

}  // namespace

api::Result<std::unique_ptr<EventReader>> EventReader::open(const std::filesystem::path& file) {
  auto database = Database::open_to_read(file);
  if (!database) return database.error();
  std::unique_ptr<EventReader> reader(new EventReader(std::move(*database)));
  if (const auto first = reader->changed(); !first) return first.error();
  return reader;
}

api::Result<bool> EventReader::changed() {
  const std::lock_guard lock(mutex_);
  // Differs from its last value once another connection has committed.
  Statement read = database_.prepare("PRAGMA data_version");
  const std::int64_t version = read.next() ? read.integer(0) : 0;
  if (const api::Status ok = read.status(); !ok) return ok.error();
  return std::exchange(seen_version_, version) != version;
}

api::Result<std::int64_t> EventReader::newest() {
  const std::lock_guard lock(mutex_);
  return newest_locked();
}

api::Result<std::int64_t> EventReader::newest_locked() {
  Statement read = database_.prepare(
      "SELECT max((SELECT coalesce(max(id), 0) FROM event), (SELECT coalesce(max(event_id), 0) FROM "
      "removal))");
  const std::int64_t id = read.next() ? read.integer(0) : 0;
  if (const api::Status ok = read.status(); !ok) return ok.error();
  return id;
}

api::Result<std::vector<JobEvent>> EventReader::after(std::int64_t id, std::optional<std::int64_t> job_seq,
                                                      std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare(
      std::string(kSelectEvents) + (job_seq ? " AND event.job_seq = ?" : "") + " ORDER BY event.id LIMIT ?");
  select.bind(id);
  if (job_seq) select.bind(*job_seq);
  select.bind(limit);
  auto events = read_events(select);
  if (!events) return events;
  const api::Status added =
      add_removals(*events, job_seq ? " AND job_seq = ?" : "", id, job_seq, std::nullopt, limit);
  if (!added) return added.error();
  return events;
}

// They lie in a table of their own, numbered like the others.
api::Status EventReader::add_removals(std::vector<JobEvent>& events, std::string_view which, std::int64_t id,
                                      std::optional<std::int64_t> job_seq,
                                      std::optional<std::string_view> owner, std::int64_t limit) {
  Statement select = database_.prepare(
      "SELECT event_id, at_ms, job_seq, job_id, from_state FROM removal WHERE event_id > ?" +
      std::string(which) + " ORDER BY event_id LIMIT ?");
  select.bind(id);
  if (job_seq) select.bind(*job_seq);
  if (owner) select.bind(*owner);
  select.bind(limit);
  while (select.next())
    events.push_back({select.integer(0), select.integer(1), select.integer(2), select.text(3), select.text(4),
                      std::string(kRemoved), "", ""});
  if (api::Status ok = select.status(); !ok) return ok;
  std::sort(events.begin(), events.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  if (static_cast<std::int64_t>(events.size()) > limit)
    events.erase(events.begin() + static_cast<std::ptrdiff_t>(limit), events.end());
  return api::Done{};
}

api::Result<EventPage> EventReader::of_owner_after(std::string_view owner, std::int64_t id,
                                                   std::int64_t limit) {
  const std::lock_guard lock(mutex_);
  // First: what is committed between the two is left for the next call.
  const auto newest = newest_locked();
  if (!newest) return newest.error();
  if (*newest <= id) return EventPage{{}, id};
  Statement select = database_.prepare(std::string(kSelectEvents) +
                                       " AND event.id <= ? AND job.owner = ? ORDER BY event.id LIMIT ?");
  select.bind(id).bind(*newest).bind(owner).bind(limit);
  auto events = read_events(select);
  if (!events) return events.error();
  const api::Status added = add_removals(*events, " AND owner = ?", id, std::nullopt, owner, limit);
  if (!added) return added.error();
  const bool all = static_cast<std::int64_t>(events->size()) < limit;
  const std::int64_t through =
      all ? std::max(*newest, events->empty() ? 0 : events->back().id) : events->back().id;
  return EventPage{std::move(*events), through};
}

api::Result<std::vector<JobProgress>> EventReader::progress() {
  const std::lock_guard lock(mutex_);
  Statement select = database_.prepare(
      "SELECT seq, id, version, attempt, stage, stage_fraction, fraction, seconds_left, owner FROM job "
      "WHERE state IN ('running', 'pause_requested', 'cancel_requested') ORDER BY seq");
  std::vector<JobProgress> found;
  while (select.next()) {
    JobProgress progress{select.integer(0),
                         select.text(1),
                         select.integer(2),
                         select.integer(3),
                         {},
                         select.real(5),
                         select.real(6),
                         {}};
    if (!select.is_null(4)) progress.stage = select.text(4);
    progress.seconds_left = select.optional_real(7);
    progress.owner = select.text(8);
    found.push_back(std::move(progress));
  }
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return found;
}

}  // namespace server
