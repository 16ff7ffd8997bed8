#include "engine/bench/load_speed.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "api/job_request.h"
#include "engine/base/parallel.h"
#include "engine/bench/bench_files.h"
#include "engine/bench/processor_time.h"
#include "engine/patches/patches.h"
#include "engine/scene/scene.h"

namespace engine {
namespace {

/// A line of /proc/self/status, "VmRSS"; 0 where there is none.  [bytes]
std::uint64_t status_bytes(const std::string& name) {
  std::ifstream file("/proc/self/status");
  constexpr std::uint64_t kKilobyte = 1024;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with(name + ":")) return kKilobyte * std::stoull(line.substr(name.size() + 1));
  return 0;
}

/// From now on VmHWM is the peak from now on; what earlier work has freed is given back first.
bool forget_peak() {
  malloc_trim(0);
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return static_cast<bool>(file);
}

template <class Element>
std::uint64_t bytes_of(const std::vector<Element>& elements) {
  return elements.size() * sizeof(Element);
}

std::uint64_t array_bytes(const Scene& scene, const Patches& patches) {
  return bytes_of(scene.vertices) + bytes_of(scene.corners) + bytes_of(scene.polygons) +
         bytes_of(patches.facets) + bytes_of(patches.facet_of) + bytes_of(patches.area_m2);
}

/// No edge is cut: one patch per polygon.
constexpr double kUncut = 1e4;

api::Status load_once(const std::filesystem::path& input_folder, const api::JobRequest& request,
                      LoadSpeed& speed) {
  if (!forget_peak()) return api::Error{api::Fault::internal, "the kernel does not forget a peak of memory"};
  const std::uint64_t before = status_bytes("VmRSS");
  double begin = processor_seconds();
  const auto scene = load_scene(input_folder, request.scene);
  if (!scene) return scene.error();
  speed.load_s.push_back(processor_seconds() - begin);
  begin = processor_seconds();
  const auto patches = mesh_into_patches(*scene, kUncut);
  if (!patches) return patches.error();
  speed.patches_s.push_back(processor_seconds() - begin);
  const std::uint64_t peak = status_bytes("VmHWM");
  if (peak <= before) return api::Error{api::Fault::internal, "the kernel does not tell the peak of memory"};
  speed.peak_bytes = std::max(speed.peak_bytes, peak - before);
  speed.array_bytes = array_bytes(*scene, *patches);
  speed.polygons = scene->polygons.size();
  speed.patches = patches->count();
  return api::Done{};
}

}  // namespace

api::Result<LoadSpeed> measure_load_speed(const std::filesystem::path& input_folder, int repetitions) {
  const auto bytes = read_bench_file(input_folder / "animation.json");
  if (!bytes) return bytes.error();
  const auto request = api::parse_job_request(*bytes);
  if (!request) return request.error();
  LoadSpeed speed;
  std::error_code failed;
  speed.obj_bytes = std::filesystem::file_size(input_folder / "scene.obj", failed);
  if (failed) return bench_file_error(input_folder / "scene.obj", failed);
  set_thread_count(1);
  api::Status status = api::Done{};
  for (int k = 0; k < repetitions && status; ++k) status = load_once(input_folder, *request, speed);
  set_thread_count(0);
  if (!status) return status.error();
  return speed;
}

}  // namespace engine
