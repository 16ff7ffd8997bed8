// All that is wrong with a job's files at once, where animation.json is wrong already.
#pragma once

#include <filesystem>
#include <functional>

#include "api/read_request.h"
#include "api/result.h"
#include "engine/scene/scene.h"

namespace engine {

/// Why a job is refused whose animation.json is wrong: the violations of `read`, and with them those that
/// load_scene finds, evenly of both where there are more than kViolationsMax. What hangs on a part of
/// animation.json that could not be read is left out: what a material reflects and emits where its entry
/// there is wrong, and whether anything emits at all.
/// Answers invalid_request; or stopped.
api::Error refuse_scene(
    const std::filesystem::path& input_folder, const api::ReadRequest& read, const SceneLimits& limits = {},
    const TextureReader& texture_reader = refuse_texture,
    const std::function<bool()>& stop_requested = [] { return false; });

}  // namespace engine
