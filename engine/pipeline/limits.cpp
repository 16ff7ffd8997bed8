#include "engine/pipeline/limits.h"

#include "engine/base/rgb.h"

namespace engine {

api::Status check_size(const Patches& patches, std::uint32_t frame_count) {
  const std::uint64_t bytes = std::uint64_t{patches.count()} * frame_count * sizeof(Rgb);
  if (bytes <= kRadiosityBytesMax) return api::Done{};
  return api::Error{api::Fault::out_of_resources,
                    std::to_string(patches.count()) + " patches in " + std::to_string(frame_count) +
                        " frames take " + std::to_string(bytes >> 20) + " MiB of radiosity, more than " +
                        std::to_string(kRadiosityBytesMax >> 20) +
                        "; choose a larger patch_edge_m or fewer frames"};
}

}  // namespace engine
