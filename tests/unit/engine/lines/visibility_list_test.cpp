// Figure 2 of Besuievsky & Pueyo: static pairs plus the changes of a slot are the pairs of that slot.
#include "engine/lines/visibility_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "tests/unit/engine/scenes.h"

namespace engine {
namespace {

using PairCounts = std::map<std::pair<PatchId, PatchId>, int>;  ///< without zeros

void add(PairCounts& counts, SeenPair pair, int sign) {
  int& count = counts[{pair.a, pair.b}];
  count += sign;
  if (count == 0) counts.erase({pair.a, pair.b});
}

/// What the lists say of a slot.
PairCounts by_changes(const std::vector<SeenPair>& pairs, const std::vector<PairChange>& changes,
                      std::uint32_t slot) {
  PairCounts counts;
  for (const SeenPair& pair : pairs) add(counts, pair, 1);
  for (const PairChange& change : changes)
    if (change.first_slot <= slot && slot <= change.last_slot) add(counts, change.pair, change.sign);
  return counts;
}

/// All surfaces of a slot sorted into one list, and its neighbours read off. Among equals static ones are
/// first.
PairCounts by_force(const std::vector<Crossing>& line, const std::vector<MovingCrossing>& moving,
                    std::uint32_t slot) {
  std::vector<Crossing> all = line;
  for (const MovingCrossing& crossing : moving)
    if (crossing.first_slot <= slot && slot <= crossing.last_slot) all.push_back(crossing);
  std::stable_sort(all.begin(), all.end(),
                   [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
  PairCounts counts;
  for (std::size_t k = 1; k < all.size(); ++k)
    if (all[k - 1].facing_forward != kNoPatch && all[k].facing_back != kNoPatch)
      add(counts, {all[k - 1].facing_forward, all[k].facing_back}, 1);
  return counts;
}

/// Lines with surfaces of every kind: one-sided ones that face either way, two-sided ones, equal distances.
class RandomLine {
 public:
  explicit RandomLine(unsigned seed) : random_(seed) {}

  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(random_() % n); }

  std::vector<Crossing> statics(std::uint32_t count) {
    std::vector<Crossing> line(count);
    for (Crossing& crossing : line) crossing = surface(0);
    std::sort(line.begin(), line.end(), nearer);
    return line;
  }

  /// Surfaces of `objects` objects, each of which holds poses in some ranges of `slots` slots.
  std::vector<MovingCrossing> moving(std::uint32_t objects, std::uint32_t slots) {
    std::vector<MovingCrossing> found;
    for (std::uint32_t object = 0; object < objects; ++object)
      for (std::uint32_t slot = below(5); slot < slots;) {
        const std::uint32_t last = std::min(slot + below(1 + slots / 2), slots - 1);
        for (std::uint32_t surfaces = below(4); surfaces > 0; --surfaces) {
          MovingCrossing crossing;
          static_cast<Crossing&>(crossing) = surface(100 * (object + 1));
          crossing.first_slot = slot;
          crossing.last_slot = last;
          found.push_back(crossing);
        }
        slot = last + 1 + below(3);
      }
    std::stable_sort(found.begin(), found.end(), nearer);
    return found;
  }

 private:
  static bool nearer(const Crossing& a, const Crossing& b) { return a.distance < b.distance; }

  Crossing surface(PatchId base) {
    const PatchId front = base + 2 * below(20);
    const std::uint32_t kind = below(3);
    const auto distance = static_cast<float>(below(40));  // few values: ties happen
    return {distance, kind == 1 ? kNoPatch : front, kind == 0 ? kNoPatch : front + 1};
  }

  std::mt19937 random_;
};

void expect_slots_agree(const std::vector<Crossing>& line, const std::vector<MovingCrossing>& moving,
                        std::uint32_t slots) {
  std::vector<SeenPair> pairs;
  std::vector<PairChange> changes;
  list_static_pairs(line, pairs);
  list_changes(line, moving, changes);
  for (std::uint32_t slot = 0; slot < slots; ++slot)
    ASSERT_EQ(by_changes(pairs, changes, slot), by_force(line, moving, slot)) << "slot " << slot;
}

TEST(VisibilityList, StaticPairsAndChangesAreThePairsOfEverySlot) {
  RandomLine random(1);
  for (int k = 0; k < 20'000; ++k) {
    const std::uint32_t slots = 1 + random.below(k % 10 == 0 ? 128 : 12);
    const auto line = random.statics(random.below(8));
    expect_slots_agree(line, random.moving(random.below(4), slots), slots);
    if (HasFatalFailure()) FAIL() << "case " << k;
  }
}

TEST(VisibilityList, MovingSurfacesBeforeBetweenAndBehindTheStaticOnes) {
  const std::vector<Crossing> line{{2, 1, 2}, {4, 3, 4}};
  for (const float at : {1.0f, 3.0f, 5.0f}) {
    MovingCrossing only;
    static_cast<Crossing&>(only) = {at, 10, 11};
    only.first_slot = 1;
    only.last_slot = 2;
    expect_slots_agree(line, {only}, 4);
    expect_slots_agree({}, {only}, 4);
  }
}

TEST(VisibilityList, AFrameWithoutMovingSurfacesInheritsTheStaticList) {
  RandomLine random(2);
  std::vector<PairChange> changes;
  list_changes(random.statics(10), {}, changes);
  EXPECT_TRUE(changes.empty());
}

TEST(VisibilityList, OnlyTheSegmentsThatAMovingSurfaceCutsAreReplaced) {
  std::vector<Crossing> line;
  for (PatchId k = 0; k < 100; ++k) line.push_back({static_cast<float>(k), 2 * k, 2 * k + 1});
  MovingCrossing cut;
  static_cast<Crossing&>(cut) = {49.5f, 1000, 1001};
  cut.first_slot = 3;
  cut.last_slot = 90;
  std::vector<PairChange> changes;
  list_changes(line, std::vector{cut}, changes);
  ASSERT_EQ(changes.size(), 3u);  // one pair gone, two new ones, for all slots at once
  for (const PairChange& change : changes) {
    EXPECT_EQ(change.first_slot, 3);
    EXPECT_EQ(change.last_slot, 90);
  }
}

// A thing that goes past: the pair behind it is cut once for all slots in which it stands between.
TEST(VisibilityList, WhatGoesOnInTheNextSlotIsOneChange) {
  const std::vector<Crossing> line{{1, kNoPatch, 2}, {5, 3, kNoPatch}};
  std::vector<MovingCrossing> moving;
  for (std::uint32_t slot = 10; slot < 14; ++slot) {
    MovingCrossing crossing;
    static_cast<Crossing&>(crossing) = {2 + 0.1f * static_cast<float>(slot), 20 + slot, kNoPatch};
    crossing.first_slot = crossing.last_slot = slot;
    moving.push_back(crossing);
  }
  std::vector<PairChange> changes;
  list_changes(line, moving, changes);
  ASSERT_EQ(changes.size(), 5u);  // the pair gone, and four patches that are seen for a slot each
  EXPECT_EQ(changes[0].sign, -1);
  EXPECT_EQ(changes[0].first_slot, 10);
  EXPECT_EQ(changes[0].last_slot, 13);
  expect_slots_agree(line, moving, 16);
}

TEST(VisibilityList, ListsAreAppendedTo) {
  const std::vector<Crossing> line{{1, kNoPatch, 2}, {2, 3, kNoPatch}};
  std::vector<SeenPair> pairs{{8, 9}};
  list_static_pairs(line, pairs);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[1].a, 2u);
  EXPECT_EQ(pairs[1].b, 3u);
}

TEST(VisibilityList, OneSidedSurfacesAreSeenFromTheirFrontsOnly) {
  const std::vector<Crossing> away{{1, 5, kNoPatch}, {2, 6, kNoPatch}};
  std::vector<SeenPair> pairs;
  list_static_pairs(away, pairs);
  EXPECT_TRUE(pairs.empty());
}

TEST(CrossingOf, ShowsTheFrontToWhereTheRayComesFromAndTheBackBehind) {
  for (const bool both : {false, true}) {
    Scene scene = tests::scene_with(1, 1, both);
    tests::add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}});
    const auto patches = *mesh_into_patches(scene, 1.0);
    const PatchId back = both ? 3 : kNoPatch;
    const Crossing in = crossing_of(patches, {7, 0, 0.8f, 0.5f, true});
    EXPECT_EQ(in.distance, 7);
    EXPECT_EQ(in.facing_back, 1u);
    EXPECT_EQ(in.facing_forward, back);
    const Crossing out = crossing_of(patches, {7, 0, 0.8f, 0.5f, false});
    EXPECT_EQ(out.facing_back, back);
    EXPECT_EQ(out.facing_forward, 1u);
  }
}

}  // namespace
}  // namespace engine
