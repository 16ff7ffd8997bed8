#include "engine/lighting/gather.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/parallel.h"
#include "engine/lighting/row_kernels.h"
#include "tests/unit/engine/lighting/lit_room.h"

namespace engine {
namespace {

using tests::MovingRoom;

constexpr FrameIndex kFrames = 10;

/// (T_s + M_f) b in the slots of `columns`, b with those columns.
PatchSeries apply(const TracedLines& lines, const PatchSeries& b, const Columns& columns) {
  const SampledOperator sampled(lines);
  PatchSeries arriving(b.patch_count, columns.count());
  EXPECT_TRUE(for_each_patch(b.patch_count, Progress{}, [&](PatchId patch) {
    sampled.gather_at_rest(b, patch, arriving.row(patch));
    sampled.add_moving(b, columns, patch, arriving.row(patch));
  }));
  return arriving;
}

PatchSeries apply(const TracedLines& lines, const PatchSeries& b) {
  return apply(lines, b, Columns::every(lines.slot_count));
}

PatchSeries random_series(std::uint32_t patches, std::uint32_t frames) {
  PatchSeries series(patches, frames);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 2);
  for (Rgb& value : series.values) value = {uniform(random), uniform(random), uniform(random)};
  return series;
}

TEST(Columns, FindTheirSlots) {
  const Columns columns({1, 4, 5, 9}, 10);
  EXPECT_EQ(columns.count(), 4u);
  EXPECT_EQ(columns.slot(2), 5u);
  const auto of = [&](std::uint32_t first, std::uint32_t last) {
    return std::pair(columns.begin_of(first), columns.end_of(last));
  };
  EXPECT_EQ(of(0, 9), std::pair(0u, 4u));
  EXPECT_EQ(of(4, 5), std::pair(1u, 3u));
  EXPECT_EQ(of(2, 8), std::pair(1u, 3u));
  EXPECT_EQ(of(9, 9), std::pair(3u, 4u));
  EXPECT_EQ(of(6, 8).first, of(6, 8).second);
  EXPECT_EQ(of(0, 0), std::pair(0u, 0u));
}

// Sums of powers of two are exact, so all that is left is the rounding of 1 / n and of one product; and of
// the difference that moving things make, which may be taken off again.
TEST(SampledOperator, UniformRadiosityOfAClosedRoomArrivesUnchanged) {
  const MovingRoom room(kFrames);
  const TracedLines lines = tests::trace(room, room.all_frames(), {20'000, 1});
  PatchSeries glow(room.patches.count(), kFrames);
  for (Rgb& value : glow.values) value = {1, 0.25f, 8};
  const PatchSeries arriving = apply(lines, glow);
  int met = 0;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
      if (lines.crossings.at(patch, slot) == 0) continue;
      ++met;
      ASSERT_NEAR(arriving.at(patch, slot).r, 1, 0x1p-21);
      ASSERT_NEAR(arriving.at(patch, slot).g, 0.25f, 0x1p-23);
      ASSERT_NEAR(arriving.at(patch, slot).b, 8, 0x1p-18);
    }
  EXPECT_GT(met, 1000);
}

// T_s + M_f of a window of many frames against the hits of each frame alone. Rounding: sums of up to some
// hundred floats of up to 2.
TEST(SampledOperator, OfAWindowIsInEveryFrameThatOfTheFrameAlone) {
  for (const bool both_sides : {false, true}) {
    const MovingRoom room(kFrames, 0.7, both_sides);
    constexpr std::uint32_t kLines = 8'000;
    const TracedLines lines = tests::trace(room, room.all_frames(), {kLines, 5, 0, 0});
    const PatchSeries b = random_series(room.patches.count(), kFrames);
    const PatchSeries arriving = apply(lines, b);
    for (FrameIndex frame = 0; frame < kFrames; ++frame) {
      const tests::Dense alone = operator_of(tests::trace_one_frame(room, frame, 0, kLines, 5));
      std::vector<double> green;
      for (PatchId patch = 0; patch < room.patches.count(); ++patch) green.push_back(b.at(patch, frame).g);
      const std::vector<double> expected = alone.times(green);
      for (PatchId patch = 0; patch < room.patches.count(); ++patch)
        ASSERT_NEAR(arriving.at(patch, frame).g, expected[patch], 1e-5) << patch << " " << frame;
    }
  }
}

// With the local rays of patches that few lines meet: a frame as a window of its own has the same.
TEST(SampledOperator, WithLocalRaysIsInEveryFrameThatOfAWindowOfThisFrame) {
  const MovingRoom room(kFrames, 0.5);
  const LineOptions few{300, 5, 4, 20};
  const TracedLines lines = tests::trace(room, room.all_frames(), few);
  ASSERT_GT(lines.counts.local_lines, 1'000u);
  for (FrameIndex frame = 0; frame < kFrames; ++frame) {
    const TracedLines alone = tests::trace(room, {frame}, few);
    EXPECT_EQ(tests::exchanges_in(lines, room.patches.count(), frame),
              tests::exchanges_in(alone, room.patches.count(), 0));
    for (PatchId patch = 0; patch < room.patches.count(); ++patch)
      ASSERT_EQ(lines.crossings.at(patch, frame), alone.crossings.at(patch, 0));
  }
}

// The order of additions is that of the row's entries whatever the columns, so the bytes are the same.
TEST(SampledOperator, ColumnsOfSomeSlotsAreThoseOfAll) {
  const MovingRoom room(kFrames);
  const TracedLines lines = tests::trace(room, room.all_frames(), {5'000, 1});
  const PatchSeries b = random_series(room.patches.count(), kFrames);
  const PatchSeries all = apply(lines, b);
  for (const std::vector<std::uint32_t>& slots :
       {std::vector<std::uint32_t>{0}, {9}, {2, 3, 7}, {0, 4, 5, 9}}) {
    const Columns columns(slots, kFrames);
    PatchSeries of_slots(b.patch_count, columns.count());
    for (PatchId patch = 0; patch < b.patch_count; ++patch)
      for (std::uint32_t c = 0; c < columns.count(); ++c) of_slots.at(patch, c) = b.at(patch, slots[c]);
    const PatchSeries some = apply(lines, of_slots, columns);
    for (PatchId patch = 0; patch < b.patch_count; ++patch)
      for (std::uint32_t c = 0; c < columns.count(); ++c)
        ASSERT_EQ(some.at(patch, c), all.at(patch, slots[c]));
  }
}

TEST(SampledOperator, WhatIsEqualInAllFramesIsAddedFromOneColumn) {
  const MovingRoom room(kFrames);
  const TracedLines lines = tests::trace(room, room.all_frames(), {5'000, 1});
  const PatchSeries rest = random_series(room.patches.count(), 1);
  const PatchSeries beyond = random_series(room.patches.count(), kFrames);
  PatchSeries both = beyond;
  for (PatchId patch = 0; patch < both.patch_count; ++patch)
    for (std::uint32_t c = 0; c < kFrames; ++c) both.at(patch, c) += rest.at(patch, 0);
  const SampledOperator sampled(lines);
  const Columns columns = Columns::every(kFrames);
  for (PatchId patch = 0; patch < both.patch_count; ++patch) {
    std::vector<Rgb> from_both(kFrames), from_parts(kFrames);
    sampled.add_moving(both, columns, patch, from_both.data());
    sampled.add_moving(rest.values, beyond, columns, patch, from_parts.data());
    for (FrameIndex f = 0; f < kFrames; ++f) ASSERT_NEAR(from_both[f].r, from_parts[f].r, 1e-5);
  }
}

TEST(SampledOperator, AnObjectThatIsNotThereReceivesNothingAndAtRestNothingThatMovesDoes) {
  const MovingRoom room(kFrames, 0.5);
  const TracedLines lines = tests::trace(room, room.all_frames(), {1'000, 1});
  const PatchSeries b = random_series(room.patches.count(), kFrames);
  const PatchSeries arriving = apply(lines, b);
  const SampledOperator sampled(lines);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
    const std::uint32_t object = room.patches.facets[room.patches.facet_of[patch]].object;
    std::vector<Rgb> at_rest(kFrames, Rgb{1, 1, 1});
    sampled.gather_at_rest(b, patch, at_rest.data());
    for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
      if (object > 0) {
        ASSERT_EQ(at_rest[slot], Rgb{});
      }
      const bool gone = object == 2 && slot != 2 && slot != 3 && slot != 7;
      ASSERT_EQ(arriving.at(patch, slot) == Rgb{}, gone) << patch << " " << slot;
    }
  }
}

TEST(SampledOperator, OneThreadAndSeveralGiveTheSameBytes) {
  const MovingRoom room(kFrames);
  const TracedLines lines = tests::trace(room, room.all_frames(), {10'000, 1});
  const PatchSeries radiosity = random_series(room.patches.count(), kFrames);
  set_thread_count(1);
  const PatchSeries one = apply(lines, radiosity);
  set_thread_count(2);
  const PatchSeries two = apply(lines, radiosity);
  set_thread_count(0);
  EXPECT_EQ(one.values, two.values);
}

TEST(ForEachPatch, SaysThatItWasStopped) {
  Progress progress;
  progress.stop_requested = [] { return true; };
  EXPECT_FALSE(for_each_patch(100, progress, [](PatchId) {}));
}

// Every width up to beyond two vectors of the widest machine; small integers add up exactly.
TEST(RowKernels, AddWholeRowsOfAnyWidth) {
  for (std::size_t width = 1; width < 40; ++width) {
    std::vector<float> rows(5 * width), sum(width + 1, 1.0f);
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<float>(k % 17);
    Exchange twice(4);
    ASSERT_TRUE(twice.absorb(Exchange(4)));
    const std::vector<Exchange> exchanges{Exchange(0), twice, Exchange(2), Exchange(2), Exchange(3)};
    add_rows(sum.data(), rows.data(), width, exchanges);
    add_scaled(sum.data(), rows.data() + width, -3.0f, width);
    for (std::size_t k = 0; k < width; ++k) {
      const auto at = [&](std::size_t row) { return rows[row * width + k]; };
      ASSERT_EQ(sum[k], 1 + at(0) + 2 * at(4) + 2 * at(2) + at(3) - 3 * at(1)) << width;
    }
    ASSERT_EQ(sum[width], 1.0f) << "written beyond the row";
  }
}

}  // namespace
}  // namespace engine
