// Pictures of a finished job that it did not ask for: another camera, size, frames or exposure, without
// solving again. JSON: api/openapi.yaml, components/schemas/ViewRequest.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "api/ids.h"
#include "api/image_options.h"
#include "api/job_request.h"
#include "api/result.h"
#include "api/scene_description.h"

namespace api {

struct ViewRequest {
  /// `camera` names one of the job's, or is empty where `own_camera` is given.
  ImageOptions image;
  std::optional<Camera> own_camera;  ///< in the job's units and axes; keyed as those of a job
  std::vector<FrameIndex> frames;    ///< rising; of the job
  /// By light group: how many times as bright its lights are, per channel. 1 for groups that are not named.
  /// 0 .. kLightGainMax
  std::map<std::string, Vec3> light_gains;
  /// The request with everything filled in, members in order of name, so that requests that mean the same
  /// are the same text.
  std::string canonical_json;
};

inline constexpr double kLightGainMax = 1000;
inline constexpr std::size_t kViewBytesMax = 1u << 20;
/// Pixels of all frames of a view together: 1000 frames of full HD.
inline constexpr double kViewPixelsMax = 2.1e9;

/// What the job has that a view may name.
struct ViewedJob {
  std::uint32_t frame_count = 1;
  std::map<std::string, Camera> cameras;
  /// Whose radiosity it has; with those, also "other", the lights that no group names.
  std::set<std::string> light_groups = {};
};

/// None where the job's mode keeps no groups apart.
ViewedJob viewed_job(const JobRequest& job);

/// Errors: invalid_request with every violation, in a file of the name `file`.
Result<ViewRequest> parse_view_request(std::string_view bytes, const ViewedJob& job,
                                       std::string_view file = "view.json");

}  // namespace api
