#include "engine/direct/direct_checkpoint.h"

namespace engine {
namespace {

/// Into room of the same size.
template <class Values>
bool take_all(SavedCheckpoint& saved, Values& values) {
  const std::size_t size = values.size();
  return saved.take(values) && values.size() == size;
}

}  // namespace

void add_parts(const DirectLight& direct, std::vector<CheckpointPart>& parts) {
  parts.push_back(part_of_checkpoint(direct.irradiance_w_m2.values));
  parts.push_back(part_of_checkpoint(direct.variance.values));
  parts.push_back(part_of_checkpoint(direct.at_rest_w_m2));
  parts.push_back(part_of_checkpoint(direct.counts));
}

bool take(SavedCheckpoint& saved, DirectLight& direct) {
  return take_all(saved, direct.irradiance_w_m2.values) && take_all(saved, direct.variance.values) &&
         take_all(saved, direct.at_rest_w_m2) && saved.take(direct.counts);
}

}  // namespace engine
