// The measure of global lines where it counts: on the patches they meet. Lines that are independent of each
// other are the first of many seeds; the lines of one seed are stratified and scatter less.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "engine/base/parallel.h"
#include "engine/base/sobol.h"
#include "engine/lines/trace_lines.h"
#include "tests/support/lit.h"
#include "tests/support/statistics.h"

namespace tests {
namespace {

using engine::PatchId;
using engine::SurfaceHit;
using engine::Vec3;

/// All tests of this file refuse a correct engine for one choice of seeds in a thousand.
const double kFalseAlarm = sidak(1e-3, 8);

constexpr Vec3 kRoom{3, 2, 1.5f};

SceneBuilder empty_room() {
  SceneBuilder built;
  built.add_box({0, 0, 0}, kRoom, true, built.add_material({}));
  return built;
}

/// The hits of line `k` of many independent ones.
class IndependentLines {
 public:
  explicit IndependentLines(const ReadyScene& ready)
      : ready_(ready), box_(engine::line_box(ready.patches, ready.animation)) {}

  const std::vector<SurfaceHit>& hits(std::uint64_t k) {
    ray_ = engine::global_line(box_, 0, engine::stream_seed(77, k));
    ready_.static_rays.all_hits(ray_, hits_);
    return hits_;
  }
  const engine::Ray& ray() const { return ray_; }

 private:
  const ReadyScene& ready_;
  engine::LineBox box_;
  engine::Ray ray_;
  std::vector<SurfaceHit> hits_;
};

PatchId patch_of(const ReadyScene& ready, const SurfaceHit& hit) {
  return ready.patches.patch_at(hit.facet, hit.u, hit.v, true);
}

}  // namespace

// Each line counted once, where it enters the room: 84 patches of different area, so 83 degrees of freedom.
TEST(GlobalLines, MeetPatchesInProportionToTheirArea) {
  const ReadyScene ready(empty_room(), 0.6);
  IndependentLines lines(ready);
  std::vector<double> counts(ready.patches.count()), expected(ready.patches.count());
  double met = 0, area = 0;
  for (std::uint64_t k = 0; k < 200'000; ++k) {
    const auto& hits = lines.hits(k);
    if (hits.empty()) continue;  // the box is a little larger than the room
    ++counts[patch_of(ready, hits[0])];
    ++met;
  }
  for (const float a : ready.patches.area_m2) area += a;
  for (PatchId p = 0; p < counts.size(); ++p) expected[p] = met * ready.patches.area_m2[p] / area;
  const auto degrees = static_cast<double>(counts.size() - 1);
  EXPECT_GT(chi_square_p(chi_square(counts, expected), degrees), kFalseAlarm);
}

// cos theta has the density 2 cos theta on a patch, whatever its tilt, and behind another: its square is
// uniform, in 20 bins; and the points are uniform on it, in 4 x 4. Each line meets it once.
TEST(GlobalLines, MeetATiltedPatchBehindAnotherWithACosine) {
  SceneBuilder built = empty_room();
  built.add_polygon({{0.8f, 0.5f, 0.4f}, {2.1f, 0.6f, 0.9f}, {1.9f, 1.6f, 1.2f}, {0.6f, 1.5f, 0.7f}},
                    0);  // facet 6
  built.add_polygon({{0.5f, 0.3f, 1.3f}, {2.4f, 0.3f, 1.3f}, {2.4f, 1.7f, 1.3f}, {0.5f, 1.7f, 1.3f}}, 0);
  const ReadyScene ready(built, 4);
  const engine::Facet& facet = ready.patches.facets[6];
  IndependentLines lines(ready);
  std::vector<double> cosines(20), places(16);
  double met = 0;
  for (std::uint64_t k = 0; k < 200'000; ++k)
    for (const SurfaceHit& hit : lines.hits(k)) {
      if (hit.facet != 6) continue;
      const double cosine = engine::dot(lines.ray().direction, facet.normal);
      ++cosines[std::min<std::size_t>(19, static_cast<std::size_t>(20 * cosine * cosine))];
      ++places[std::min<std::size_t>(3, static_cast<std::size_t>(4 * hit.u)) * 4 +
               std::min<std::size_t>(3, static_cast<std::size_t>(4 * hit.v))];
      ++met;
    }
  EXPECT_GT(met, 10'000);
  EXPECT_GT(chi_square_p(chi_square(cosines, std::vector<double>(20, met / 20)), 19), kFalseAlarm);
  EXPECT_GT(chi_square_p(chi_square(places, std::vector<double>(16, met / 16)), 15), kFalseAlarm);
}

// Cauchy's 4 V / S, between the walls that a line meets.
TEST(GlobalLines, HaveTheMeanChordOfTheRoom) {
  const ReadyScene ready(empty_room(), 4);
  IndependentLines lines(ready);
  Sample chords;
  for (std::uint64_t k = 0; k < 100'000; ++k) {
    const auto& hits = lines.hits(k);
    if (hits.empty()) continue;
    ASSERT_EQ(hits.size(), 2u);
    chords.add(double{hits[1].distance} - hits[0].distance);
  }
  const double volume = double{kRoom.x} * kRoom.y * kRoom.z;
  const double surface =
      2 * (double{kRoom.x} * kRoom.y + double{kRoom.x} * kRoom.z + double{kRoom.y} * kRoom.z);
  EXPECT_TRUE(agrees(chords, 4 * volume / surface, kFalseAlarm, 1e-6));
  EXPECT_LT(chords.standard_error(), 3e-3 * 4 * volume / surface);
}

// n_ij = n_ji for every pair, past a thing in the way: a line is seen from both its ends.
TEST(GlobalLines, ExchangeAsOftenOneWayAsTheOther) {
  SceneBuilder built = empty_room();
  built.add_box({1, 0.7f, 0.3f}, {1.7f, 1.3f, 0.9f}, false, 0);
  const ReadyScene ready(built, 0.6);
  const std::vector<engine::FrameIndex> frames{0};
  const auto traced =
      engine::trace_lines(ready.patches, ready.animation, ready.static_rays, frames, {100'000, 3, 0, 0}, {});
  const std::uint32_t n = ready.patches.count();
  std::vector<std::uint64_t> count(std::size_t{n} * n);
  std::uint64_t exchanges = 0, one_way = 0;
  for (PatchId i = 0; i < n; ++i)
    for (const engine::Exchange exchange : traced->static_rows.row(i))
      count[std::size_t{i} * n + exchange.sender()] += exchange.count();
  for (PatchId i = 0; i < n; ++i)
    for (PatchId j = 0; j < n; ++j) {
      exchanges += count[std::size_t{i} * n + j];
      one_way += count[std::size_t{i} * n + j] != count[std::size_t{j} * n + i];
    }
  EXPECT_GT(exchanges, 100'000u);
  EXPECT_EQ(one_way, 0u);
}

// The error of a form factor n_ij / n_i falls as N^-1/2 for random lines: the slope of its logarithm over
// four counts of lines, each the root mean square of 256 independent trials, whose logarithm has a standard
// error of 1 / sqrt(2 x 256) = .044. The slope's own follows from the least squares; normal quantile of the
// false alarm. Stratified lines must do better at the largest count.
TEST(GlobalLines, ErrorFallsWithTheRootOfTheirNumber) {
  constexpr double kExact = 0.19982489569838746;  // opposite faces of a cube
  constexpr int kTrials = 256;
  constexpr std::array<std::uint64_t, 4> kCounts{128, 512, 2048, 8192};
  SceneBuilder built;
  built.add_box({0, 0, 0}, {1, 1, 1}, true, built.add_material({}));
  const ReadyScene ready(built, 4);
  std::array<double, 4> squares{};
  std::vector<std::array<double, 4>> errors(kTrials);
  engine::parallel_for(kTrials, [&](std::size_t trial) {
    IndependentLines lines(ready);
    std::uint64_t next = trial << 32;
    for (std::size_t c = 0; c < kCounts.size(); ++c) {
      double from = 0, both = 0;
      for (std::uint64_t k = 0; k < kCounts[c]; ++k) {
        const auto& hits = lines.hits(next++);
        if (hits.size() != 2) continue;
        const std::uint32_t a = hits[0].facet, b = hits[1].facet;
        from += (a == 4) + (b == 4);
        both += (a == 4 && b == 5) + (a == 5 && b == 4);
      }
      errors[trial][c] = both / from - kExact;
    }
  });
  for (const auto& error : errors)
    for (std::size_t c = 0; c < 4; ++c) squares[c] += error[c] * error[c];
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    mean_x += std::log(static_cast<double>(kCounts[c])) / 4;
    mean_y += std::log(std::sqrt(squares[c] / kTrials)) / 4;
  }
  for (std::size_t c = 0; c < 4; ++c) {
    const double x = std::log(static_cast<double>(kCounts[c])) - mean_x;
    xx += x * x;
    xy += x * (std::log(std::sqrt(squares[c] / kTrials)) - mean_y);
  }
  const double slope = xy / xx, slope_error = std::sqrt(1.0 / (2 * kTrials) / xx);
  std::cout << "slope " << slope << " +- " << slope_error << '\n';
  EXPECT_GT(two_sided_p((slope + 0.5) / slope_error, 1e4), kFalseAlarm);
  EXPECT_LT(slope_error, 0.02);

  double squares_of_sets = 0;
  const std::vector<engine::FrameIndex> frames{0};
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    const auto traced = engine::trace_lines(ready.patches, ready.animation, ready.static_rays, frames,
                                            {kCounts.back(), seed, 0, 0}, {});
    double both = 0;
    for (const engine::Exchange exchange : traced->static_rows.row(4))
      if (exchange.sender() == 5) both += exchange.count();
    const double error = both / traced->crossings.at(4, 0) - kExact;
    squares_of_sets += error * error;
  }
  std::cout << "error of " << kCounts.back() << " lines: random " << std::sqrt(squares.back() / kTrials)
            << ", stratified " << std::sqrt(squares_of_sets / 64) << '\n';
  EXPECT_LT(squares_of_sets / 64, squares.back() / kTrials) << "stratified lines";
}

}  // namespace tests
