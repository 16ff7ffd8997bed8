// Embree and nothing else: what the tracer of lines is measured against.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/visibility/ray_scene.h"

namespace engine {

class RawRays {
 public:
  /// The facets of StaticRays and, at all their poses in the window `frames`, those of MovingRays.
  RawRays(const Patches& patches, const Animation& animation, std::span<const FrameIndex> frames,
          bool robust);
  ~RawRays();
  RawRays(const RawRays&) = delete;
  RawRays& operator=(const RawRays&) = delete;

  /// The nearest hit of every ray in either scene, ray by ray. Answers how many there were.
  std::uint64_t nearest(std::span<const Ray> rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engine
