// The parts of animation.json, one reader each. What is wrong goes to the node's findings; the returned value
// is whole only where nothing was added to them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "api/image_options.h"
#include "api/json/reader.h"
#include "api/lighting_options.h"
#include "api/scene_description.h"

namespace api {

inline constexpr std::size_t kObjectsMax = 10'000;    ///< in animation.json; the OBJ may hold more
inline constexpr std::size_t kMaterialsMax = 10'000;  ///< in animation.json; the MTL may hold more
inline constexpr std::size_t kLightsMax = 1000;
inline constexpr std::size_t kCamerasMax = 64;
inline constexpr std::size_t kImagesMax = 16;
inline constexpr Range kCoordinate{-1e9, 1e9};  ///< metres, or whatever unit the scene is in

inline constexpr std::array kLightingModes{
    Named<LightingMode>{"default", LightingMode::standard}, Named<LightingMode>{"paper", LightingMode::paper},
    Named<LightingMode>{"paper-literal", LightingMode::paper_literal},
    Named<LightingMode>{"reference", LightingMode::reference},
    Named<LightingMode>{"frame-by-frame", LightingMode::frame_by_frame}};

ObjectAnimation read_object(const Node& node, FrameIndex frame_count);
RotationTrack read_rotation(const Node& node, FrameIndex frame_count);
MaterialSettings read_material(const Node& node, FrameIndex frame_count);
LightSource read_light(const Node& node, FrameIndex frame_count);
Camera read_camera(const Node& node, FrameIndex frame_count);
LightingOptions read_lighting(const Node& node);
/// Size, formats, exposure, tone map, samples: all but the camera.
void read_image_fields(const Node& node, ImageOptions& image);
void read_camera_name(const Node& node, const std::map<std::string, Camera>& cameras, ImageOptions& image);
std::vector<ImageOptions> read_images(const Node& node, const std::map<std::string, Camera>& cameras);

}  // namespace api
