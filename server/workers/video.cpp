// Videos, by ffmpeg: our own child, told by arguments, without a shell, and shut in as a worker is (keylume
// confine): it decodes pictures that a worker has made, who may have lied.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "api/fault_point.h"
#include "server/artefacts/verify.h"
#include "server/workers/run_child.h"
#include "server/workers/view_files.h"
#include "server/workers/view_service.h"

namespace server {
namespace {

constexpr std::int64_t kRoomBytes = 1 << 20;  // with less than that any write may have failed

api::Error failure_of(const ChildOutcome& outcome, const std::filesystem::path& folder) {
  const auto free = free_bytes(folder);
  const bool full = outcome.log_tail.find("No space left on device") != std::string::npos;
  if (full || (free && *free < kRoomBytes))
    return {api::Fault::disk_full, "the disk is full: " + outcome.log_tail};
  // An ffmpeg may be built without an encoder, as that of the image's variant without x264 is. "preset" is an
  // option that no other encoder of ours has, and ffmpeg looks at options first.
  for (const char* lacks : {"Unknown encoder", "Unrecognized option 'preset'"})
    if (outcome.log_tail.find(lacks) != std::string::npos)
      return {api::Fault::out_of_resources,
              "the ffmpeg beside this server has no encoder for such a video: another format may do"};
  return {api::Fault::internal, "ffmpeg failed: " + outcome.log_tail};
}

/// In the name of a sequence of pictures % begins a number.
std::string without_percent(const std::string& path) {
  std::string out;
  for (const char c : path) out.append(c == '%' ? 2 : 1, c);
  return out;
}

std::vector<std::string> arguments_for(const std::filesystem::path& pictures, double fps,
                                       const std::string& extension, const std::filesystem::path& to) {
  std::array<char, 32> rate{};
  std::snprintf(rate.data(), rate.size(), "%.6f", fps);
  // 4:2:0 has half as many colours each way, so the size must be even: an odd one gets a black row or column.
  const std::string filter =
      "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=in_range=pc:out_range=tv:out_color_matrix=bt709,format=yuv420p";
  std::vector<std::string> arguments{"-nostdin",
                                     "-hide_banner",
                                     "-loglevel",
                                     "error",
                                     "-y",
                                     "-protocol_whitelist",
                                     "file,pipe",
                                     "-threads",
                                     "2",
                                     "-f",
                                     "image2",
                                     "-framerate",
                                     rate.data(),
                                     "-start_number",
                                     "0",
                                     "-i",
                                     "file:" + without_percent(pictures.string()) + "/%04d.png",
                                     "-vf",
                                     filter,
                                     "-an",
                                     "-map_metadata",
                                     "-1",
                                     "-colorspace",
                                     "bt709",
                                     "-color_primaries",
                                     "bt709",
                                     "-color_trc",
                                     "iec61966-2-1",
                                     "-color_range",
                                     "tv"};
  const std::vector<std::string> h264{"-c:v", "libx264",   "-preset",    "medium", "-crf",
                                      "18",   "-movflags", "+faststart", "-f",     "mp4"};
  const std::vector<std::string> vp9{"-c:v", "libvpx-vp9", "-crf", "24",      "-b:v", "0",  "-deadline",
                                     "good", "-cpu-used",  "4",    "-row-mt", "1",    "-f", "webm"};
  const auto& codec = extension == "mp4" ? h264 : vp9;
  arguments.insert(arguments.end(), codec.begin(), codec.end());
  arguments.insert(arguments.end(), {"-fflags", "+bitexact", "-threads", "2", "file:" + to.string()});
  return arguments;
}

/// An empty file, the one thing that ffmpeg may write to.
api::Status make_empty(const std::filesystem::path& file) {
  ::unlink(file.c_str());
  const FileHandle made(::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0640));
  return made ? api::Status(api::Done{}) : file_error(file.string(), errno);
}

/// `ffmpeg` with `its` arguments, which reads `pictures` and writes the file `to`.
std::vector<std::string> confined(const std::filesystem::path& ffmpeg, const std::filesystem::path& pictures,
                                  const std::filesystem::path& to, const std::vector<std::string>& its) {
  std::vector<std::string> arguments{"confine",      "--reads",  pictures.string(),          "--writes",
                                     to.string(),    "--parent", std::to_string(::getpid()), "--",
                                     ffmpeg.string()};
  arguments.insert(arguments.end(), its.begin(), its.end());
  return arguments;
}

}  // namespace

std::filesystem::path find_ffmpeg() {
  const char* variable = std::getenv("PATH");
  std::string_view folders = variable ? variable : "";
  while (!folders.empty()) {
    const std::size_t colon = folders.find(':');
    const auto path = std::filesystem::path(folders.substr(0, colon)) / "ffmpeg";
    std::error_code error;
    if (path.is_absolute() && std::filesystem::is_regular_file(path, error) &&
        ::access(path.c_str(), X_OK) == 0)
      return path;
    folders = colon == folders.npos ? std::string_view() : folders.substr(colon + 1);
  }
  return {};
}

api::Status ViewService::make_video(const Job& job, const std::string& camera, const std::string& extension,
                                    const std::atomic<bool>& stopping) {
  const std::filesystem::path folder = videos_of(job), file = folder / (camera + "." + extension);
  std::error_code failed;
  std::filesystem::create_directory(folder, failed);
  if (failed) return file_error(folder.string(), failed.value());
  // Named by this process: what became of an ffmpeg of a server before it writes elsewhere.
  const std::filesystem::path temporary =
      folder / (".tmp." + std::to_string(::getpid()) + "." + file.filename().string());
  if (api::Status made = make_empty(temporary); !made) return made;
  std::filesystem::remove(sum_of(file), failed);  // of one that is gone
  const std::filesystem::path pictures = jobs_.folder_of(job) / "artefacts/images" / camera;
  ChildTask task;
  task.program = rules_.program;
  task.arguments =
      confined(rules_.ffmpeg, pictures, temporary, arguments_for(pictures, job.fps, extension, temporary));
  task.limits.memory_bytes = rules_.ffmpeg_memory_bytes;
  task.limits.file_bytes = std::uint64_t{4} << 30;
  task.limits.open_files = 64;
  task.time_max = rules_.time_max;
  task.log_folder = jobs_.folder_of(job);
  task.log_title = "video";
  const auto outcome = run_child(task, stopping);
  const auto finish = [&]() -> api::Status {
    if (!outcome) return outcome.error();
    if (outcome->end.exit_code != 0) return failure_of(*outcome, folder);
    const auto made = open_below(folder, temporary.filename().string());
    if (!made) return made.error();
    const auto hash = sha256_of(*made);
    if (!hash) return hash.error();
    if (::fsync(made->get()) != 0) return file_error("sync a video", errno);
    api::fault_point("video_written");
    if (::rename(temporary.c_str(), file.c_str()) != 0) return file_error(file.string(), errno);
    api::fault_point("video_renamed");
    if (api::Status kept = write_durably(sum_of(file), *hash); !kept) return kept;
    api::fault_point("video_summed");
    return api::Done{};
  };
  api::Status status = finish();
  if (!status) std::filesystem::remove(temporary, failed);
  jobs_.record_bytes(job);
  return status;
}

/// State none where it is not there, or not whole yet.
api::Result<Video> ViewService::ready_video(const Job& job, const std::string& file) const {
  Video video;
  video.file = file;
  const auto hash = read_below(videos_of(job), file + ".sha256", kSumBytes);
  const auto opened = open_below(videos_of(job), file);
  if (!hash || !opened || hash->size() != kSumBytes ||
      hash->find_first_not_of("0123456789abcdef") != hash->npos)
    return video;
  const auto bytes = size_of(*opened);
  if (!bytes) return bytes.error();
  video.state = MadeState::ready;
  video.sha256 = *hash;
  video.bytes = *bytes;
  return video;
}

api::Result<Video> ViewService::ask_video(const Job& job, const std::string& camera,
                                          const std::string& extension) {
  const std::string file = camera + "." + extension;
  if (auto ready = ready_video(job, file); !ready || ready->state == MadeState::ready) return ready;
  const std::lock_guard lock(changing_);
  if (const auto still = jobs_.job(job.id); !still) return still.error();
  // It may have come while others were asking.
  auto video = ready_video(job, file);
  if (!video || video->state == MadeState::ready) return video;
  if (const api::Status whole = jobs_.must_be_whole(job, "images/" + camera + "/*"); !whole)
    return whole.error();
  if (!has_ffmpeg())
    return api::Error{api::Fault::out_of_resources,
                      "this server makes no videos: ffmpeg is not installed beside it"};
  const std::string key = job.id + "/videos/" + file;
  const Maker::Look look = maker_.look(key);
  if (look.state == Maker::State::failed) {
    (void)maker_.forget(key);  // told once; whoever asks again has it tried again
    return look.error;
  }
  if (const auto room = jobs_.within_quota(job.owner, 1); !room) return room.error();
  const auto asked = maker_.ask(key, [this, job, camera, extension](const std::atomic<bool>& stopping) {
    return make_video(job, camera, extension, stopping);
  });
  if (!asked) return asked.error();
  video->state = look.state == Maker::State::making ? MadeState::making : MadeState::waiting;
  if (look.state == Maker::State::waiting) video->error = look.error;
  return video;
}

}  // namespace server
