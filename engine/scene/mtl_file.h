// An MTL file as it stands: what it says of diffuse light, and where.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "api/result.h"
#include "engine/base/rgb.h"
#include "engine/scene/file_violations.h"
#include "engine/scene/scene.h"

namespace engine {

/// A colour and where it stands; line 0: not given. Three finite numbers, not checked for their range.
struct MtlColour {
  double r = 0, g = 0, b = 0;
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};

struct MtlMaterial {
  NamedPlace name;
  MtlColour kd;       ///< reflectance  [-]
  MtlColour ke;       ///< emitted radiance  [W sr^-1 m^-2]
  NamedPlace map_kd;  ///< texture as the file names it; line 0: none
  bool map_kd_has_options = false;
  std::string file;  ///< the MTL file's base name
};

/// Appends the materials of one file. Violations carry line and column; reading stops when they are full.
/// Error: out_of_resources beyond limits.materials or limits.line_bytes, internal where reading fails.
api::Status read_mtl_file(const std::filesystem::path& file, const SceneLimits& limits,
                          FileViolations& violations, IgnoredStatements& ignored,
                          std::vector<MtlMaterial>& materials);

}  // namespace engine
