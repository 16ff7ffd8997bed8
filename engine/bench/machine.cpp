#include "engine/bench/machine.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "engine/base/parallel.h"
#include "engine/base/widest.h"
#include "engine/bench/bench_text.h"

namespace engine {
namespace {

/// What follows the colon of the first line that begins with `key`.
std::string found_in(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (!line.starts_with(key) || colon == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    return begin == std::string::npos ? "" : line.substr(begin);
  }
  return {};
}

/// As KEYLUME_WIDEST chooses.
std::string widest_registers() {
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f")) return "AVX-512";
  if (__builtin_cpu_supports("avx2")) return "AVX2";
  return "SSE2";
#else
  return "what the compiler was told";
#endif
}

std::string compiler_name() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace

double load_per_core() {
  double load = 0;
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  return getloadavg(&load, 1) == 1 && cores > 0 ? load / static_cast<double>(cores) : 0;
}

Machine this_machine() {
  Machine machine;
  machine.cpu = found_in("/proc/cpuinfo", "model name");
  if (machine.cpu.empty()) machine.cpu = "an unnamed processor";
  machine.cores = thread_count();
  machine.memory_gb =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e9;
  machine.isa = widest_registers();
  machine.compiler = compiler_name();
  machine.embree = KEYLUME_EMBREE_VERSION;
  machine.load = load_per_core();
  return machine;
}

std::string words_of(const Machine& machine) {
  std::string text = text_of("%s, %u cores, %.0f GB; kernels for %s; %s; Embree %s; load %.2f per core.",
                             machine.cpu.c_str(), machine.cores, machine.memory_gb, machine.isa.c_str(),
                             machine.compiler.c_str(), machine.embree.c_str(), machine.load);
  if (machine.load > kIdleLoad)
    text += "\n\n**Other programs were at work: times are too long, and their ratios rough.**";
  return text;
}

}  // namespace engine
