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

PatchSeries apply(const MovingRoom& room, const TracedLines& lines, const PatchSeries& radiosity) {
  PatchSeries irradiance(room.patches.count(), lines.slot_count);
  EXPECT_TRUE(SampledOperator(room.patches, lines).apply(radiosity, irradiance, Progress{}));
  return irradiance;
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
  const PatchSeries arriving = apply(room, lines, glow);
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
  const PatchSeries arriving = apply(room, lines, radiosity);
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

/// Rows that took a mean, and whose.
struct FilledRows {
  int by_polygon = 0, by_object = 0;
};

FilledRows expect_means_in_empty_rows(std::uint64_t line_count) {
  const MovingRoom room(4, 0.2);
  const TracedLines lines = trace(room, line_count);
  const SampledOperator sampled(room.patches, lines);
  const PatchSeries arriving = apply(room, lines, random_series(room.patches.count(), 4));
  const auto mean_of = [&](const Facet& of, std::uint32_t slot, bool whole_object) {
    double sum = 0, area = 0;
    for (PatchId patch = 0; patch < room.patches.count(); ++patch) {
      const Facet& facet = room.patches.facets[room.patches.facet_of[patch]];
      if (whole_object ? facet.object != of.object : facet.polygon != of.polygon) continue;
      if (lines.crossings.at(patch, slot) == 0) continue;
      sum += double{arriving.at(patch, slot).b} * room.patches.area_m2[patch];
      area += room.patches.area_m2[patch];
    }
    return area > 0 ? sum / area : -1;
  };
  FilledRows filled;
  for (const auto& [patch, slot] : sampled.empty_rows()) {
    EXPECT_EQ(lines.crossings.at(patch, slot), 0u);
    const Facet& facet = room.patches.facets[room.patches.facet_of[patch]];
    const double polygon = mean_of(facet, slot, false), object = mean_of(facet, slot, true);
    (polygon >= 0 ? filled.by_polygon : filled.by_object) += 1;
    EXPECT_NEAR(arriving.at(patch, slot).b, polygon >= 0 ? polygon : std::max(0.0, object), 1e-5);
  }
  return filled;
}

// Of about 1,000 patches 300 lines leave most rows empty, and 20 lines whole polygons.
TEST(SampledOperator, EmptyRowsTakeTheMeanOfTheirPolygonElseOfTheirObject) {
  EXPECT_GT(expect_means_in_empty_rows(300).by_polygon, 1000);
  EXPECT_GT(expect_means_in_empty_rows(20).by_object, 100);
}

TEST(SampledOperator, AnObjectThatIsNotThereHasNoEmptyRowsAndReceivesNothing) {
  const MovingRoom room(kFrames, 0.2);
  const TracedLines lines = trace(room, 300);
  const PatchSeries arriving = apply(room, lines, random_series(room.patches.count(), kFrames));
  const auto is_gone = [&](PatchId patch, std::uint32_t slot) {
    return room.patches.facets[room.patches.facet_of[patch]].object == 2 && slot != 2 && slot != 3 &&
           slot != 7;
  };
  const SampledOperator sampled(room.patches, lines);
  for (const auto& [patch, slot] : sampled.empty_rows())
    ASSERT_FALSE(is_gone(patch, slot)) << patch << " " << slot;
  for (PatchId patch = 0; patch < room.patches.count(); ++patch)
    for (std::uint32_t slot = 0; slot < kFrames; ++slot) {
      if (!is_gone(patch, slot)) continue;
      ASSERT_EQ(arriving.at(patch, slot), Rgb{});
    }
}

TEST(SampledOperator, OneThreadAndSeveralGiveTheSameBytes) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, 10'000);
  const PatchSeries radiosity = random_series(room.patches.count(), kFrames);
  set_thread_count(1);
  const PatchSeries one = apply(room, lines, radiosity);
  set_thread_count(2);
  const PatchSeries two = apply(room, lines, radiosity);
  set_thread_count(0);
  EXPECT_EQ(one.values, two.values);
}

TEST(SampledOperator, SaysThatItWasStopped) {
  const MovingRoom room(kFrames);
  const TracedLines lines = trace(room, 1'000);
  PatchSeries irradiance(room.patches.count(), kFrames);
  Progress progress;
  progress.stop_requested = [] { return true; };
  EXPECT_FALSE(SampledOperator(room.patches, lines)
                   .apply(random_series(room.patches.count(), kFrames), irradiance, progress));
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
