#include "server/store/event_reader.h"

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
  Statement read = database_.prepare("SELECT coalesce(max(id), 0) FROM event");
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
  return read_events(select);
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
  const bool all = static_cast<std::int64_t>(events->size()) < limit;
  const std::int64_t through = all ? *newest : events->back().id;
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
