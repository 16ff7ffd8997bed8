// Reading a scene and cutting it into patches, by itself.
#pragma once

#include <filesystem>
#include <vector>

#include "api/result.h"

namespace engine {

struct LoadSpeed {
  std::uint64_t obj_bytes = 0, polygons = 0, patches = 0;
  std::vector<double> load_s;     ///< OBJ and MTL -> Scene, one thread, processor time  [s]
  std::vector<double> patches_s;  ///< the same of Scene -> Patches  [s]
  std::uint64_t array_bytes = 0;  ///< what Scene and Patches hold in the end
  std::uint64_t peak_bytes = 0;   ///< largest resident set meanwhile beyond that before
};

/// Reads scene.obj of `input_folder` (a job's) as often as said, one patch per triangle. Sets the number of
/// threads to one meanwhile: nothing else should run in the process. Errors: those of reading it; internal
/// where the kernel does not tell memory.
api::Result<LoadSpeed> measure_load_speed(const std::filesystem::path& input_folder, int repetitions);

}  // namespace engine
