// The worker with an engine that behaves as the first word says: `worker_under_test BEHAVIOUR render ...`.
// life_test.cpp runs it as a process and ends it in every way.
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "engine/output/artefacts.h"
#include "engine/worker/commands.h"

namespace {

using namespace std::chrono_literals;

/// life_test.cpp leaves this descriptor open for a worker to inherit.
constexpr int kSupervisorsFile = 100;

using Behaviour = api::Status (*)(const engine::RunHooks&, const std::filesystem::path& artefacts);

api::Status stop_when_told(const engine::RunHooks& hooks, const std::filesystem::path&) {
  while (!hooks.stop_requested()) std::this_thread::sleep_for(10ms);
  return api::Error{api::Fault::stopped, "told to stop"};
}

api::Status never_listen(const engine::RunHooks&, const std::filesystem::path&) {
  for (;;) std::this_thread::sleep_for(1h);
}

/// Fails once the file input/now is there.
api::Status fail_when_asked(const engine::RunHooks&, const std::filesystem::path& artefacts) {
  const auto inside = [](const std::filesystem::path& folder) { return folder / "input/now"; };
  while (!std::filesystem::exists(inside(artefacts)) &&
         !std::filesystem::exists(inside(artefacts.parent_path())))
    std::this_thread::sleep_for(10ms);
  return api::Error{api::Fault::internal, "of its own accord"};
}

api::Status burn(const engine::RunHooks&, const std::filesystem::path&) {
  for (volatile unsigned long turns = 0;;) turns = turns + 1;
}

api::Status swallow_memory(const engine::RunHooks&, const std::filesystem::path&) {
  std::vector<std::vector<char>> all;
  for (;;) all.emplace_back(1u << 20, 'x');
}

api::Status fill_the_disk(const engine::RunHooks&, const std::filesystem::path& artefacts) {
  for (int i = 0;; ++i)
    if (const auto written = engine::write_file(artefacts / std::to_string(i), std::string(65536, 'x'));
        !written)
      return written;
}

/// What this process is among others, as `key value` lines in artefacts/process.
api::Status describe_process(const engine::RunHooks&, const std::filesystem::path& artefacts) {
  std::ofstream out(artefacts / "process");
  rlimit core{};
  getrlimit(RLIMIT_CORE, &core);
  int death_signal = 0;
  prctl(PR_GET_PDEATHSIG, &death_signal);
  const mode_t mask = umask(0);
  std::string oom_score;
  std::ifstream("/proc/self/oom_score_adj") >> oom_score;
  out << "no_new_privs " << prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) << "\ncore " << core.rlim_cur << "\numask "
      << mask << "\nnice " << getpriority(PRIO_PROCESS, 0) << "\noom_score_adj " << oom_score
      << "\ndeath_signal " << death_signal << "\nsupervisors_file "
      << (fcntl(kSupervisorsFile, F_GETFD) < 0 ? "closed" : "open") << "\n";
  return api::Done{};
}

const std::map<std::string, Behaviour> kBehaviours{
    {"stop_when_told", stop_when_told},    {"never_listen", never_listen},
    {"fail_when_asked", fail_when_asked},  {"burn", burn},
    {"swallow_memory", swallow_memory},    {"fill_the_disk", fill_the_disk},
    {"describe_process", describe_process}};

}  // namespace

int main(int argc, char** argv) {
  const auto behaviour = argc > 1 ? kBehaviours.find(argv[1]) : kBehaviours.end();
  if (behaviour == kBehaviours.end()) return 99;
  const auto pipeline = [&](const api::JobRequest&, const std::filesystem::path&,
                            const std::filesystem::path& artefacts, const engine::RunHooks& hooks,
                            api::JobReport&) {
    hooks.progress({api::Stage::solve, 0.5, 0.5, "begun"});
    return behaviour->second(hooks, artefacts);
  };
  const auto checker = [&](const api::JobRequest&, const std::filesystem::path& input, unsigned,
                           api::JobReport&) {
    std::ofstream(input.parent_path() / "begun") << "begun";
    return behaviour->second({}, input.parent_path());
  };
  const std::vector<std::string_view> words(argv + 2, argv + argc);
  return static_cast<int>(engine::run_worker(words, pipeline, checker, {}));
}
