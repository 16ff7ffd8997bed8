// The part of JobStore that keeps and gives out what a job left behind.
#include "server/store/job_store.h"
#include "server/store/read_rows.h"

namespace server {
namespace {

api::Status insert_frames(Database& database, std::int64_t seq, const std::vector<api::FrameRecord>& frames) {
  Statement row = database.prepare("INSERT INTO frame(job_seq, frame, kind, error) VALUES (?, ?, ?, ?)");
  for (const api::FrameRecord& frame : frames) {
    row.bind(seq).bind(std::int64_t{frame.frame}).bind(kind_name(frame.kind)).bind_optional(frame.error);
    if (api::Status done = row.run(); !done) return done;
    row.reset();
  }
  return api::Done{};
}

api::Status insert_intervals(Database& database, std::int64_t seq,
                             const std::vector<api::KeyFrameInterval>& intervals) {
  Statement row = database.prepare(
      "INSERT INTO key_frame_interval(job_seq, first_frame, last_frame, predicted_error, observed_error) "
      "VALUES (?, ?, ?, ?, ?)");
  for (const api::KeyFrameInterval& interval : intervals) {
    row.bind(seq).bind(std::int64_t{interval.first}).bind(std::int64_t{interval.last});
    row.bind_optional(interval.predicted_error).bind_optional(interval.observed_error);
    if (api::Status done = row.run(); !done) return done;
    row.reset();
  }
  return api::Done{};
}

ArtefactFile read_artefact(const Statement& row) {
  return {row.text(0), row.text(1), row.integer(2), row.text(3)};
}

}  // namespace

api::Status JobStore::insert_results(std::int64_t job_seq, const Results& results) {
  Statement row = database_.prepare(
      "INSERT INTO artefact(job_seq, path, media_type, bytes, sha256) VALUES (?, ?, ?, ?, ?)");
  for (const ArtefactFile& file : results.artefacts) {
    row.bind(job_seq).bind(file.path).bind(file.media_type).bind(file.bytes).bind(file.sha256);
    if (api::Status done = row.run(); !done) return done;
    row.reset();
  }
  if (api::Status done = insert_frames(database_, job_seq, results.key_frames.frames); !done) return done;
  return insert_intervals(database_, job_seq, results.key_frames.intervals);
}

api::Result<std::vector<InputFile>> JobStore::inputs(std::int64_t job_seq) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT name, role, bytes, coalesce(sha256, '') FROM job_input WHERE job_seq = ? ORDER BY name");
  select.bind(job_seq);
  std::vector<InputFile> inputs;
  while (select.next())
    inputs.push_back({select.text(0), input_role_named(select.text(1)).value_or(InputRole::texture),
                      select.integer(2), select.text(3)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return inputs;
}

api::Result<std::vector<Attempt>> JobStore::attempts(std::int64_t job_seq) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT number, started_ms, ended_ms, coalesce(outcome, ''), exit_code, signal FROM attempt "
      "WHERE job_seq = ? ORDER BY number");
  select.bind(job_seq);
  std::vector<Attempt> attempts;
  while (select.next()) {
    Attempt attempt{static_cast<std::uint32_t>(select.integer(0)),
                    select.integer(1),
                    select.optional_integer(2),
                    select.text(3),
                    {}};
    if (const auto code = select.optional_integer(4)) attempt.end.exit_code = static_cast<int>(*code);
    if (const auto number = select.optional_integer(5)) attempt.end.signal = static_cast<int>(*number);
    attempts.push_back(std::move(attempt));
  }
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return attempts;
}

api::Result<std::vector<Event>> JobStore::events(std::int64_t job_seq) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT id, at_ms, coalesce(from_state, ''), to_state, reason, message FROM event WHERE job_seq = ? "
      "ORDER BY id");
  select.bind(job_seq);
  std::vector<Event> events;
  while (select.next())
    events.push_back({select.integer(0), select.integer(1), api::job_state_named(select.text(2)),
                      api::job_state_named(select.text(3)).value_or(api::JobState::queued), select.text(4),
                      select.text(5)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return events;
}

api::Result<std::vector<ArtefactFile>> JobStore::artefacts(std::int64_t job_seq, std::string_view glob) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT path, media_type, bytes, sha256 FROM artefact WHERE job_seq = ? AND path GLOB ? ORDER BY path");
  select.bind(job_seq).bind(glob);
  std::vector<ArtefactFile> files;
  while (select.next()) files.push_back(read_artefact(select));
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return files;
}

api::Result<ArtefactFile> JobStore::artefact(std::int64_t job_seq, std::string_view path) {
  Reading reading(*readers_);
  Statement select = reading.prepare(
      "SELECT artefact.path, media_type, bytes, sha256, detail FROM artefact "
      "LEFT JOIN damage USING(job_seq, path) WHERE artefact.job_seq = ? AND artefact.path = ?");
  select.bind(job_seq).bind(path);
  if (select.next()) {
    if (!select.is_null(4)) return damaged_file(path, select.text(4));
    return read_artefact(select);
  }
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return api::Error{api::Fault::not_found, "the job has no file '" + std::string(path) + "'"};
}

api::Result<std::vector<api::FrameRecord>> JobStore::frames(std::int64_t job_seq) {
  Reading reading(*readers_);
  Statement select = reading.prepare("SELECT frame, kind, error FROM frame WHERE job_seq = ? ORDER BY frame");
  select.bind(job_seq);
  std::vector<api::FrameRecord> frames;
  while (select.next())
    frames.push_back({static_cast<api::FrameIndex>(select.integer(0)),
                      frame_kind_named(select.text(1)).value_or(api::FrameKind::interpolated),
                      select.optional_real(2)});
  if (const api::Status ok = select.status(); !ok) return ok.error();
  return frames;
}

}  // namespace server
