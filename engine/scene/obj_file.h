// scene.obj as it stands: statements checked one by one, names not yet resolved.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "api/result.h"
#include "engine/scene/file_violations.h"
#include "engine/scene/scene.h"

namespace engine {

struct ObjFile {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> corner_uvs,
      corner_normals;  ///< as in Scene, but some of a polygon may have none
  std::vector<Uv> uvs;
  std::vector<Vec3> normals;      ///< unit, or zero where the file's is
  std::vector<Polygon> polygons;  ///< object: into the animated names, 0 = none; material: into `materials`

  /// As usemtl names them, in order of first use by a face; "" (line 0) for faces before any usemtl.
  std::vector<NamedPlace> materials;
  std::vector<NamedPlace> libraries;       ///< as mtllib names them, each once
  std::vector<bool> animated_seen;         ///< [animated name] is there an o or g of this name?
  std::vector<std::string> o_and_g_names;  ///< the first few thousand different ones, for suggestions
  std::uint64_t face_statements = 0;       ///< good and bad ones
  IgnoredStatements ignored;
};

/// Reads the file; violations (with line and column) are added to `violations`, which it stops at when full.
/// `animated` [1 ...] are the o and g names that get an object of their own; animated[0] is "".
/// Vertices are scaled by `metres_per_unit`.
/// Error: stopped, out_of_resources beyond `limits`, invalid_request (missing_file) where there is no such
/// file.
api::Result<ObjFile> read_obj_file(const std::filesystem::path& file, std::span<const std::string> animated,
                                   double metres_per_unit, const SceneLimits& limits,
                                   FileViolations& violations, const std::function<bool()>& stop_requested);

}  // namespace engine
