#include "engine/lines/trace_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/base/parallel.h"
#include "tests/unit/engine/moving_room.h"
#include "tests/unit/engine/one_frame.h"

namespace engine {
namespace {

using tests::MovingRoom;
using tests::World;

constexpr FrameIndex kFrames = 10;
using tests::exchanges_in;
using tests::PairCounts;

/// Global lines only.
TracedLines trace(const World& world, const std::vector<FrameIndex>& frames, std::uint64_t lines,
                  std::uint64_t seed = 1) {
  auto traced =
      trace_lines(world.patches, world.animation, world.static_rays, frames, {lines, seed, 0, 0}, Progress{});
  EXPECT_TRUE(traced);
  return std::move(*traced);
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

TEST(TraceLines, EveryFrameOfAWindowIsTheFrameTracedAlone) {
  const MovingRoom room(kFrames);
  constexpr std::uint64_t kLines = 10'000;
  const TracedLines lines = trace(room, room.all_frames(), kLines, 9);
  for (FrameIndex frame = 0; frame < kFrames; ++frame)
    ASSERT_EQ(exchanges_in(lines, room.patches.count(), frame),
              tests::trace_one_frame(room, frame, 0, kLines, 9).pairs)
        << frame;
}

TEST(TraceLines, AWindowOf128FramesReachesItsLastSlot) {
  const MovingRoom room(128);
  const TracedLines lines = trace(room, room.all_frames(), 2'000);
  for (const FrameIndex frame : {0u, 63u, 64u, 127u})
    ASSERT_EQ(exchanges_in(lines, room.patches.count(), frame),
              tests::trace_one_frame(room, frame, 0, 2'000, 1).pairs)
        << frame;
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

// What has been traced is a part of what would be: half of the lines are the first half.
TEST(TraceLines, FewerLinesAreTheFirstOfMore) {
  const MovingRoom room(kFrames);
  const std::uint32_t patches = room.patches.count();
  const TracedLines few = trace(room, room.all_frames(), 3'000), more = trace(room, room.all_frames(), 7'000);
  for (FrameIndex slot = 0; slot < kFrames; ++slot) {
    PairCounts rest = exchanges_in(more, patches, slot);
    for (const auto& [pair, count] : exchanges_in(few, patches, slot)) rest[pair] -= count;
    std::erase_if(rest, [](const auto& entry) { return entry.second == 0; });
    const tests::OneFrame later = tests::trace_one_frame(room, slot, 3'000, 7'000, 1);
    ASSERT_EQ(rest, later.pairs) << slot;
    for (PatchId patch = 0; patch < patches; ++patch)
      ASSERT_EQ(more.crossings.at(patch, slot) - few.crossings.at(patch, slot), later.crossings[patch]);
  }
}

TEST(TraceLines, WithoutFramesIsTheSceneAtRestWithoutWhatMoves) {
  const MovingRoom room(kFrames);
  const TracedLines rest = trace(room, {}, 5'000), window = trace(room, room.all_frames(), 5'000);
  EXPECT_EQ(rest.slot_count, 0u);
  EXPECT_EQ(rest.moving_rows.entry_count(), 0u);
  EXPECT_TRUE(same_entries(rest.static_rows, window.static_rows, room.patches.count()));
  EXPECT_EQ(rest.crossings.static_count, window.crossings.static_count);
  EXPECT_EQ(rest.counts.moving_hits, 0u);
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
