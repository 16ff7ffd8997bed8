#include "engine/lines/trace_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "engine/base/parallel.h"
#include "engine/lines/visibility_list.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::MovingRoom;
using tests::World;

constexpr FrameIndex kFrames = 10;
using PairCounts =
    std::map<std::pair<PatchId, PatchId>, int>;  ///< (receiver, sender) -> lines, without zeros

/// Global lines only.
TracedLines trace(const World& world, const std::vector<FrameIndex>& frames, std::uint64_t lines,
                  std::uint64_t seed = 1) {
  auto traced =
      trace_lines(world.patches, world.animation, world.static_rays, frames, {lines, seed, 0, 0}, Progress{});
  EXPECT_TRUE(traced);
  return std::move(*traced);
}

PairCounts exchanges_in(const TracedLines& lines, std::uint32_t patch_count, std::uint32_t slot) {
  PairCounts counts;
  for (PatchId patch = 0; patch < patch_count; ++patch) {
    for (const Exchange& e : lines.static_rows.row(patch))
      counts[{patch, e.sender()}] += static_cast<int>(e.count());
    for (const SlotExchange& e : lines.moving_rows.row(patch))
      if (e.first_slot <= slot && slot <= e.last_slot) counts[{patch, e.sender}] += e.weight;
  }
  std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
  return counts;
}

template <class Entry>
bool same_entries(const Rows<Entry>& a, const Rows<Entry>& b, std::uint32_t rows) {
  for (PatchId row = 0; row < rows; ++row) {
    const auto in_a = a.row(row), in_b = b.row(row);
    if (!std::equal(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                    [](const Entry& x, const Entry& y) { return !(x < y) && !(y < x); }))
      return false;
  }
  return true;
}

void expect_same(const TracedLines& a, const TracedLines& b, std::uint32_t patch_count) {
  EXPECT_TRUE(same_entries(a.static_rows, b.static_rows, patch_count));
  EXPECT_TRUE(same_entries(a.moving_rows, b.moving_rows, patch_count));
  EXPECT_EQ(a.crossings.static_count, b.crossings.static_count);
  EXPECT_EQ(a.crossings.moving_count, b.crossings.moving_count);
  EXPECT_EQ(a.counts.static_hits, b.counts.static_hits);
  EXPECT_EQ(a.counts.moving_hits, b.counts.moving_hits);
  EXPECT_EQ(a.counts.touched_lines, b.counts.touched_lines);
}

TEST(TraceLines, EveryPairIsCountedAlikeInBothDirectionsInEverySlot) {
  for (const bool both_sides : {false, true}) {
    const MovingRoom room(kFrames, 0.5, both_sides);
    const TracedLines lines = trace(room, room.all_frames(), 20'000);
    EXPECT_GT(lines.moving_rows.entry_count(), 1000u);
    for (FrameIndex slot = 0; slot < kFrames; ++slot) {
      const PairCounts all = exchanges_in(lines, room.patches.count(), slot);
      PairCounts mirrored;
      for (const auto& [pair, count] : all) mirrored[{pair.second, pair.first}] = count;
      ASSERT_EQ(all, mirrored) << "slot " << slot;
    }
  }
}

// In a closed scene of closed things every crossing of a front sees another front.
TEST(TraceLines, EveryCrossingOfAClosedSceneSeesSomethingInEverySlot) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, room.all_frames(), 40'000);
  for (FrameIndex slot = 0; slot < kFrames; ++slot) {
    std::vector<std::uint32_t> seen(room.patches.count(), 0);
    for (const auto& [pair, count] : exchanges_in(lines, room.patches.count(), slot))
      seen[pair.first] += static_cast<std::uint32_t>(count);
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(seen[patch], lines.crossings.at(patch, slot)) << "patch " << patch << " slot " << slot;
  }
}

/// The same lines, frame by frame and hit by hit, with everything at rest.
PairCounts by_force(const World& world, FrameIndex frame, std::uint64_t line_count, std::uint64_t seed) {
  Animation rest = tests::still(world.scene, 1);
  for (std::size_t object = 0; object < rest.objects.size(); ++object) {
    rest.objects[object].spans.clear();
    for (const PoseSpan& span : world.animation.objects[object].spans)
      if (span.first <= frame && frame <= span.last) rest.objects[object].spans.push_back({0, 0, span.pose});
  }
  const StaticRays rays(world.patches, rest);
  const LineBox box = line_box(world.patches, world.animation);
  PairCounts counts;
  std::vector<SurfaceHit> hits;
  for (std::uint32_t line = 0; line < line_count; ++line) {
    rays.all_hits(global_line(box, line, seed), hits);
    for (std::size_t k = 1; k < hits.size(); ++k) {
      const PatchId a = crossing_of(world.patches, hits[k - 1]).facing_forward;
      const PatchId b = crossing_of(world.patches, hits[k]).facing_back;
      if (a == kNoPatch || b == kNoPatch) continue;
      ++counts[{a, b}];
      ++counts[{b, a}];
    }
  }
  return counts;
}

TEST(TraceLines, EveryFrameOfAWindowIsTheFrameTracedAlone) {
  const MovingRoom room(kFrames);
  constexpr std::uint64_t kLines = 10'000;
  const TracedLines lines = trace(room, room.all_frames(), kLines, 9);
  for (FrameIndex frame = 0; frame < kFrames; ++frame)
    ASSERT_EQ(exchanges_in(lines, room.patches.count(), frame), by_force(room, frame, kLines, 9)) << frame;
}

TEST(TraceLines, AWindowOf128FramesReachesItsLastSlot) {
  const MovingRoom room(128);
  const TracedLines lines = trace(room, room.all_frames(), 2'000);
  for (const FrameIndex frame : {0u, 63u, 64u, 127u})
    ASSERT_EQ(exchanges_in(lines, room.patches.count(), frame), by_force(room, frame, 2'000, 1)) << frame;
}

TEST(TraceLines, FramesChosenFromTheAnimationAreTheSameFrames) {
  const MovingRoom room(kFrames);
  const std::vector<FrameIndex> chosen{1, 3, 7, 9};
  const TracedLines lines = trace(room, chosen, 10'000);
  const TracedLines all = trace(room, room.all_frames(), 10'000);
  for (std::uint32_t slot = 0; slot < chosen.size(); ++slot) {
    ASSERT_EQ(exchanges_in(lines, room.patches.count(), slot),
              exchanges_in(all, room.patches.count(), chosen[slot]));
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(lines.crossings.at(patch, slot), all.crossings.at(patch, chosen[slot]));
  }
}

TEST(TraceLines, OneThreadAndSeveralGiveTheSame) {
  const MovingRoom room(kFrames);
  set_thread_count(1);
  const TracedLines one = trace(room, room.all_frames(), 30'000);
  set_thread_count(2);
  const TracedLines two = trace(room, room.all_frames(), 30'000);
  set_thread_count(0);
  expect_same(one, two, room.patches.count());
}

TEST(TraceLines, AnotherSeedGivesOtherLines) {
  const MovingRoom room(kFrames);
  const TracedLines a = trace(room, room.all_frames(), 5'000, 1),
                    b = trace(room, room.all_frames(), 5'000, 2);
  EXPECT_FALSE(same_entries(a.static_rows, b.static_rows, room.patches.count()));
}

TEST(TraceLines, CountsLinesAndHits) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, room.all_frames(), 10'001);
  EXPECT_EQ(lines.slot_count, kFrames);
  EXPECT_EQ(lines.counts.lines, 10'001u);
  // Lines are drawn on a box a little larger than the room: nearly all of them meet the room twice.
  EXPECT_GT(lines.counts.static_hits, 2 * 9'900u);
  EXPECT_GT(lines.counts.touched_lines, 100u);
  EXPECT_GT(lines.counts.moving_hits, 2 * lines.counts.touched_lines);
  EXPECT_LT(lines.counts.touched_lines, 10'001u);
}

TEST(TraceLines, TheSlotsInWhichAnObjectIsThereAreMarkedAndElsewhereNoLineMeetsIt) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, room.all_frames(), 20'000);
  for (FrameIndex slot = 0; slot < kFrames; ++slot) {
    EXPECT_TRUE(lines.crossings.present[0].test(slot));
    EXPECT_TRUE(lines.crossings.present[1].test(slot));
    const bool there = slot == 2 || slot == 3 || slot == 7;
    EXPECT_EQ(lines.crossings.present[2].test(slot), there) << slot;
    for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
      if (room.patches.facets[room.patches.facet_of[patch]].object != 2) continue;
      ASSERT_EQ(lines.crossings.at(patch, slot) > 0, there) << "patch " << patch << " slot " << slot;
    }
  }
}

TEST(TraceLines, StopsWhenToldTo) {
  const MovingRoom room(kFrames);
  std::atomic<int> asked = 0;
  Progress progress;
  progress.stop_requested = [&] { return ++asked > 3; };
  const auto frames = room.all_frames();
  const auto lines =
      trace_lines(room.patches, room.animation, room.static_rays, frames, {10'000'000, 1}, progress);
  ASSERT_FALSE(lines);
  EXPECT_EQ(lines.error().fault, api::Fault::stopped);
  EXPECT_LT(asked, 100);
}

TEST(TraceLines, ReportsProgressUpToOne) {
  const MovingRoom room(2);
  std::atomic<int> reports = 0;
  std::atomic<bool> done = false, outside = false;
  Progress progress;
  progress.report = [&](double fraction) {
    ++reports;
    if (fraction == 1.0) done = true;
    if (fraction < 0 || fraction > 1) outside = true;
  };
  const auto frames = room.all_frames();
  ASSERT_TRUE(trace_lines(room.patches, room.animation, room.static_rays, frames, {20'000, 1}, progress));
  EXPECT_GE(reports, 4);
  EXPECT_TRUE(done);
  EXPECT_FALSE(outside);
}

}  // namespace
}  // namespace engine
