// Direct light of the estimate, in steps that a killed run goes on from.
#pragma once

#include <functional>
#include <string_view>

#include "api/lighting_options.h"
#include "api/result.h"
#include "engine/base/checkpoint.h"
#include "engine/base/progress.h"
#include "engine/estimate/estimate.h"

namespace engine {

/// What the direct light is kept under.
inline constexpr std::string_view kEstimateDirectName = "estimate-direct";

/// Where an estimate is kept while it is made, so that a killed run goes on from there.
struct EstimateCheckpoints {
  Checkpoints* files = nullptr;  ///< null: nothing is kept
  /// Told what share of the direct light an earlier run had done, where it had.
  std::function<void(double share)> go_on_from = [](double) {};
};

/// Lights every group of `estimate` in every frame. Error: stopped.
api::Status light_estimate_directly(const Animation& animation, const StaticRays& static_rays,
                                    const api::LightingOptions& options,
                                    const EstimateCheckpoints& checkpoints, Estimate& estimate,
                                    const Progress& progress);

}  // namespace engine
