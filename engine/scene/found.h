// What is found wrong with the files of a job.
#pragma once

#include <vector>

#include "api/result.h"

namespace engine {

inline constexpr const char* kObjFile = "scene.obj";
inline constexpr const char* kAnimationFile = "animation.json";

using Violations = std::vector<api::Violation>;

/// By where it was found, each list up to kViolationsMax, so that many of one kind do not hide the others.
struct Found {
  Violations request;    ///< in animation.json alone
  Violations obj;        ///< in scene.obj
  Violations names;      ///< what animation.json names and scene.obj lacks, and the other way round
  Violations materials;  ///< in MTL files and textures, and materials that are missing

  bool is_empty() const { return request.empty() && obj.empty() && names.empty() && materials.empty(); }
};

/// Of what is found, in the order of the lists, kViolationsMax at most: the first of each, evenly.
api::Error refused(const Found& found);

}  // namespace engine
