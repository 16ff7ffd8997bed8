// What may be called what.
#pragma once

#include <string_view>

#include "api/json/reader.h"

namespace api {

inline constexpr std::size_t kNameBytesMax = 200;       ///< of a job, an object, a material, a light
inline constexpr std::size_t kAnyNameBytes = 1u << 10;  ///< of what is looked up, and told as not found
inline constexpr std::size_t kFileNameBytesMax = 64;    ///< of a camera, a group of lights

/// Each says so where `name`, which `node` has, will not do, and answers false.

/// Of an object, a material, a light: printable and not empty.
bool is_obj_name(const Node& node, std::string_view name);
/// Of a camera: it becomes the name of a folder.
bool is_folder_name(const Node& node, std::string_view name);
/// Of a group of lights: it becomes part of the name of a file, radiosity_<group>.npy, beside
/// radiosity_se.npy.
bool is_group_name(const Node& node, std::string_view name);

}  // namespace api
