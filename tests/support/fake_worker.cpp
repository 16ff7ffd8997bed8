// A worker that behaves as it is told, to see what the server makes of it.
//
//   fake_worker render JOB_FOLDER ...     the n-th attempt does what line n of JOB_FOLDER/behaviour says (the
//   last fake_worker check JOB_FOLDER ...      line again when there are no more): see kBehaviours
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "api/exit_code.h"
#include "api/job_report.h"
#include "server/artefacts/verify.h"

namespace {

using std::filesystem::path;
using namespace std::chrono_literals;

int code(api::ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

void write(const path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

void append(const path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary | std::ios::app) << text << std::flush;
}

void progress(const path& job, double fraction) {
  append(job / "progress.ndjson",
         api::progress_line_json({api::Stage::solve, fraction, fraction, "working"}) + "\n");
}

struct File {
  std::string path;
  std::string content;
  std::string claimed_sha256;
  bool is_there = false;  ///< not to be written
};

void publish(const path& job, const std::vector<File>& files) {
  std::string manifest;
  for (const File& file : files) {
    if (!file.is_there) write(job / "artefacts" / file.path, file.content);
    manifest +=
        std::string(manifest.empty() ? "" : ",") + "{\"path\":\"" + file.path +
        "\",\"media_type\":\"application/octet-stream\",\"bytes\":" + std::to_string(file.content.size()) +
        ",\"sha256\":\"" + file.claimed_sha256 + "\"}";
  }
  api::KeyFrameReport report;
  for (api::FrameIndex frame = 0; frame < 3; ++frame)
    report.frames.push_back({frame, api::FrameKind::key, 0.0});
  write(job / "artefacts/key_frames.json", api::key_frame_report_json(report));
  write(job / "report.json", api::job_report_json({"succeeded", "", {}, {"a warning"}, {}, {}, 0}));
  write(job / "artefacts/manifest.json", "{\"artefacts\":[" + manifest + "]}");
}

File honest(const std::string& name, const std::string& content) {
  return {name, content, server::sha256_of(content)};
}

int succeed(const path& job) {
  progress(job, 0.5);
  std::cerr << "all is well\n";
  publish(job, {honest("radiosity.npy", "numbers"), honest("images/front/0000.png", "pixels")});
  progress(job, 1.0);
  return code(api::ExitCode::ok);
}

int crash(const path& job) {
  progress(job, 0.5);
  std::cerr << "about to crash\n";
  ::signal(SIGSEGV, SIG_DFL);  // a sanitizer would make an exit code of it
  ::raise(SIGSEGV);
  return 0;
}

int wait_for_term(const path& job) {
  static volatile sig_atomic_t told = 0;
  ::signal(SIGTERM, [](int) { told = 1; });
  while (!told) {
    progress(job, 0.3);
    std::this_thread::sleep_for(20ms);
  }
  return code(api::ExitCode::stopped);
}

int ignore_term(const path& job) {
  ::signal(SIGTERM, SIG_IGN);
  for (;;) {
    progress(job, 0.3);
    std::this_thread::sleep_for(20ms);
  }
}

int hang(const path&) {
  for (;;) std::this_thread::sleep_for(1h);
}

int compute_in_silence(const path&) {
  for (std::atomic<unsigned> n = 0;; ++n) {
  }
}

int lie_about_hash(const path& job) {
  publish(job, {{"radiosity.npy", "numbers", server::sha256_of("other numbers")}});
  return 0;
}

int point_outside(const path& job) {
  publish(job, {{"../input/scene.obj", "v 0 0 0\n", server::sha256_of("v 0 0 0\n"), true}});
  return 0;
}

int publish_a_link(const path& job) {
  publish(job, {{"link", "v 0 0 0\n", server::sha256_of("v 0 0 0\n"), true}});
  std::filesystem::remove(job / "artefacts/link");
  std::filesystem::create_symlink("../input/scene.obj", job / "artefacts/link");
  return 0;
}

int flood_progress(const path& job) {
  const std::string junk = "this is no progress line\n";
  for (;;) append(job / "progress.ndjson", junk);
}

int flood_log_then_succeed(const path& job) {
  const std::string line = std::string(1023, 'x') + "\n";
  for (int i = 0; i < 4096; ++i) std::cerr << line;
  return succeed(job);
}

int garble_progress_then_succeed(const path& job) {
  append(job / "progress.ndjson", "{\"stage\":\n[[[[[\n" + std::string(200'000, 'y') + "\n{}\n\n");
  return succeed(job);
}

int leave_a_grandchild(const path& job) {
  const pid_t child = ::fork();
  if (child == 0) {
    for (;;) std::this_thread::sleep_for(1h);
  }
  write(job / "grandchild", std::to_string(child));
  return succeed(job);
}

/// In a session of its own, where no signal to the worker's group reaches it.
int leave_a_hidden_process(const path& job) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::setsid();
    const pid_t hidden = ::fork();
    if (hidden != 0) ::_exit(0);
    write(job / "hidden", std::to_string(::getpid()));
    for (;;) std::this_thread::sleep_for(1h);
  }
  while (!std::filesystem::exists(job / "hidden")) std::this_thread::sleep_for(1ms);
  return succeed(job);
}

/// The same bytes under many names: quick to make, slow to read.
int publish_hard_links(const path& job) {
  publish(job, {honest("first", "numbers"), honest("second", "numbers")});
  std::filesystem::remove(job / "artefacts/second");
  std::filesystem::create_hard_link(job / "artefacts/first", job / "artefacts/second");
  return 0;
}

int publish_holes(const path& job) {
  constexpr std::uintmax_t kBytes = std::uintmax_t{64} << 30;
  const std::string hash = server::sha256_of("");
  publish(job, {{"huge", "", hash}});
  std::filesystem::resize_file(job / "artefacts/huge", kBytes);
  write(job / "artefacts/manifest.json",
        "{\"artefacts\":[{\"path\":\"huge\",\"media_type\":\"text/plain\",\"bytes\":" +
            std::to_string(kBytes) + ",\"sha256\":\"" + hash + "\"}]}");
  return 0;
}

/// A million values in two megabytes: fifty when they are built.
int publish_a_bloated_manifest(const path& job) {
  publish(job, {});
  std::string values;
  for (int i = 0; i < 1'000'000; ++i) values += i == 0 ? "1" : ",1";
  write(job / "artefacts/manifest.json", "{\"artefacts\":[" + values + "]}");
  return 0;
}

int plant_a_video(const path& job) {
  write(job / "videos/front.mp4", "no film");
  write(job / "videos/front.mp4.sha256", server::sha256_of("no film"));
  write(job / ("views/" + std::string(32, 'a') + ".json"), "{}");
  return succeed(job);
}

int write_without_end(const path& job) {
  write(job / "artefacts/endless", "");
  for (;;) {
    append(job / "artefacts/endless", std::string(1 << 20, 'x'));
    progress(job, 0.3);
    std::this_thread::sleep_for(1ms);
  }
}

int nest_folders(const path& job) {
  std::filesystem::current_path(job);
  for (int i = 0; i < 1200; ++i)
    if (::mkdir("deeper", 0700) != 0 || ::chdir("deeper") != 0) return code(api::ExitCode::internal);
  (void)::chmod(".", 0);
  return succeed(job);
}

int refuse(const path& job) {
  const api::Violation violation{"scene.obj", "", 12, 4, "index_out_of_range", "vertex 9 does not exist"};
  for (const char* file : {"report.json", "check.json"})  // of a run, of a check
    write(job / file, api::job_report_json({"failed", "scene.obj is refused", {violation}, {}, {}, {}, 0}));
  return code(api::ExitCode::invalid_input);
}

const std::vector<std::pair<std::string, std::function<int(const path&)>>> kBehaviours{
    {"succeed", succeed},
    {"crash", crash},
    {"wait_for_term", wait_for_term},
    {"ignore_term", ignore_term},
    {"hang", hang},
    {"compute_in_silence", compute_in_silence},
    {"nothing", [](const path&) { return 0; }},
    {"lie_about_hash", lie_about_hash},
    {"point_outside", point_outside},
    {"publish_a_link", publish_a_link},
    {"flood_progress", flood_progress},
    {"flood_log_then_succeed", flood_log_then_succeed},
    {"garble_progress_then_succeed", garble_progress_then_succeed},
    {"leave_a_grandchild", leave_a_grandchild},
    {"leave_a_hidden_process", leave_a_hidden_process},
    {"publish_hard_links", publish_hard_links},
    {"publish_holes", publish_holes},
    {"publish_a_bloated_manifest", publish_a_bloated_manifest},
    {"plant_a_video", plant_a_video},
    {"write_without_end", write_without_end},
    {"nest_folders", nest_folders},
    {"refuse", refuse},
    {"limit", [](const path&) { return code(api::ExitCode::limit_exceeded); }},
    {"disk_full", [](const path&) { return code(api::ExitCode::disk_full); }},
};

/// What this attempt is to do; each run adds a line to JOB_FOLDER/runs.
std::string behaviour(const path& job) {
  append(job / "runs", std::to_string(::getpid()) + "\n");
  std::ifstream runs(job / "runs");
  std::ifstream lines(job / "behaviour");
  std::string chosen = "succeed";
  std::string run;
  std::string line;
  while (std::getline(runs, run))
    if (std::getline(lines, line)) chosen = line;
  return chosen;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return code(api::ExitCode::usage);
  const path job = argv[2];
  const std::string wanted = behaviour(job);
  for (const auto& [name, act] : kBehaviours)
    if (name == wanted) return act(job);
  std::cerr << "there is no behaviour '" << wanted << "'\n";
  return code(api::ExitCode::usage);
}
