// Views and videos of finished jobs: made once, by a child process, and kept with the job.
//
//   jobs/<id>/views/<name>.json          the request; durable before it is promised
//   jobs/<id>/views/<name>.hashes        of what it has made of it; read again where it is not there
//   jobs/<id>/views/<name>/              what `keylume view` has made of it, manifest.json among it
//   jobs/<id>/videos/<camera>.mp4        and .sha256 beside it, which is written last
//
// What is called .tmp.* in these folders was never finished, or is on its way out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"
#include "api/view_request.h"
#include "server/jobs/job_service.h"
#include "server/workers/maker.h"

namespace server {

struct ViewRules {
  std::filesystem::path program;                  ///< the worker executable
  unsigned threads = 0;                           ///< of one view; 0: all cores
  std::uint64_t memory_mb = 8192;                 ///< of one view, kept by the worker itself
  std::uint64_t processor_seconds = 3600;         ///< the same
  std::chrono::milliseconds time_max{1'200'000};  ///< wall clock, of a view or a video
  std::filesystem::path ffmpeg;                   ///< empty: there are no videos
  std::uint64_t ffmpeg_memory_bytes = std::uint64_t{4} << 30;
  std::size_t at_once = 1;
  std::size_t waiting_max = 100;
  std::size_t views_per_job_max = 1000;
};

/// The first ffmpeg along PATH; empty: there is none.
std::filesystem::path find_ffmpeg();

enum class MadeState { none, waiting, making, ready, failed };
std::string_view name_of(MadeState state);

struct View {
  std::string name;
  MadeState state = MadeState::none;
  std::string request_json;         ///< canonical
  std::vector<ArtefactFile> files;  ///< of a view that is ready, paths within its folder
  api::Error error = {};            ///< of one that has failed, or waits for room on the disk
};

struct Video {
  MadeState state = MadeState::none;
  std::string file;  ///< below videos/, when it is ready
  std::string sha256;
  std::int64_t bytes = 0;
  api::Error error = {};  ///< of one that waits for room on the disk
};

/// What a view is called: by the hash of its canonical JSON, so that the same request is the same view.
std::string view_name(const api::ViewRequest& request);

/// Safe for use by several threads.
class ViewService {
 public:
  ViewService(JobService& jobs, const DataFolder& folder, ViewRules rules);

  /// Removes what an earlier server has left half made, and has the views made that it had promised.
  void take_up_again();
  /// Reads views and videos again, of job after job, for up to `time_max`; goes on from there the next time,
  /// also after a restart. One that is proven to be damaged (a file is missing, shorter, or has another hash)
  /// is told of in the log and removed; a view is made again at once, a video when somebody asks for it. What
  /// cannot be read now stays, and is told of. One thread at a time. Errors: stopped, soon after `stopping`
  /// turns true; internal where not even the folder of jobs can be read.
  api::Status check_made(std::chrono::milliseconds time_max, const std::atomic<bool>& stopping);
  void stop() { maker_.stop(); }

  /// Promises it: it is made also if the server ends before. The same request again answers how that stands.
  /// Errors: out_of_resources (too many wait, or the job has too many), disk_full, internal.
  api::Result<View> ask(const Job& job, const api::ViewRequest& request);
  /// Errors: not_found.
  api::Result<View> view(const Job& job, std::string_view name);
  /// Ends what is being made of a job that nobody sees any more, and takes no more orders for it.
  void end_all_of(const std::string& job_id);
  /// By name.
  std::vector<std::string> names(const Job& job) const;
  /// Errors: not_found; wrong_state while it is being made.
  api::Status remove(const Job& job, std::string_view name);
  std::filesystem::path folder_of_view(const Job& job, std::string_view name) const {
    return views_of(job) / name;
  }

  /// How it stands, and has it made where it is not there, from the PNG files of every frame that the job has
  /// of `camera`. `extension`: "mp4" (H.264) or "webm" (VP9). Errors: out_of_resources where there is no
  /// ffmpeg, or too many wait; internal where it has failed, once.
  api::Result<Video> ask_video(const Job& job, const std::string& camera, const std::string& extension);
  bool has_ffmpeg() const { return !rules_.ffmpeg.empty(); }
  std::filesystem::path videos_of(const Job& job) const { return jobs_.folder_of(job) / "videos"; }

 private:
  std::filesystem::path views_of(const Job& job) const { return jobs_.folder_of(job) / "views"; }
  std::filesystem::path hashes_of(const Job& job, std::string_view name) const {
    return views_of(job) / (std::string(name) + ".hashes");
  }
  api::Status promise(const Job& job, const std::string& name, const std::string& request_json);
  Maker::Work work_of(const std::string& job_id, const std::string& name);
  api::Status make_view(const std::string& job_id, const std::string& name,
                        const std::atomic<bool>& stopping);
  api::Result<Video> ready_video(const Job& job, const std::string& file) const;
  api::Status make_video(const Job& job, const std::string& camera, const std::string& extension,
                         const std::atomic<bool>& stopping);
  api::Result<std::vector<ArtefactFile>> verified_files(const Job& job, std::string_view name);
  void forget_verified(const std::string& key);
  static std::filesystem::path sum_of(const std::filesystem::path& video) {
    return video.string() + ".sha256";
  }
  // check_made.cpp
  api::Status check_job(const Job& job, const std::atomic<bool>& stopping);
  api::Status check_view(const Job& job, const std::string& name, const std::atomic<bool>& stopping);
  api::Status check_video(const Job& job, const std::string& file, const std::atomic<bool>& stopping);
  void drop_view(const Job& job, const std::string& name, const std::string& why);
  std::string last_checked() const;
  void keep_checked(const std::string& id);

  JobService& jobs_;
  const DataFolder& folder_;
  ViewRules rules_;
  std::mutex changing_;  ///< of asking and removing, which wait for the disk; taken before mutex_
  std::mutex mutex_;     ///< of `verified_`; who only reads waits for nothing else
  std::map<std::string, std::vector<ArtefactFile>> verified_;  ///< "<job>/<view>", whose files were read
  std::optional<std::string> checked_;  ///< the last job that check_made has read; none: as the file says
  Maker maker_;                         ///< last: its threads use the rest
};

}  // namespace server
