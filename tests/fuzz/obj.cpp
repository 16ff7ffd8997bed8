// scene.obj
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/scene/obj_file.h"
#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static tests::MemoryFile file;
  engine::SceneLimits limits;
  limits.line_bytes = 4096;  // within reach, and a small buffer
  file.hold(data, size);
  const std::vector<std::string> animated{"lamp", "door"};
  std::vector<api::Violation> found;
  engine::FileViolations violations{"scene.obj", found};
  const auto obj =
      engine::read_obj_file(file.path(), animated, 1.0, limits, violations, [] { return false; });
  if (!obj || !found.empty()) return 0;
  for (const std::uint32_t corner : obj->corners)
    if (corner >= obj->vertices.size()) std::abort();
  for (const engine::Vec3& vertex : obj->vertices)
    if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) std::abort();
  return 0;
}
