#include "engine/image/weld.h"

#include <gtest/gtest.h>

#include <chrono>

#include "engine/image/shading_mesh.h"
#include "tests/unit/image/rooms.h"

namespace engine {
namespace {

using tests::add_polygon;

/// Two squares side by side, of `size`, whose neighbouring corners are `gap` apart.
void add_pair(Scene& scene, float size, float gap, std::uint32_t object) {
  add_polygon(scene, {{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, size, 0}}, object);
  const float x = size + gap;
  add_polygon(scene, {{x, 0, 0}, {x + size, 0, 0}, {x + size, size, 0}, {x, size, 0}}, object);
}

std::uint32_t node_count(const Scene& scene) {
  const auto patches = mesh_into_patches(scene, 1e6);
  EXPECT_TRUE(patches);
  return build_shading_mesh(*patches).node_count;
}

// A watch and a mountain: a gap of a hundredth of a millimetre is one in the watch, whatever the mountain's
// size.
TEST(Weld, TheToleranceIsThatOfTheObject) {
  Scene scene = tests::scene_with(2, 1);
  add_pair(scene, 1e-3f, 1e-5f, 0);
  EXPECT_EQ(node_count(scene), 8u);
  add_pair(scene, 1e4f, 0, 1);
  EXPECT_EQ(node_count(scene), 8u + 6u);
}

TEST(Weld, PointsOfOneObjectWithinRoundingAreOneAndThoseOfTwoAreNot) {
  Scene scene = tests::scene_with(2, 1);
  add_pair(scene, 1, 1e-7f, 0);
  EXPECT_EQ(node_count(scene), 6u);
  add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 1);
  EXPECT_EQ(node_count(scene), 6u + 4u);
}

// Each of 60 000 objects has the same corners in its own space. In lists of all objects, 4 x 60 000^2 / 2
// comparisons would take some 20 s.
TEST(Weld, ManyObjectsOfTheSameShapeTakeNoLongerThanApart) {
  constexpr std::uint32_t kObjects = 60'000;
  Scene scene = tests::scene_with(kObjects, 1);
  for (std::uint32_t object = 0; object < kObjects; ++object)
    add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, object);
  const auto patches = mesh_into_patches(scene, 10);
  ASSERT_TRUE(patches);
  Welder welder(*patches);
  const auto start = std::chrono::steady_clock::now();
  std::uint32_t nodes = 0;
  for (const Facet& facet : patches->facets)
    for (const Vec3 corner : facet.corners) {
      EXPECT_EQ(welder.node_at({corner, facet.normal, facet.object, facet.material}, nodes), nodes);
      ++nodes;
    }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
}

}  // namespace
}  // namespace engine
