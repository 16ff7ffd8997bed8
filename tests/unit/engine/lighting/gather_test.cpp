#include "engine/lighting/gather.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/base/parallel.h"
#include "engine/lighting/row_kernels.h"
#include "tests/unit/engine/moving_room.h"

namespace engine {
namespace {

using tests::MovingRoom;

constexpr FrameIndex kFrames = 10;

TracedLines trace(const MovingRoom& room, std::uint64_t lines) {
  const auto frames = room.all_frames();
  return *trace_lines(room.patches, room.animation, room.static_rays, frames, {lines, 1}, Progress{});
}

Columns every_slot(std::uint32_t slots) {
  std::vector<std::uint32_t> all(slots);
  std::iota(all.begin(), all.end(), 0u);
  return {std::move(all), slots};
}

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
  return apply(lines, b, every_slot(lines.slot_count));
}

PatchSeries random_series(std::uint32_t patches, std::uint32_t frames) {
  PatchSeries series(patches, frames);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 2);
  for (Rgb& value : series.values) value = {uniform(random), uniform(random), uniform(random)};
  return series;
}

// Sums of powers of two are exact, so all that is left is the rounding of 1 / n and of one product.
TEST(SampledOperator, UniformRadiosityOfAClosedRoomArrivesUnchanged) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, 20'000);
  PatchSeries glow(room.patches.count(), kFrames);
  for (Rgb& value : glow.values) value = {1, 0.25f, 8};
  const PatchSeries arriving = apply(lines, glow);
  int met = 0;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
      if (lines.crossings.at(patch, slot) == 0) continue;
      ++met;
      ASSERT_NEAR(arriving.at(patch, slot).r, 1, 0x1p-22);
      ASSERT_NEAR(arriving.at(patch, slot).g, 0.25f, 0x1p-24);
      ASSERT_NEAR(arriving.at(patch, slot).b, 8, 0x1p-19);
    }
  EXPECT_GT(met, 1000);
}

// Every slot by itself, in doubles, from the exchanges. Rounding: sums of n <= 10^4 floats.
TEST(SampledOperator, GathersWhatTheExchangesOfEachSlotSay) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, 5'000);
  const PatchSeries radiosity = random_series(room.patches.count(), kFrames);
  const PatchSeries arriving = apply(lines, radiosity);
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
      const std::uint32_t crossings = lines.crossings.at(patch, slot);
      if (crossings == 0) continue;
      double sum = 0;
      for (const Exchange& e : lines.static_rows.row(patch))
        sum += double{radiosity.at(e.sender(), slot).g} * e.count();
      for (const SlotExchange& e : lines.moving_rows.row(patch))
        if (e.first_slot <= slot && slot <= e.last_slot)
          sum += double{radiosity.at(e.sender, slot).g} * e.weight;
      ASSERT_NEAR(arriving.at(patch, slot).g, sum / crossings, 1e-4) << patch << " " << slot;
    }
}

TEST(SampledOperator, OneThreadAndSeveralGiveTheSameBytes) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, 10'000);
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
