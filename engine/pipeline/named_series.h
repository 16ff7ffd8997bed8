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

}  // namespace engine
