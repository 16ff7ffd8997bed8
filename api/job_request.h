// A whole job as the client asks for it: animation.json, checked.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "api/image_options.h"
#include "api/lighting_options.h"
#include "api/result.h"
#include "api/scene_description.h"

namespace api {

inline constexpr std::uint32_t kFramesMax = 2000;
inline constexpr std::size_t kAnimationBytesMax = 8u << 20;  ///< of animation.json

struct JobRequest {
  std::string name;               ///< for people; up to 200 bytes of UTF-8
  std::uint32_t frame_count = 1;  ///< 1 .. kFramesMax; frames count from 0
  double fps = 24.0;              ///< (0, 1000]; only videos and plots use it
  SceneDescription scene;
  LightingOptions lighting;
  std::vector<ImageOptions> images;  ///< up to 16

  friend bool operator==(const JobRequest&, const JobRequest&) = default;
};

/// animation.json as bytes -> the job, or every violation in it (up to kViolationsMax), each with its JSON
/// pointer and with Violation::file = `file`. What only the OBJ can tell (does an object exist?) is checked
/// by engine::load_scene. Defined in api/json/.
Result<JobRequest> parse_job_request(std::string_view bytes, std::string_view file = "animation.json");

}  // namespace api
