// Direct light in checkpoints.
#pragma once

#include <vector>

#include "engine/base/checkpoint.h"
#include "engine/direct/direct_light.h"

namespace engine {

/// Adds the parts of `direct`, which stays where it is until they are saved.
void add_parts(const DirectLight& direct, std::vector<CheckpointPart>& parts);

/// Takes them again. `direct`: of the size it had (DirectLighter::empty). False where that is not what is
/// there; then it holds nothing of use.
bool take(SavedCheckpoint& saved, DirectLight& direct);

}  // namespace engine
