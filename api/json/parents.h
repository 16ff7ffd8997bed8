// Objects that carry other objects, and lights.
#pragma once

#include <map>
#include <string>

#include "api/json/reader.h"
#include "api/scene_description.h"

namespace api {

inline constexpr std::size_t kParentsMax = 16;  ///< one above the other, over any object

/// The name of an object; "" where the node holds none. Whether there is such an object is seen once all of
/// them are read.
std::string read_parent(const Node& node);

/// Each says so at the member "parent" of the member of `node` that it is about.

/// Parents are others of `objects`, none carries itself, and at most kParentsMax are above any.
void check_parents(const Node& node, const std::map<std::string, ObjectAnimation>& objects);
/// The parents of lights are among `objects`.
void check_parents(const Node& node, const std::map<std::string, LightSource>& lights,
                   const std::map<std::string, ObjectAnimation>& objects);

}  // namespace api
