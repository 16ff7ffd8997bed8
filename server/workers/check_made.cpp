// Are views and videos still what they were when they were made? Unlike what a job's worker has left, they
// can be made again: one that is damaged is removed.
#include <algorithm>
#include <utility>

#include "server/artefacts/files.h"
#include "server/artefacts/verify.h"
#include "server/jobs/collect_results.h"
#include "server/log.h"
#include "server/workers/view_files.h"
#include "server/workers/view_hashes.h"
#include "server/workers/view_service.h"

namespace server {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kJobIdBytesMax = 64;
/// A server that is killed looks again at what it had looked at in so much time at most.
constexpr std::chrono::seconds kKeepEvery{10};

/// None where there is no such folder. Errors: internal.
api::Result<std::vector<std::string>> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    names.push_back(at->path().filename().string());
  if (failed && failed != std::errc::no_such_file_or_directory && failed != std::errc::not_a_directory)
    return file_error(folder.filename().string(), failed.value());
  std::sort(names.begin(), names.end());
  return names;
}

/// Such an error says what is on the disk; every other one says that nobody could look.
bool is_proof(const api::Error& error) {
  return error.fault == api::Fault::invalid_request || error.fault == api::Fault::not_found;
}

void tell_unread(const std::string& what, const api::Error& why) {
  log_line("integrity check: " + what + " cannot be looked at, and is later: " + why.message);
}

bool are_the_same(const std::vector<ArtefactFile>& left, const std::vector<ArtefactFile>& right) {
  return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                    [](const ArtefactFile& a, const ArtefactFile& b) {
                      return a.path == b.path && a.bytes == b.bytes && a.sha256 == b.sha256;
                    });
}

/// What its manifest says of it, and what was kept when it was made.
api::Status must_be_as_made(const fs::path& view, const fs::path& hashes, const std::atomic<bool>& stopping) {
  const auto files = check_files(view, stopping);
  if (!files) return files.error();
  const auto kept = read_view_hashes(hashes);
  if (kept && !are_the_same(*kept, *files))
    return api::Error{api::Fault::invalid_request, "it is another view than was made"};
  return api::Done{};
}

bool was_stopped(const api::Status& status) {
  return !status && status.error().fault == api::Fault::stopped;
}

}  // namespace

std::string ViewService::last_checked() const {
  if (checked_) return *checked_;
  const fs::path file = folder_.views_checked();
  const auto kept = read_below(file.parent_path(), file.filename().string(), kJobIdBytesMax);
  return kept ? *kept : std::string();
}

// Where that fails (a full disk), the next server looks again at what this one has looked at.
void ViewService::keep_checked(const std::string& id) {
  if (id == last_checked()) return;
  checked_ = id;
  if (const api::Status kept = write_durably(folder_.views_checked(), id); !kept)
    log_line("integrity check: " + kept.error().message);
}

api::Status ViewService::check_made(std::chrono::milliseconds time_max, const std::atomic<bool>& stopping) {
  const auto began = std::chrono::steady_clock::now();
  auto kept_at = began;
  const auto ids = names_in(folder_.jobs());
  if (!ids) return ids.error();
  std::string checked = last_checked();
  for (auto id = std::upper_bound(ids->begin(), ids->end(), checked); id != ids->end(); ++id) {
    if (const auto job = jobs_.job(*id))
      if (api::Status looked = check_job(*job, stopping); !looked) {
        keep_checked(checked);
        return looked;
      }
    checked = *id;
    const auto now = std::chrono::steady_clock::now();
    const bool enough = now - began >= time_max;
    if (enough || now - kept_at >= kKeepEvery) {
      keep_checked(checked);
      kept_at = now;
    }
    if (enough) return api::Done{};
  }
  keep_checked("");  // the next check begins anew
  return api::Done{};
}

api::Status ViewService::check_job(const Job& job, const std::atomic<bool>& stopping) {
  const auto views = names_in(views_of(job)), videos = names_in(videos_of(job));
  if (!views) tell_unread(job.id, views.error());
  if (!videos) tell_unread(job.id, videos.error());
  if (views)
    for (const std::string& name : *views)
      if (is_view_name(name))
        if (api::Status looked = check_view(job, name, stopping); !looked) return looked;
  if (videos)
    for (const std::string& name : *videos)
      if (!name.starts_with(kUnfinished) && !name.ends_with(".sha256"))
        if (api::Status looked = check_video(job, name, stopping); !looked) return looked;
  return api::Done{};
}

api::Status ViewService::check_view(const Job& job, const std::string& name,
                                    const std::atomic<bool>& stopping) {
  api::Status whole = must_be_as_made(views_of(job) / name, hashes_of(job, name), stopping);
  if (was_stopped(whole)) return whole;
  if (whole) return api::Done{};
  if (is_proof(whole.error()))
    drop_view(job, name, whole.error().message);
  else
    tell_unread(key_of_view(job.id, name), whole.error());
  return api::Done{};
}

// Its name goes first, at once: nobody finds half of it, whatever happens meanwhile.
void ViewService::drop_view(const Job& job, const std::string& name, const std::string& why) {
  const std::string key = key_of_view(job.id, name);
  const fs::path dropped = views_of(job) / (std::string(kUnfinished) + "dropped." + name);
  {
    const std::lock_guard lock(changing_);
    // It may have been removed while it was read, alone or with its job, or be on its way again.
    const Maker::State state = maker_.look(key).state;
    if (state == Maker::State::waiting || state == Maker::State::making || !jobs_.job(job.id)) return;
    std::error_code failed;
    fs::rename(views_of(job) / name, dropped, failed);
    if (failed) return;
    forget_verified(key);
    fs::remove(hashes_of(job, name), failed);
    log_line("integrity check: " + key + " is damaged: " + why + "; it is made again");
    if (fs::exists(views_of(job) / (name + ".json"), failed))
      if (const auto asked = maker_.ask(key, work_of(job.id, name)); !asked)
        log_line(key + ": the view waits for the next start: " + asked.error().message);
  }
  if (const api::Status removed = remove_tree(dropped); !removed)
    log_line(key + ": " + removed.error().message);
  jobs_.record_bytes(job);
}

api::Status ViewService::check_video(const Job& job, const std::string& file,
                                     const std::atomic<bool>& stopping) {
  const fs::path path = videos_of(job) / file;
  const auto sum = read_below(videos_of(job), sum_of(path).filename().string(), kSumBytes);
  if (!sum) return api::Done{};  // it is not finished
  const auto video = open_below(videos_of(job), file);
  const auto found = video ? sha256_of(*video, stopping) : api::Result<std::string>(video.error());
  if (!found && found.error().fault == api::Fault::stopped) return found.error();
  if (found && *found == *sum) return api::Done{};
  if (!found && !is_proof(found.error())) {
    tell_unread(job.id + "/videos/" + file, found.error());
    return api::Done{};
  }
  {
    const std::lock_guard lock(changing_);
    if (!jobs_.job(job.id)) return api::Done{};
    std::error_code failed;
    fs::remove(sum_of(path), failed);
    fs::remove(path, failed);
  }
  log_line("integrity check: " + job.id + "/videos/" + file +
           " is damaged: " + (found ? "it has another SHA-256" : found.error().message) +
           "; it is made again when it is asked for");
  jobs_.record_bytes(job);
  return api::Done{};
}

}  // namespace server
