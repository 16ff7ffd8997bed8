// Sequences with frames between the solved ones, against the reference, which has the same lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/interpolate/interpolate.h"
#include "engine/keyframes/fewest_key_frames.h"
#include "engine/lighting/compose.h"
#include "tests/unit/engine/pipeline/solve_room.h"

namespace engine {
namespace {

using api::FrameKind;
using api::LightingMode;
using tests::LitRoom;
using tests::quick_options;
using tests::Solution;
using tests::solve;

/// Largest difference from the reference in a frame, relative to max(B, half the mean B).
double difference_in(const tests::World& room, const Solution& solution, const Solution& reference,
                     FrameIndex frame) {
  const PatchSeries &a = solution.sequence.radiosity_w_m2, &b = reference.sequence.radiosity_w_m2;
  const double floor = 0.5 * mean_radiosity(room.lit(), b);
  double largest = 0;
  for (PatchId patch = 0; patch < a.patch_count; ++patch) {
    const Rgb by = a.at(patch, frame) - b.at(patch, frame);
    const double against = std::max(double{max_channel(b.at(patch, frame))}, floor);
    largest = std::max(largest, std::max({std::abs(by.r), std::abs(by.g), std::abs(by.b)}) / against);
  }
  return largest;
}

/// The largest of the frames that were solved, or of those between.
double difference(const tests::World& room, const Solution& solution, const Solution& reference,
                  bool solved) {
  double largest = 0;
  for (const api::FrameRecord& record : solution.sequence.key_frames.frames)
    if ((record.kind == FrameKind::interpolated) != solved)
      largest = std::max(largest, difference_in(room, solution, reference, record.frame));
  return largest;
}

// Solved frames are those of the reference but for where iterations end; frames between are off by what
// interpolation misses, which the report says is kept or not.
TEST(InterpolatedFrames, SolvedFramesAreThoseOfTheReferenceAndOthersNearThem) {
  const LitRoom room(40);
  api::LightingOptions options = quick_options();
  options.standard_errors = true;  // then all modes share their lines
  const Solution solution = solve(room.lit(), options);
  options.mode = LightingMode::reference;
  const Solution reference = solve(room.lit(), options);
  EXPECT_LT(solution.count("key_frames") + solution.count("check_frames"), 40);
  EXPECT_LT(difference(room, solution, reference, true), 1e-4);
  bool kept = true;
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals)
    kept = kept && interval.kept.value_or(true);
  const double missed = difference(room, solution, reference, false);
  EXPECT_GT(missed, 1e-4);
  EXPECT_TRUE(!kept || missed < 1.5 * options.tolerance) << missed;
}

/// The largest difference of the frames between two keys.
double difference_between(const tests::World& room, const Solution& solution, const Solution& reference,
                          const api::KeyFrameInterval& interval) {
  double largest = 0;
  for (FrameIndex f = interval.first + 1; f < interval.last; ++f)
    largest = std::max(largest, difference_in(room, solution, reference, f));
  return largest;
}

/// A lit room, a dark one beside it (x > 3 m), and a box (object 1) that goes through the walls between:
/// wholly in the first up to frame 5, wholly in the second from frame 10 on.
struct TwoRooms : tests::World {
  static Scene rooms() {
    Scene scene = tests::scene_with(2, 2);
    scene.materials[1] = {"lamp", {}, {}, false};
    tests::add_box(scene, {0, 0, 0}, {3, 2.5f, 2}, true);
    tests::add_box(scene, {3.1f, 0, 0}, {6, 2.5f, 2}, true);
    tests::add_box(scene, {-0.3f, -0.3f, -0.3f}, {0.3f, 0.3f, 0.3f}, false, 1);
    tests::add_polygon(scene, {{1, 1, 1.9f}, {1, 1.6f, 1.9f}, {1.8f, 1.6f, 1.9f}, {1.8f, 1, 1.9f}}, 0, 1);
    return scene;
  }
  static Animation passing(bool with_box) {
    Animation animation = tests::still(rooms(), 16);
    animation.emission.exitance_w_m2[1] = {{10, 8, 5}};
    animation.objects[1].spans.clear();
    for (FrameIndex f = 0; with_box && f < 16; ++f)
      animation.objects[1].spans.push_back({f, f, tests::moved_to(1.6 + 0.2 * f, 1.2, 0.8)});
    return animation;
  }
  explicit TwoRooms(bool with_box = true) : World(rooms(), passing(with_box), 0.5) {}

  bool in_dark_room(PatchId patch) const {
    return patches.facets[patches.facet_of[patch]].object == 0 && tests::centre_of(patches, patch).x > 3.05f;
  }
  bool of_box(PatchId patch) const { return patches.facets[patches.facet_of[patch]].object == 1; }
};

// No light goes with it: where it is in one room altogether, the other is as if it were not there.
TEST(InterpolatedFrames, AThingThatPassesThroughWallsTakesNoLightAlong) {
  const TwoRooms room, without(false);
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.standard_errors = false;
  const Solution solution = solve(room.lit(), options), alone = solve(without.lit(), options);
  const PatchSeries &b = solution.sequence.radiosity_w_m2, &empty = alone.sequence.radiosity_w_m2;
  // What iterations may leave (kIterationError): groups of patches reach through walls while they converge.
  const double allowed = 2e-5 * mean_radiosity(without.lit(), empty);
  int lit_boxes = 0;
  for (PatchId patch = 0; patch < b.patch_count; ++patch)
    for (FrameIndex f = 0; f < 16; ++f) {
      const float found = max_channel(b.at(patch, f));
      ASSERT_TRUE(std::isfinite(found) && found >= 0);
      if (room.in_dark_room(patch) && (f <= 5 || f >= 10)) {
        ASSERT_LE(found, allowed) << f;
      }
      if (room.of_box(patch) && f >= 10) {
        ASSERT_LE(found, allowed) << f;
      }
      lit_boxes += room.of_box(patch) && f <= 5 && found > 0;
      if (!room.of_box(patch) && f >= 10) {
        ASSERT_NEAR(b.at(patch, f).g, empty.at(patch, f).g, allowed);
      }
    }
  EXPECT_GT(lit_boxes, 0);
}

TEST(InterpolatedFrames, TheToleranceIsKeptWhereAThingPassesThroughWallsOrTheReportSaysSo) {
  const TwoRooms room;
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.standard_errors = true;  // as above
  options.line_count = options.moving_line_count = 64'000;
  const Solution reference = solve(room.lit(), options);
  options.mode = LightingMode::standard;
  const Solution solution = solve(room.lit(), options);
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals) {
    ASSERT_TRUE(interval.kept.has_value());
    EXPECT_TRUE(!*interval.kept ||
                difference_between(room, solution, reference, interval) <= options.tolerance)
        << interval.first;
  }
}

/// A bare room in which a black thing swings to and fro under the lamp: patches of 3 m hardly see its shadow
/// move about on them.
struct SwingingRoom : tests::World {
  static Scene bare() {
    Scene scene = tests::scene_with(2, 3);
    scene.materials[1] = {"lamp", {}, {}, false};
    scene.materials[2] = {"black", {}, {}, false};
    tests::add_box(scene, {-1.5f, -1.25f, 0}, {1.5f, 1.25f, 2}, true);
    tests::add_polygon(
        scene, {{-0.1f, -0.1f, 1.9f}, {-0.1f, 0.1f, 1.9f}, {0.1f, 0.1f, 1.9f}, {0.1f, -0.1f, 1.9f}}, 0, 1);
    tests::add_box(scene, {-0.2f, -0.2f, -0.1f}, {0.2f, 0.2f, 0.1f}, false, 1, 2);
    return scene;
  }
  static Animation swinging(FrameIndex frames) {
    Animation animation = tests::still(bare(), frames);
    animation.emission.exitance_w_m2[1] = {{100, 80, 50}};
    animation.objects[1].spans.clear();
    for (FrameIndex f = 0; f < frames; ++f)
      animation.objects[1].spans.push_back({f, f, tests::moved_to(0.7 * std::sin(0.8 * f), 0, 0.5)});
    return animation;
  }
  explicit SwingingRoom(FrameIndex frames) : World(bare(), swinging(frames), 0.5) {}

  /// All light is interpolated, and the estimate is blind.
  static api::LightingOptions options() {
    api::LightingOptions options = quick_options();
    options.estimate_patch_edge_m = 3;
    options.estimate_line_count = 100'000;
    options.interpolated = api::Interpolated::total;
    options.samples_per_light = 64;
    options.tolerance = 0.1;
    return options;
  }
};

// What the estimate does not see is found by the checks, but intervals are split three times only: where that
// is not enough the report says so, and it is true.
TEST(InterpolatedFrames, IntervalsThatSplittingDoesNotMendAreNamed) {
  const SwingingRoom room(127);
  api::LightingOptions options = room.options();
  const Solution solution = solve(room.lit(), options);
  options.mode = LightingMode::reference;
  const Solution reference = solve(room.lit(), options);
  int broken = 0;
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals) {
    if (interval.last == interval.first + 1) continue;
    ASSERT_TRUE(interval.observed_error && interval.kept);
    EXPECT_EQ(*interval.kept, *interval.observed_error <= options.tolerance);
    if (difference_between(room, solution, reference, interval) <= options.tolerance) continue;
    ++broken;
    EXPECT_FALSE(*interval.kept) << interval.first;
  }
  EXPECT_GT(broken, 0);
}

// 54 steps split by three three times leave a frame between two keys, and that is a check. What it would be
// like without it is told, but no one has to put up with it.
TEST(InterpolatedFrames, WhereEveryFrameIsSolvedThePromiseIsKeptWhateverLeavingThemOutWouldDo) {
  const SwingingRoom room(55);
  const Solution solution = solve(room.lit(), room.options());
  double largest = 0;
  for (const api::FrameRecord& record : solution.sequence.key_frames.frames)
    ASSERT_NE(record.kind, FrameKind::interpolated);
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals) {
    EXPECT_EQ(interval.kept, true) << interval.first;
    largest = std::max(largest, interval.observed_error.value_or(0));
  }
  EXPECT_GT(largest, room.options().tolerance);
}

/// 300 frames in which object 1 creeps past.
struct SlowRoom : tests::World {
  static Animation slow() {
    Animation animation = tests::lit_room_animation(tests::lit_room_scene(false), 300);
    animation.objects[1].spans.clear();
    for (FrameIndex f = 0; f < 300; ++f)
      animation.objects[1].spans.push_back({f, f, tests::moved_to(0.002 * f - 0.3, 0.1, 1.2)});
    animation.objects[2].spans = {{0, 299, {}}};
    return animation;
  }
  SlowRoom() : World(tests::lit_room_scene(false), slow(), 1.5) {}
};

// 300 frames are three windows that share frames 127 and 254; the reference's are of 128 without sharing. A
// cubic has slopes of its own at the ends of each window, and its values are the same there. One frame beside
// a key of intervals of h = 15 frames or more a smooth curve is missed by 4 (h - 1) / h^2 < 1/4 of what it is
// missed by half way.
TEST(InterpolatedFrames, WindowsOfManyFramesShareAKeyAndLeaveNoSeam) {
  const SlowRoom room;
  api::LightingOptions options = quick_options(LightingMode::reference);
  options.standard_errors = true;  // as above
  options.line_count = options.moving_line_count = 30'000;
  options.samples_per_light = 128;  // shadows that pass one of few samples come in steps
  options.tolerance = 0.2;
  const Solution reference = solve(room.lit(), options);
  options.mode = LightingMode::standard;
  for (const auto interpolation : {api::Interpolation::linear, api::Interpolation::monotone_cubic}) {
    options.interpolation = interpolation;
    const Solution solution = solve(room.lit(), options);
    const auto& frames = solution.sequence.key_frames.frames;
    EXPECT_EQ(frames[127].kind, FrameKind::key);
    EXPECT_EQ(frames[254].kind, FrameKind::key);
    EXPECT_LT(solution.count("key_frames"), 100);
    EXPECT_LT(difference(room, solution, reference, true), 1e-4);
    const double missed = difference(room, solution, reference, false);
    EXPECT_LT(missed, options.tolerance);
    EXPECT_GT(missed, 1e-4);
    for (const FrameIndex beside : {126u, 128u, 253u, 255u})
      EXPECT_LT(difference_in(room, solution, reference, beside), 0.25 * missed) << beside;
  }
}

/// One floor under two suns that rise and set, 2 x kIntervalMax frames and more: no light but theirs, which
/// has no noise.
struct SunnyFloor : tests::World {
  static Scene floor() {
    Scene scene = tests::scene_with(1, 1);
    tests::add_polygon(scene, {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}});
    return scene;
  }
  static Animation suns() {
    Animation animation = tests::still(floor(), 2 * kIntervalMax + 30);
    for (const auto& [name, pace] : {std::pair("dawn", 0.061f), std::pair("noon", 0.083f)}) {
      SourceMotion sun{name, api::LightType::directional, {{}}, {{0, 0, -1}}, {}, 1, 1};
      for (FrameIndex f = 0; f < animation.frame_count; ++f)
        sun.intensity.push_back(Rgb{1, 1, 1} * (2.3f + std::sin(pace * static_cast<float>(f))));
      animation.emission.sources.push_back(sun);
    }
    return animation;
  }
  SunnyFloor() : World(floor(), suns(), 1.0) {}
};

/// Of one patch at a check, relative to its own B (never below half the mean): each of `parts` interpolated
/// from the keys alone, added up.
double missed_at(FrameIndex check, const std::vector<const PatchSeries*>& parts,
                 const std::vector<FrameIndex>& keys) {
  const Interpolator cubic(keys, std::array{check}, api::Interpolation::monotone_cubic);
  double missed = 0, all = 0;
  for (const PatchSeries* part : parts) {
    std::vector<Rgb> at_keys;
    for (const FrameIndex key : keys) at_keys.push_back(part->at(0, key));
    Rgb found;
    cubic.apply(at_keys.data(), &found);
    missed += double{found.g} - part->at(0, check).g;
    all += part->at(0, check).g;
  }
  return std::abs(missed) / all;
}

/// Every error that was observed is that of interpolating the files of the groups, or all light, over the
/// whole sequence: as the result itself is made.
void expect_observed_as_interpolated(const tests::World& floor, const api::LightingOptions& options) {
  const Solution solution = solve(floor.lit(), options);
  std::vector<const PatchSeries*> parts;
  for (const auto& [name, lights] : options.light_groups)
    parts.push_back(solution.series("radiosity_" + name + ".npy"));
  if (parts.empty()) parts.push_back(&solution.sequence.radiosity_w_m2);
  std::vector<FrameIndex> keys, checks;
  for (const api::FrameRecord& record : solution.sequence.key_frames.frames) {
    if (record.kind == FrameKind::key) keys.push_back(record.frame);
    if (record.kind == FrameKind::check) checks.push_back(record.frame);
  }
  double largest = 0;
  for (const api::KeyFrameInterval& interval : solution.sequence.key_frames.intervals) {
    double expected = 0;
    for (const FrameIndex check : checks)
      if (interval.first < check && check < interval.last)
        expected = std::max(expected, missed_at(check, parts, keys));
    EXPECT_NEAR(interval.observed_error.value_or(0), expected, 1e-5) << interval.first;
    largest = std::max(largest, expected);
  }
  EXPECT_GT(largest, 1e-3);
}

TEST(InterpolatedFrames, WhereAllLightIsInterpolatedItsErrorIsObservedAsItIsInterpolated) {
  const SunnyFloor floor;
  api::LightingOptions options = quick_options();
  options.interpolated = api::Interpolated::total;
  options.interpolation = api::Interpolation::monotone_cubic;
  options.standard_errors = false;
  options.tolerance = 0.1;
  expect_observed_as_interpolated(floor, options);
  options.light_groups = {{"dawn", {"dawn"}}, {"noon", {"noon"}}};
  expect_observed_as_interpolated(floor, options);
}

}  // namespace
}  // namespace engine
