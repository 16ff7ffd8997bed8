// What a shaft calls outside must be in the way of no ray in it.
#include "engine/visibility/shaft.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/visibility/occluders.h"

namespace engine {
namespace {

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  float number(float low, float high) { return std::uniform_real_distribution<float>(low, high)(generator_); }
  Vec3 point(float half) { return {number(-half, half), number(-half, half), number(-half, half)}; }

  /// A parallelogram, or a triangle, somewhere in a cube.
  PlacedFacet facet(float half, float size, bool is_triangle = false) {
    PlacedFacet facet;
    facet.origin = point(half);
    facet.edge_u = point(size);
    facet.edge_v = point(size);
    facet.normal = normalized(cross(facet.edge_u, facet.edge_v));
    const Vec3 o = facet.origin, u = facet.edge_u, v = facet.edge_v;
    facet.corners = {o, o + u, is_triangle ? o + v : o + u + v, o + v};
    return facet;
  }
  Vec3 point_of(const PlacedFacet& facet) {
    return facet.origin + number(0, 1) * facet.edge_u + number(0, 1) * facet.edge_v;
  }

 private:
  std::mt19937 generator_;
};

ShaftEnd end_of(const PlacedFacet& facet) {
  return {facet.corners, 4, facet.normal, 1e-5f};
}

/// A ray from one end to the other, where they face each other.
bool between(const PlacedFacet& from, const PlacedFacet& to, Random& random, Ray& ray) {
  const Vec3 a = random.point_of(from), b = random.point_of(to);
  ray = {a + 1e-5f * from.normal, (b + 1e-5f * to.normal) - (a + 1e-5f * from.normal), 0.0f, 1.0f};
  return dot(from.normal, b - a) > 0 && dot(to.normal, a - b) > 0;
}

std::uint32_t lanes_crossed(const Occluder& facet, const Ray& ray) {
  RayLanes lanes{};
  lanes.set(3, ray);
  return (crossed_by(facet, lanes) >> 3) & 1u;
}

TEST(Shaft, MeetsEveryFacetAndBoxThatBlocksARayInIt) {
  Random random(1);
  int blocked = 0, outside = 0;
  for (int scene = 0; scene < 8000; ++scene) {
    const bool is_triangle = scene % 2 == 0;
    const PlacedFacet from = random.facet(2, 0.5f), to = random.facet(2, 1),
                      other = random.facet(2, 1.5f, is_triangle);
    const Shaft shaft(end_of(from), end_of(to));
    const Occluder facet(other, is_triangle);
    FacetLanes lanes;
    lanes.set(5, facet.corners, facet.normal);
    const bool meets = shaft.may_meet(lanes) == 1u << 5;
    outside += meets ? 0 : 1;
    for (int k = 0; k < 50; ++k) {
      Ray ray;
      if (!between(from, to, random, ray) || lanes_crossed(facet, ray) == 0) continue;
      ++blocked;
      ASSERT_TRUE(meets) << scene;
      ASSERT_TRUE(shaft.may_meet(box_of(facet.corners))) << scene;
    }
  }
  EXPECT_GT(blocked, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(Shaft, LeavesOutWhatLiesInThePlanesOfItsEndsOrBehindThem) {
  const std::array<Vec3, 4> floor{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::array<Vec3, 4> lamp{Vec3{0, 0, 2}, {0, 1, 2}, {1, 1, 2}, {1, 0, 2}};
  const Shaft shaft({floor, 4, {0, 0, 1}, 1e-6f}, {lamp, 4, {0, 0, -1}, 1e-6f});
  const auto meets = [&](std::array<Vec3, 4> corners, Vec3 normal) {
    FacetLanes lanes;
    lanes.set(0, corners, normal);
    return shaft.may_meet(lanes) != 0;
  };
  const auto at_height = [](float z) {
    return std::array<Vec3, 4>{Vec3{-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z}};
  };
  EXPECT_FALSE(meets(at_height(0), {0, 0, 1}));
  EXPECT_FALSE(meets(at_height(2), {0, 0, 1}));
  EXPECT_FALSE(meets(at_height(2.5f), {0, 0, 1}));
  EXPECT_TRUE(meets(at_height(1), {0, 0, 1}));
  // A wall that touches both ends stands beside the shaft, whatever its size.
  EXPECT_FALSE(meets({Vec3{0, -9, -9}, {0, 9, -9}, {0, 9, 9}, {0, -9, 9}}, {1, 0, 0}));
  EXPECT_TRUE(meets({Vec3{0.5f, -9, -9}, {0.5f, 9, -9}, {0.5f, 9, 9}, {0.5f, -9, 9}}, {1, 0, 0}));
}

// Beside a large end the planes about a small one are tilted far: rays start off the ends by their slack.
TEST(Shaft, OfALargeLightCloseToASmallPatchHoldsItsRays) {
  Random random(5);
  int blocked = 0;
  const auto square = [](float half, float z, float up) {
    PlacedFacet facet;
    facet.origin = {-half, -half, z};
    facet.edge_u = {2 * half, 0, 0};
    facet.edge_v = {0, 2 * half, 0};
    facet.normal = {0, 0, up};
    facet.corners = {facet.origin, {half, -half, z}, {half, half, z}, {-half, half, z}};
    return facet;
  };
  const PlacedFacet patch = square(0.05f, 0, 1), light = square(5, 0.1f, -1);
  const float slack = 1e-3f;
  const Shaft shaft({patch.corners, 4, patch.normal, slack}, {light.corners, 4, light.normal, slack});
  for (int k = 0; k < 20000; ++k) {
    const Occluder facet(random.facet(0.2f, 0.05f), false);
    const Vec3 a = random.point_of(patch) + slack * patch.normal,
               b = random.point_of(light) + slack * light.normal;
    if (lanes_crossed(facet, {a, b - a, 0.0f, 1.0f}) == 0) continue;
    ++blocked;
    FacetLanes lanes;
    lanes.set(0, facet.corners, facet.normal);
    ASSERT_EQ(shaft.may_meet(lanes), 1u);
  }
  EXPECT_GT(blocked, 50);
}

TEST(Shaft, OfAPointHoldsTheRaysToIt) {
  Random random(2);
  int blocked = 0;
  for (int scene = 0; scene < 1000; ++scene) {
    const PlacedFacet from = random.facet(2, 0.5f), other = random.facet(2, 1.5f);
    const Vec3 point = random.point(2);
    const Shaft shaft(end_of(from), {{point}, 1, {}, 0});
    const Occluder facet(other, false);
    FacetLanes lanes;
    lanes.set(0, facet.corners, facet.normal);
    for (int k = 0; k < 50; ++k) {
      const Vec3 at = random.point_of(from) + 1e-5f * from.normal;
      if (dot(from.normal, point - at) <= 0 || lanes_crossed(facet, {at, point - at, 0.0f, 1.0f}) == 0)
        continue;
      ++blocked;
      ASSERT_EQ(shaft.may_meet(lanes), 1u) << scene;
    }
  }
  EXPECT_GT(blocked, 300);
}

TEST(BoxTree, FindsEveryBoxThatIsMetOnce) {
  Random random(3);
  std::vector<Box> boxes;
  for (int k = 0; k < 500; ++k) {
    const Vec3 a = random.point(3), b = a + random.point(0.3f);
    boxes.push_back({min(a, b), max(a, b)});
  }
  for (const std::uint32_t per_leaf : {1u, 16u}) {
    const BoxTree tree(boxes, per_leaf);
    std::size_t leaves = 0;
    for (const BoxTree::Leaf& leaf : tree.leaves()) {
      EXPECT_EQ(leaf.number, leaves++);
      EXPECT_LE(leaf.end - leaf.first, per_leaf);
    }
    const auto left = [](const Box& box) { return box.lower.x < 0; };
    std::vector<int> met(boxes.size());
    tree.each_leaf(left, [&](const BoxTree::Leaf& leaf) {
      for (std::uint32_t k = leaf.first; k < leaf.end; ++k) ++met[tree.order()[k]];
      return true;
    });
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      EXPECT_LE(met[k], 1);
      if (left(boxes[k]) || per_leaf == 1) {
        EXPECT_EQ(met[k], left(boxes[k]) ? 1 : 0) << k;
      }
    }
  }
}

}  // namespace
}  // namespace engine
