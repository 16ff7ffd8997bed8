// Packets of lines meet what single rays meet.
#include "engine/visibility/line_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::add_polygon;
using tests::MovingRoom;
using tests::World;

LineScene at_rest(const World& world) {
  return LineScene::at_rest(world.patches, world.animation);
}

/// The crossings of each ray, traced in packets of sixteen.
std::vector<std::vector<MovingCrossing>> crossings_of(const LineScene& scene, const std::vector<Ray>& rays) {
  std::vector<std::vector<MovingCrossing>> all;
  LineScene::Buffers buffers;
  PacketCrossings found;
  for (std::size_t first = 0; first < rays.size(); first += kLanes) {
    LinePacket packet;
    for (std::size_t k = first; k < std::min(first + kLanes, rays.size()); ++k) packet.push(rays[k]);
    scene.all_hits(packet, buffers, found);
    for (std::uint32_t lane = 0; lane < packet.count; ++lane)
      all.emplace_back(found.of(lane).begin(), found.of(lane).end());
    for (std::uint32_t lane = packet.count; lane < kLanes; ++lane) EXPECT_TRUE(found.of(lane).empty());
  }
  return all;
}

std::vector<Ray> random_rays(int count, float size, unsigned seed) {
  tests::RandomRays random(size, seed);
  std::vector<Ray> rays;
  for (int k = 0; k < count; ++k) rays.push_back(random.next());
  return rays;
}

/// Few enough that all are tested, and so many that there is a tree.
Scene polygons_anywhere(int count) {
  Scene scene = tests::scene_with(1, 1, true);
  tests::RandomRays random(1, 2);
  for (int k = 0; k < count; ++k) {
    const Vec3 a = random.point(), b = a + 0.5f * random.point(), c = a + 0.5f * random.point();
    if (k % 2 == 0)
      add_polygon(scene, {a, b, c});
    else
      add_polygon(scene, {a, b, b + (c - a), c});
  }
  return scene;
}

TEST(LineScene, MeetsWhatSingleRaysMeetAtTheSamePatches) {
  for (const int count : {3, 24, 25, 700}) {
    const World world(polygons_anywhere(count), tests::still(polygons_anywhere(count), 1), 0.1);
    const auto rays = random_rays(10'001, 1.5f, 3);
    const auto found = crossings_of(at_rest(world), rays);
    std::vector<SurfaceHit> hits;
    std::size_t total = 0, elsewhere = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      world.static_rays.all_hits(rays[k], hits);
      ASSERT_EQ(found[k].size(), hits.size()) << count << ' ' << k;
      for (std::size_t h = 0; h < hits.size(); ++h) {
        const Crossing expected = crossing_of(world.patches, hits[h]);
        const Facet& facet = world.patches.facets[hits[h].facet];
        const Vec3 at = rays[k].origin + found[k][h].distance * rays[k].direction;
        ASSERT_LT(std::abs(dot(facet.normal, at - facet.origin)), 1e-6f) << "off its plane";
        elsewhere += found[k][h].facing_back != expected.facing_back ||
                     found[k][h].facing_forward != expected.facing_forward;
        ++total;
      }
    }
    EXPECT_GT(total, 100u);
    EXPECT_LE(elsewhere, 1 + total / 5'000) << count;  // rounded into a neighbour
  }
}

TEST(LineScene, MeetsOnlyWhatIsBetweenNearAndFar) {
  Scene scene = tests::scene_with(1, 1);
  for (int z = 0; z < 40; ++z) {
    const auto h = static_cast<float>(z);
    add_polygon(scene, {{-1, -1, h}, {1, -1, h}, {1, 1, h}, {-1, 1, h}});
  }
  const World world(scene, tests::still(scene, 1), 4);
  const auto found = crossings_of(
      at_rest(world), {{{0.1f, 0.2f, -1}, {0, 0, 1}, 2.5f, 6.5f}, {{0.1f, 0.2f, -1}, {0, 0, 2}, 0, 3.1f}});
  ASSERT_EQ(found[0].size(), 4u);
  EXPECT_EQ(found[0].front().facing_forward, 2u);
  EXPECT_EQ(found[0].front().facing_back, kNoPatch);
  ASSERT_EQ(found[1].size(), 6u);
  EXPECT_FLOAT_EQ(found[1].back().distance, 3);
}

TEST(LineScene, WithoutFacetsNothingIsMet) {
  const MovingRoom room(1);
  const LineScene none = LineScene::moving(room.patches, room.animation, {});
  EXPECT_TRUE(none.empty());
  for (const auto& line : crossings_of(none, random_rays(20, 1, 1))) EXPECT_TRUE(line.empty());
}

TEST(LineScene, WhatMovesIsMetInTheSlotsInWhichSingleRaysMeetIt) {
  const MovingRoom room(100, 0.2, true);
  const LineScene scene = LineScene::moving(room.patches, room.animation, room.all_frames());
  const MovingRays single(room.patches, room.animation, room.all_frames());
  const auto rays = random_rays(3'000, 1.5f, 4);
  const auto found = crossings_of(scene, rays);
  std::vector<MovingHit> hits;
  std::size_t total = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    single.all_hits(rays[k], hits);
    std::vector<std::size_t> expected(100), counts(100);
    for (const MovingHit& hit : hits)
      for (std::uint32_t s = hit.first_slot; s <= hit.last_slot; ++s) ++expected[s];
    for (const MovingCrossing& crossing : found[k])
      for (std::uint32_t s = crossing.first_slot; s <= crossing.last_slot; ++s) ++counts[s];
    ASSERT_EQ(counts, expected) << k;
    total += hits.size();
  }
  EXPECT_GT(total, 3'000u);
}

TEST(LineScene, OfSomeSlotsOnlyTheseAreMet) {
  const MovingRoom room(10);
  const LineScene scene = LineScene::moving(room.patches, room.animation, room.all_frames());
  const auto rays = random_rays(5'000, 1.5f, 5);
  const auto all = crossings_of(scene, rays);
  LineScene::Buffers buffers;
  PacketCrossings found;
  std::size_t total = 0;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    LinePacket packet;
    packet.push(rays[k]);
    scene.all_hits(packet, 3, 7, buffers, found);
    std::vector<MovingCrossing> expected;
    for (MovingCrossing crossing : all[k]) {
      crossing.first_slot = std::max(crossing.first_slot, 3u);
      crossing.last_slot = std::min(crossing.last_slot, 7u);
      if (crossing.first_slot <= crossing.last_slot) expected.push_back(crossing);
    }
    ASSERT_EQ(found.of(0).size(), expected.size());
    for (std::size_t h = 0; h < expected.size(); ++h) {
      EXPECT_EQ(found.of(0)[h].distance, expected[h].distance);
      EXPECT_EQ(found.of(0)[h].facing_back, expected[h].facing_back);
      EXPECT_EQ(found.of(0)[h].first_slot, expected[h].first_slot);
      EXPECT_EQ(found.of(0)[h].last_slot, expected[h].last_slot);
    }
    total += expected.size();
  }
  EXPECT_GT(total, 1'000u);
}

/// A unit box far from the origin, each face cut into n x n squares, or each of those into two triangles.
Scene cut_box(int n, bool triangles) {
  Scene scene = tests::scene_with(1, 1);
  const auto at = [&](int axis, int side, int i, int j) {
    if (side == 0) std::swap(i, j);  // all look outwards
    float p[3];
    p[axis] = side == 0 ? -1.0f : 1.0f;
    p[(axis + 1) % 3] = 2 * static_cast<float>(i) / static_cast<float>(n) - 1;
    p[(axis + 2) % 3] = 2 * static_cast<float>(j) / static_cast<float>(n) - 1;
    return Vec3{37.3f + p[0], -12.1f + p[1], 5.7f + p[2]};
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const Vec3 a = at(axis, side, i, j), b = at(axis, side, i + 1, j), c = at(axis, side, i + 1, j + 1),
                     d = at(axis, side, i, j + 1);
          if (triangles) {
            add_polygon(scene, {a, b, c});
            add_polygon(scene, {a, c, d});
          } else {
            add_polygon(scene, {a, b, c, d});
          }
        }
  return scene;
}

// Aimed at points of edges, to within rounding, from inside: each line leaves the box once, whichever of the
// facets at the edge it meets. Points nearer a corner than a thousandth are left out: many edges meet there.
TEST(LineScene, NoLineSlipsThroughAnEdgeNorMeetsBothOfItsFacets) {
  for (const bool triangles : {false, true}) {
    constexpr int kCut = 7;
    const Scene scene = cut_box(kCut, triangles);
    const World world(scene, tests::still(scene, 1), 10);
    tests::RandomRays random(0.3f, 6);
    std::mt19937 choose(7);
    std::uniform_real_distribution<float> along(0.001f, 0.999f);
    std::vector<Ray> rays;
    for (int k = 0; k < 100'000; ++k) {
      const Polygon& polygon = scene.polygons[choose() % scene.polygons.size()];
      const auto corner = static_cast<std::uint32_t>(choose() % polygon.corner_count);
      const auto vertex = [&](std::uint32_t c) {
        return scene.vertices[scene.corners[polygon.first_corner + c % polygon.corner_count]];
      };
      const Vec3 target = vertex(corner) + along(choose) * (vertex(corner + 1) - vertex(corner));
      const Vec3 from = Vec3{37.3f, -12.1f, 5.7f} + random.point();
      rays.push_back({from, target - from});
    }
    int wrong = 0;
    for (const auto& line : crossings_of(at_rest(world), rays)) wrong += line.size() == 1 ? 0 : 1;
    EXPECT_EQ(wrong, 0) << triangles;
  }
}

}  // namespace
}  // namespace engine
