#include "engine/lines/local_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/statistics.h"
#include "tests/unit/engine/moving_room.h"
#include "tests/unit/engine/one_frame.h"

namespace engine {
namespace {

using tests::exchanges_in;
using tests::MovingRoom;
using tests::Vec3;
using tests::World;

constexpr FrameIndex kFrames = 10;

TracedLines trace(const World& world, const LineOptions& options) {
  auto traced =
      trace_lines(world.patches, world.animation, world.static_rays, world.all_frames(), options, Progress{});
  EXPECT_TRUE(traced);
  return std::move(*traced);
}

std::uint32_t object_of(const World& world, PatchId patch) {
  return world.patches.facets[world.patches.facet_of[patch]].object;
}

bool is_there(const World& room, PatchId patch, FrameIndex slot) {
  return object_of(room, patch) != 2 || slot == 2 || slot == 3 || slot == 7;
}

TEST(LocalRays, GiveEveryPatchThatIsThereTheCrossingsAskedForInEverySlot) {
  const MovingRoom room(kFrames, 0.5, true);
  const TracedLines lines = trace(room, {0, 1, 3, 11});
  EXPECT_EQ(lines.counts.lines, 0u);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex slot = 0; slot < kFrames; ++slot) {
      const std::uint32_t asked = object_of(room, patch) == 0 ? 3 : 11;
      ASSERT_EQ(lines.crossings.at(patch, slot), is_there(room, patch, slot) ? asked : 0u)
          << patch << " " << slot;
    }
}

TEST(LocalRays, AddOnlyWhatIsMissing) {
  const MovingRoom room(kFrames);
  const TracedLines global = trace(room, {2'000, 1, 0, 0}), both = trace(room, {2'000, 1, 4, 20});
  EXPECT_EQ(global.counts.local_lines, 0u);
  int had_enough = 0;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (FrameIndex slot = 0; slot < kFrames; ++slot) {
      const std::uint32_t asked = object_of(room, patch) == 0 ? 4 : 20;
      const std::uint32_t had = global.crossings.at(patch, slot);
      ASSERT_EQ(both.crossings.at(patch, slot), is_there(room, patch, slot) ? std::max(had, asked) : 0u);
      had_enough += had >= asked ? 1 : 0;
    }
  EXPECT_GT(had_enough, 1000);
  EXPECT_GT(both.counts.local_lines, 100u);
}

// In a closed scene of closed things every crossing sees another front, those of local rays too; things move
// past patches at rest meanwhile.
TEST(LocalRays, EveryCrossingOfAClosedSceneSeesSomethingInEverySlot) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, {500, 1, 30, 30});
  for (FrameIndex slot = 0; slot < kFrames; ++slot) {
    std::vector<int> seen(room.patches.count(), 0);
    for (const auto& [pair, count] : exchanges_in(lines, room.patches.count(), slot)) {
      ASSERT_GT(count, 0);
      seen[pair.first] += count;
    }
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(seen[patch], static_cast<int>(lines.crossings.at(patch, slot))) << patch << " " << slot;
  }
}

// Upright and inverted cells alike: a point beside its cell would be counted for another.
TEST(LocalRays, StartInsideTheCellsOfTriangles) {
  Scene scene = tests::scene_with(2, 1, true);
  tests::add_polygon(scene, {{0, 0, 0}, {3, 0.5f, 0}, {1, 2.5f, 0.3f}});
  tests::add_polygon(scene, {{0, 0, 1}, {3, 0.5f, 1}, {1, 2.5f, 1.3f}}, 1);
  Animation animation = tests::still(scene, 2);
  animation.objects[1].spans = {{0, 0, {}}, {1, 1, tests::moved_to(0.1, 0.2, 0.7)}};
  const World world(scene, animation, 0.8);
  ASSERT_GT(world.patches.count(), 60u);
  const TracedLines lines = trace(world, {0, 1, 16, 16});
  for (PatchId patch = 0; patch < world.patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < 2; ++slot) ASSERT_EQ(lines.crossings.at(patch, slot), 16u) << patch;
}

/// Of two parallel unit squares at a distance of c. Source: Howell's catalogue, C-11, with X = Y = 1 / c.
double between_squares(double c) {
  const double x = 1 / c, y = 1 + x * x;
  return 2 / (std::numbers::pi * x * x) *
         (0.5 * std::log(y * y / (1 + 2 * x * x)) + 2 * x * std::sqrt(y) * std::atan(x / std::sqrt(y)) -
          2 * x * std::atan(x));
}

/// A unit square on the floor looking up (patch 0), one at height 3 looking down (patch 1), and between them
/// a unit sheet (object 1; patch 2, with two sides patch 3) whose front looks down; a screen (object 2)
/// stands 1 m above the floor in slot 3 alone.
Scene sheet_between_squares(bool both_sides) {
  Scene scene = tests::scene_with(3, 1, both_sides);
  scene.materials.push_back({"one side", {0.5f, 0.5f, 0.5f}, {}, false});
  scene.materials.push_back({"screen", {0.5f, 0.5f, 0.5f}, {}, true});
  tests::add_polygon(scene, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 0, 1);
  tests::add_polygon(scene, {{0, 0, 3}, {0, 1, 3}, {1, 1, 3}, {1, 0, 3}}, 0, 1);
  tests::add_polygon(scene, {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}, 1, 0);
  tests::add_polygon(scene, {{-9, -9, 1}, {9, -9, 1}, {9, 9, 1}, {-9, 9, 1}}, 2, 2);
  return scene;
}

/// Heights of the sheet: .5, 1, 2, 2, (gone), 1.5 and there mirrored, 1 and there turned by a right angle.
Animation sheet_moves(const Scene& scene) {
  Animation animation = tests::still(scene, 7);
  Pose mirrored = tests::moved_to(1, 0, 1.5), turned = tests::moved_to(1, 0, 1);
  mirrored.m[0][0] = -1;
  turned.m[0] = {0, -1, 0, 1};
  turned.m[1] = {1, 0, 0, 0};
  animation.objects[1].spans = {{0, 0, tests::moved_to(0, 0, 0.5)},
                                {1, 1, tests::moved_to(0, 0, 1)},
                                {2, 3, tests::moved_to(0, 0, 2)},
                                {5, 5, mirrored},
                                {6, 6, turned}};
  animation.objects[2].spans = {{3, 3, {}}};
  return animation;
}

/// Share of the crossings of `receiver` that see `sender`.
double share(const TracedLines& lines, PatchId receiver, PatchId sender, std::uint32_t slot) {
  int count = 0;
  for (const Exchange& e : lines.static_rows.row(receiver))
    if (e.sender() == sender) count += static_cast<int>(e.count());
  for (const SlotExchange& e : lines.moving_rows.row(receiver))
    if (e.sender == sender && e.first_slot <= slot && slot <= e.last_slot) count += e.weight;
  return double(count) / lines.crossings.at(receiver, slot);
}

constexpr std::uint64_t kSeeds = 64;
constexpr double kHeight[] = {0.5, 1, 2, 2, 0, 1.5, 1};

/// Mean share over seeds against the form factor; of all tests of a scene together one in 10^4 refuses.
void expect_form_factors(bool both_sides, std::uint64_t line_count) {
  const Scene scene = sheet_between_squares(both_sides);
  const World world(scene, sheet_moves(scene), 2);
  std::vector<tests::Sample> floor(7), ceiling(7);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TracedLines lines = trace(world, {line_count, seed, 64, 64});
    for (const std::uint32_t slot : {0u, 1u, 2u, 3u, 5u, 6u}) {
      floor[slot].add(share(lines, 2, 0, slot));
      if (both_sides) ceiling[slot].add(share(lines, 3, 1, slot));
      ASSERT_EQ(share(lines, 2, 1, slot), 0) << "the front sees what is behind it";
    }
    ASSERT_EQ(lines.crossings.at(2, 4), 0u);
  }
  for (const std::uint32_t slot : {0u, 1u, 2u, 5u, 6u}) {
    EXPECT_TRUE(tests::agrees(floor[slot], between_squares(kHeight[slot]), 1e-5)) << slot;
    if (both_sides) {
      EXPECT_TRUE(tests::agrees(ceiling[slot], between_squares(3 - kHeight[slot]), 1e-5)) << slot;
    }
  }
  EXPECT_EQ(floor[3].mean(), 0) << "through the screen";
}

TEST(LocalRays, OfASheetThatMovesHaveTheFormFactorsOfEverySlot) {
  expect_form_factors(false, 0);
}

TEST(LocalRays, OfBothSidesHaveTheFormFactorsOfEither) {
  expect_form_factors(true, 0);
}

// The box has a surface of 700 m^2, so of 2,000 lines about 6 meet the sheet in each slot; the rest is local.
TEST(LocalRays, BesideGlobalLinesLeaveRowsUnbiased) {
  expect_form_factors(true, 2'000);
}

// What rests sees the sheet in the slots in which it is there: the other way the same form factor.
TEST(LocalRays, OfAPatchAtRestSeeWhatMovesPastInEverySlot) {
  const Scene scene = sheet_between_squares(false);
  const World world(scene, sheet_moves(scene), 2);
  std::vector<tests::Sample> sheet(7);
  tests::Sample ceiling;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TracedLines lines = trace(world, {0, seed, 64, 1});
    for (std::uint32_t slot = 0; slot < 7; ++slot) {
      sheet[slot].add(share(lines, 0, 2, slot));
      ASSERT_EQ(share(lines, 1, 2, slot), 0) << "the back of a one-sided sheet sends nothing";
    }
    ceiling.add(share(lines, 0, 1, 4));
  }
  for (const std::uint32_t slot : {0u, 1u, 2u, 5u, 6u})
    EXPECT_TRUE(tests::agrees(sheet[slot], between_squares(kHeight[slot]), 1e-5)) << slot;
  EXPECT_EQ(sheet[3].mean(), 0) << "through the screen";
  EXPECT_EQ(sheet[4].mean(), 0) << "it is gone";
  EXPECT_TRUE(tests::agrees(ceiling, between_squares(3), 1e-5));
}

// Opposite and adjacent faces of a cube, one patch each: the catalogue's values.
TEST(LocalRays, OfACubeHaveItsFormFactors) {
  Scene scene = tests::scene_with(1, 1);
  tests::add_box(scene, {0, 0, 0}, {1, 1, 1}, true);
  const World world(scene, tests::still(scene, 1), 2);
  std::vector<tests::Sample> of_pair(36);
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const TracedLines lines = trace(world, {0, seed, 128, 1});
    for (PatchId a = 0; a < 6; ++a)
      for (PatchId b = 0; b < 6; ++b) of_pair[6 * a + b].add(share(lines, a, b, 0));
  }
  for (PatchId a = 0; a < 6; ++a)
    for (PatchId b = 0; b < 6; ++b) {
      const bool opposite = a / 2 == b / 2;  // add_box lists them in pairs
      const double exact = a == b ? 0 : opposite ? 0.19982489569838746 : 0.20004377607540316;
      EXPECT_TRUE(tests::agrees(of_pair[6 * a + b], exact, 3e-6)) << a << " " << b;
    }
}

// The noise of what moves does not flicker: the points of the rays stay where they are on the patch.
TEST(LocalRays, OfASheetThatTravelsAlongARowOfWallsAreTheSameRays) {
  Scene scene = tests::scene_with(2, 1);
  tests::add_polygon(scene, {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}});
  tests::add_polygon(scene, {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}}, 1);
  Animation animation = tests::still(scene, 3);
  animation.objects[1].spans = {
      {0, 0, {}}, {1, 1, tests::moved_to(8, 0, 0)}, {2, 2, tests::moved_to(0, -16, 0)}};
  const World world(scene, animation, 1);  // cells of 1 m: a move by whole metres is one by whole cells
  const TracedLines lines = trace(world, {0, 1, 0, 200});
  const PatchId sheet = world.patches.count() - 1;
  std::vector<std::vector<std::pair<int, int>>> seen(3);  // cells, relative to the sheet
  const int offset[3][2] = {{0, 0}, {8, 0}, {0, -16}};
  for (std::uint32_t slot = 0; slot < 3; ++slot) {
    for (const SlotExchange& e : lines.moving_rows.row(sheet)) {
      if (slot < e.first_slot || e.last_slot < slot) continue;
      const Vec3 at = tests::centre_of(world.patches, e.sender);
      for (int k = 0; k < e.weight; ++k)
        seen[slot].emplace_back(static_cast<int>(std::floor(at.x)) - offset[slot][0],
                                static_cast<int>(std::floor(at.y)) - offset[slot][1]);
    }
    std::sort(seen[slot].begin(), seen[slot].end());
  }
  std::vector<std::pair<int, int>> common;
  for (std::uint32_t slot = 1; slot < 3; ++slot) {
    common.clear();
    std::set_intersection(seen[0].begin(), seen[0].end(), seen[slot].begin(), seen[slot].end(),
                          std::back_inserter(common));
    EXPECT_GE(common.size(), 195u);  // but for what leaves the floor or is rounded into a neighbour
  }
}

TEST(LocalRays, StopWhenToldTo) {
  const MovingRoom room(2);
  Progress progress;
  progress.stop_requested = [] { return true; };
  const auto frames = room.all_frames();
  const auto lines =
      trace_lines(room.patches, room.animation, room.static_rays, frames, {0, 1, 4, 4}, progress);
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().fault, api::Fault::stopped);
}

}  // namespace
}  // namespace engine
