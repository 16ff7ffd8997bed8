#include "server/workers/view_service.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "api/exit_code.h"
#include "api/fault_point.h"
#include "server/artefacts/verify.h"
#include "server/jobs/collect_results.h"
#include "server/log.h"
#include "server/workers/run_child.h"
#include "server/workers/view_files.h"
#include "server/workers/view_hashes.h"

namespace server {
namespace {

constexpr std::size_t kVerifiedMax = 64;

api::Status make_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return file_error(folder.string(), errno);
  return api::Done{};
}

void remove_quietly(const std::filesystem::path& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

/// Requests without a view, of one job: their names.
std::vector<std::string> promised_in(const std::filesystem::path& views) {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(views, failed), end; !failed && at != end;
       at.increment(failed)) {
    const std::string file = at->path().filename().string();
    if (file.ends_with(".json") && is_view_name(std::string_view(file).substr(0, file.size() - 5)) &&
        !std::filesystem::exists(views / file.substr(0, file.size() - 5)))
      names.push_back(file.substr(0, file.size() - 5));
  }
  return names;
}

api::Status verdict_on(const std::filesystem::path& views, const std::string& name,
                       const ChildOutcome& outcome) {
  if (outcome.end.exit_code == static_cast<int>(api::ExitCode::ok)) return api::Done{};
  if (outcome.end.exit_code == static_cast<int>(api::ExitCode::stopped))
    return api::Error{api::Fault::internal, "somebody stopped the worker"};
  const api::JobReport report = read_report_at(views, name + ".report.json");
  const std::string why = report.message.empty() ? outcome.log_tail : report.message;
  switch (static_cast<api::ExitCode>(outcome.end.exit_code.value_or(-1))) {
    case api::ExitCode::invalid_input:
      return api::Error{api::Fault::invalid_request, why, report.violations};
    case api::ExitCode::limit_exceeded:
      return api::Error{api::Fault::invalid_request,
                        "the view needs more time or memory than allowed: " + why};
    case api::ExitCode::disk_full:
      return api::Error{api::Fault::disk_full, "the disk is full"};
    default:
      break;
  }
  if (outcome.end.signal == SIGXCPU)
    return api::Error{api::Fault::invalid_request, "the view needs more processor time than allowed"};
  return api::Error{api::Fault::internal, "the worker failed: " + why};
}

}  // namespace

std::string_view name_of(MadeState state) {
  switch (state) {
    case MadeState::waiting:
      return "waiting";
    case MadeState::making:
      return "making";
    case MadeState::ready:
      return "ready";
    case MadeState::failed:
      return "failed";
    case MadeState::none:
      break;
  }
  return "none";
}

std::string view_name(const api::ViewRequest& request) {
  return sha256_of(request.canonical_json).substr(0, kViewNameBytes);
}

ViewService::ViewService(JobService& jobs, const DataFolder& folder, ViewRules rules)
    : jobs_(jobs), folder_(folder), rules_(std::move(rules)), maker_(rules_.at_once, rules_.waiting_max) {
  jobs_.before_removal([this](const std::string& job_id) { end_all_of(job_id); });
}

void ViewService::end_all_of(const std::string& job_id) {
  // Who was asking has asked by now; who asks from now on finds no job.
  { const std::lock_guard lock(changing_); }
  maker_.end_all(job_id + "/");
  const std::lock_guard lock(mutex_);
  std::erase_if(verified_, [&](const auto& view) { return view.first.starts_with(job_id + "/"); });
}

void ViewService::take_up_again() {
  std::error_code failed;
  for (std::filesystem::directory_iterator at(folder_.jobs(), failed), end; !failed && at != end;
       at.increment(failed)) {
    const std::string id = at->path().filename().string();
    remove_half_made(at->path());
    for (const std::string& name : promised_in(at->path() / "views"))
      if (const auto asked = maker_.ask(key_of_view(id, name), work_of(id, name)); !asked)
        log_line(id + ": a view waits for the next start: " + asked.error().message);
  }
}

Maker::Work ViewService::work_of(const std::string& job_id, const std::string& name) {
  return
      [this, job_id, name](const std::atomic<bool>& stopping) { return make_view(job_id, name, stopping); };
}

api::Status ViewService::make_view(const std::string& job_id, const std::string& name,
                                   const std::atomic<bool>& stopping) {
  const auto job = jobs_.job(job_id);
  if (!job) return job.error();
  // The request may have been written by a worker that had no business there.
  if (job->state != api::JobState::succeeded)
    return api::Error{api::Fault::wrong_state, "the job has not succeeded, so there is nothing to look at"};
  const std::filesystem::path folder = jobs_.folder_of(*job), views = views_of(*job);
  // From wrong radiosity come wrong pictures.
  for (const char* read : {"radiosity*", "patches*"})
    if (api::Status whole = jobs_.must_be_whole(*job, read); !whole) {
      remove_quietly(views / (name + ".json"));
      return whole;
    }
  ChildTask task;
  task.program = rules_.program;
  task.arguments = {"view",        folder.string(),
                    "--name",      name,
                    "--memory-mb", std::to_string(rules_.memory_mb),
                    "--seconds",   std::to_string(rules_.processor_seconds),
                    "--parent",    std::to_string(::getpid()),
                    "--sandbox"};
  if (rules_.threads > 0)
    task.arguments.insert(task.arguments.end(), {"--threads", std::to_string(rules_.threads)});
  task.time_max = rules_.time_max;
  task.log_folder = folder;
  task.log_title = "view";
  const auto outcome = run_child(task, stopping);
  api::Status status = outcome ? verdict_on(views, name, *outcome) : api::Status(outcome.error());
  if (status) {
    remove_quietly(hashes_of(*job, name));  // whoever has written it, it was not we
    const auto files = verified_files(*job, name);
    api::fault_point("view_hashed");
    if (!files) status = api::Error{api::Fault::internal, files.error().message};
  }
  remove_quietly(views / (name + ".report.json"));
  // What the server stops is still promised, and what waits for room; what has failed is not.
  if (status) jobs_.record_bytes(*job);
  if (status || status.error().fault == api::Fault::stopped) return status;
  remove_quietly(views / (".tmp." + name));
  remove_quietly(views / name);
  if (status.error().fault != api::Fault::disk_full) remove_quietly(views / (name + ".json"));
  return status;
}

// Without mutex_: reading large files takes long, and is done once, when the view is made; of a view of an
// earlier version, when it is asked for first.
api::Result<std::vector<ArtefactFile>> ViewService::verified_files(const Job& job, std::string_view name) {
  const std::string key = key_of_view(job.id, name);
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = verified_.find(key); known != verified_.end()) return known->second;
  }
  api::Result<std::vector<ArtefactFile>> files = std::vector<ArtefactFile>();
  if (auto known = read_view_hashes(hashes_of(job, name))) {
    files = std::move(*known);
  } else {
    files = collect_files(views_of(job) / name);
    if (!files) return files;
    if (const api::Status kept = write_view_hashes(hashes_of(job, name), *files); !kept)
      log_line(key + ": its hashes are not kept: " + kept.error().message);
  }
  const std::lock_guard lock(mutex_);
  if (!std::filesystem::exists(views_of(job) / name)) {  // removed meanwhile
    remove_quietly(hashes_of(job, name));
    return api::Error{api::Fault::not_found, "the job has no such view"};
  }
  if (verified_.size() >= kVerifiedMax) verified_.erase(verified_.begin());
  verified_.emplace(key, *files);
  return files;
}

// Once the folder is gone: who has read its files before, keeps them before as well.
void ViewService::forget_verified(const std::string& key) {
  const std::lock_guard lock(mutex_);
  verified_.erase(key);
}

api::Status ViewService::promise(const Job& job, const std::string& name, const std::string& request_json) {
  if (auto made = make_folder(views_of(job)); !made) return made;
  if (names(job).size() >= rules_.views_per_job_max)
    return api::Error{api::Fault::out_of_resources,
                      "the job has " + std::to_string(rules_.views_per_job_max) + " views; delete some"};
  if (auto written = write_durably(views_of(job) / (name + ".json"), request_json); !written) return written;
  if (auto synced = sync_folder(jobs_.folder_of(job)); !synced) return synced;
  api::fault_point("view_promised");
  return api::Done{};
}

api::Result<View> ViewService::ask(const Job& job, const api::ViewRequest& request) {
  const std::string name = view_name(request);
  {
    const std::lock_guard lock(changing_);
    if (const auto still = jobs_.job(job.id); !still) return still.error();
    const Maker::State state = maker_.look(key_of_view(job.id, name)).state;
    const bool comes = state == Maker::State::waiting || state == Maker::State::making;
    if (!comes && !std::filesystem::exists(views_of(job) / name)) {
      // How large it will be is not known; who is over the quota makes no more.
      if (auto room = jobs_.within_quota(job.owner, 1); !room) return room.error();
      if (auto promised = promise(job, name, request.canonical_json); !promised) return promised.error();
      if (auto asked = maker_.ask(key_of_view(job.id, name), work_of(job.id, name)); !asked) {
        remove_quietly(views_of(job) / (name + ".json"));
        return asked.error();
      }
    }
  }
  return view(job, name);
}

api::Result<View> ViewService::view(const Job& job, std::string_view name) {
  const api::Error unknown{api::Fault::not_found, "the job has no such view"};
  if (!is_view_name(name)) return unknown;
  View view;
  view.name = name;
  const auto request = read_below(views_of(job), view.name + ".json", api::kViewBytesMax);
  if (request) view.request_json = *request;
  const Maker::Look look = maker_.look(key_of_view(job.id, name));
  if (look.state == Maker::State::waiting) view.state = MadeState::waiting, view.error = look.error;
  if (look.state == Maker::State::making) view.state = MadeState::making;
  if (look.state == Maker::State::failed) view.state = MadeState::failed, view.error = look.error;
  if (view.state != MadeState::none) return view;
  if (!std::filesystem::exists(views_of(job) / name)) return unknown;
  auto files = verified_files(job, name);
  if (!files && files.error().fault == api::Fault::not_found) return unknown;
  if (!files) return api::Error{api::Fault::internal, files.error().message};
  view.state = MadeState::ready;
  view.files = std::move(*files);
  return view;
}

std::vector<std::string> ViewService::names(const Job& job) const {
  std::vector<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator at(views_of(job), failed), end; !failed && at != end;
       at.increment(failed)) {
    std::string file = at->path().filename().string();
    if (!file.ends_with(".json")) continue;
    file.resize(file.size() - 5);
    if (is_view_name(file)) names.push_back(std::move(file));
  }
  std::sort(names.begin(), names.end());
  return names;
}

api::Status ViewService::remove(const Job& job, std::string_view name) {
  if (const auto known = view(job, name); !known) return known.error();
  const std::lock_guard lock(changing_);
  if (!maker_.forget(key_of_view(job.id, name)))
    return api::Error{api::Fault::wrong_state, "the view is being made; delete it when it is ready"};
  // The request last: after a crash in between the view is made again, and can be removed again.
  const api::Status gone = remove_tree(views_of(job) / name);
  forget_verified(key_of_view(job.id, name));
  if (!gone) return gone;
  remove_quietly(hashes_of(job, name));
  api::Status removed = remove_tree(views_of(job) / (std::string(name) + ".json"));
  jobs_.record_bytes(job);
  return removed;
}

}  // namespace server
