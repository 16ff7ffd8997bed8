// A scene, cut and ready for rays, for the tests of the engine's stages.
#pragma once

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/lighting/lit_scene.h"
#include "engine/patches/patches.h"
#include "engine/visibility/ray_scene.h"
#include "tests/unit/image/rooms.h"

namespace tests {

/// Everything that a stage asks for. Built once from a scene and its animation.
struct World {
  engine::Scene scene;
  engine::Animation animation;
  engine::Patches patches;
  engine::StaticRays static_rays;

  World(engine::Scene from, engine::Animation moves, double patch_edge_m)
      : scene(std::move(from)),
        animation(std::move(moves)),
        patches(*engine::mesh_into_patches(scene, patch_edge_m)),
        static_rays(patches, animation) {}
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  engine::LitScene lit() const { return {scene, animation, patches, static_rays}; }

  std::vector<engine::FrameIndex> all_frames() const { return every_frame(animation); }
};

/// Where a hit is, from its (u, v) and the pose of its object.
inline Vec3 position_of(const engine::Patches& patches, const engine::SurfaceHit& hit,
                        const engine::Pose& pose = {}) {
  const engine::Facet& facet = patches.facets[hit.facet];
  return engine::transform_point(pose, facet.origin + hit.u * facet.edge_u + hit.v * facet.edge_v);
}

/// Rays between two uniform points of a cube about the origin, from a seed.
class RandomRays {
 public:
  RandomRays(float half_size, unsigned seed) : uniform_(-half_size, half_size), random_(seed) {}
  Vec3 point() {
    const float x = uniform_(random_), y = uniform_(random_), z = uniform_(random_);
    return {x, y, z};
  }
  engine::Ray next() {
    const Vec3 from = point(), to = point();
    return {from, to - from, 0.0f, 1.0f};
  }

 private:
  std::uniform_real_distribution<float> uniform_;
  std::mt19937 random_;
};

}  // namespace tests
