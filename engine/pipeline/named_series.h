// A series that becomes an artefact beside radiosity.npy.
#pragma once

#include <string>

#include "engine/lighting/radiosity.h"

namespace engine {

/// Of the same patches and frames as the radiosity.
struct NamedSeries {
  std::string file;  ///< "radiosity_se.npy": a plain name, of no other artefact
  PatchSeries values_w_m2;
};

/// The file of what the lights of a group give; "": those of no group.
inline std::string file_of_group(const std::string& name) {
  return "radiosity_" + (name.empty() ? "other" : name) + ".npy";
}

}  // namespace engine
