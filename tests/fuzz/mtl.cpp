// The MTL file that a scene names.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "engine/scene/mtl_file.h"
#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static tests::MemoryFile file;
  engine::SceneLimits limits;
  limits.line_bytes = 4096;  // within reach, and a small buffer
  file.hold(data, size);
  std::vector<api::Violation> found;
  engine::FileViolations violations{"room.mtl", found};
  engine::IgnoredStatements ignored;
  std::vector<engine::MtlMaterial> materials;
  const api::Status read = engine::read_mtl_file(file.path(), limits, violations, ignored, materials);
  if (!read || !found.empty()) return 0;
  for (const engine::MtlMaterial& material : materials)
    for (const double value : {material.kd.r, material.kd.g, material.kd.b, material.ke.r})
      if (!std::isfinite(value)) std::abort();  // ranges are looked at where materials are used
  return 0;
}
