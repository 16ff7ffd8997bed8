// The part of JobService that keeps files for the jobs to come. What two owners have sent lies on disk once,
// but neither learns of the other: each has to send it, and each pays for it.
#include "server/jobs/job_service.h"
#include "server/log.h"

namespace server {

using api::Fault;

api::Result<FileHandle> JobService::open_blob(std::string_view owner, std::string_view sha256) {
  const api::Error unknown{Fault::not_found, "there is no blob " + std::string(sha256)};
  const auto owned = store_.use_blob(owner, sha256);
  if (!owned) return owned.error();
  if (!*owned) return unknown;
  auto file = blobs_.open(sha256);
  if (file || file.error().fault != Fault::not_found) return file;
  // As after the restoring of a backup, which has none. Looked for again: it may just have come.
  const std::lock_guard lock(keeping_);
  if (!blobs_.has(sha256)) (void)store_.forget_blob(sha256);
  return unknown;
}

api::Status JobService::keep_blob(std::string_view owner, const std::filesystem::path& from,
                                  std::string_view sha256) {
  const auto bytes = check_blob(from, sha256);
  if (!bytes) return bytes.error();
  const std::lock_guard lock(keeping_);
  if (api::Status collected = collect_blobs(); !collected) return collected;
  const auto kept = store_.blob_bytes();
  if (!kept) return kept.error();
  if (*kept + *bytes > rules_.blobs.total_bytes)
    return api::Error{Fault::over_quota, "all blobs together may be " +
                                             std::to_string(rules_.blobs.total_bytes) +
                                             " bytes; they go when they have not been used for " +
                                             std::to_string(rules_.blobs.unused_ms / 3'600'000) + " hours"};
  if (api::Status room = within_quota(owner, *bytes); !room) return room;
  if (api::Status room = make_room(*bytes); !room) return room;
  // The row last: a crash in between leaves a file that the next start removes.
  if (api::Status moved = blobs_.keep(from, sha256); !moved) return moved;
  api::Status counted = store_.keep_blob(
      owner, sha256, *bytes, {INT64_MAX, INT64_MAX, rules_.bytes_max, rules_.bytes_of_one_owner_max});
  if (!counted)  // jobs may have taken the room meanwhile
    if (const auto known = store_.blobs()) blobs_.keep_only(*known);
  return counted;
}

api::Status JobService::drop_blob(std::string_view sha256) {
  log_line("blob " + std::string(sha256) + " was damaged on the disk and is dropped");
  const std::lock_guard lock(keeping_);
  if (api::Status forgotten = store_.forget_blob(sha256); !forgotten) return forgotten;
  const auto kept = store_.blobs();
  if (!kept) return kept.error();
  blobs_.keep_only(*kept);
  return api::Done{};
}

// With keeping_ held.
api::Status JobService::collect_blobs() {
  const auto forgotten = store_.forget_blobs(clock_() - rules_.blobs.unused_ms);
  if (!forgotten) return forgotten.error();
  if (*forgotten == 0) return api::Done{};
  const auto kept = store_.blobs();
  if (!kept) return kept.error();
  blobs_.keep_only(*kept);
  return api::Done{};
}

// At start-up: files without a row and rows without a file.
api::Status JobService::match_blobs() {
  const std::lock_guard lock(keeping_);
  const auto kept = store_.blobs();
  if (!kept) return kept.error();
  blobs_.keep_only(*kept);
  for (const std::string& sha256 : *kept)
    if (!blobs_.has(sha256))
      if (api::Status forgotten = store_.forget_blob(sha256); !forgotten) return forgotten;
  return api::Done{};
}

}  // namespace server
