// Table 1 of Besuievsky & Pueyo on the garage: as many key-frames as an independent implementation found.
#include <gtest/gtest.h>

#include "engine/keyframes/select_key_frames.h"
#include "tests/support/lit.h"

namespace tests {
namespace {

struct KeyCounts {
  std::size_t at_tenth = 0, at_fifth = 0;  ///< for thresholds of .1 and .2 W
};

/// The estimate's cut edges at 2 m: 413 patches. Counts do not move with more than its 400,000 lines (ten
/// times as many: the same counts, seed by seed), so it counts as converged; what scatters them by one or two
/// is direct light, 32 rays per patch and lamp.
KeyCounts count_keys(const std::string& json) {
  const Example garage = load_example("garage", json);
  const ReadyScene ready(garage.scene, garage.animation, 2.0);
  EXPECT_EQ(ready.patches.count(), 413u);
  api::LightingOptions options;
  options.mode = api::LightingMode::paper;
  options.estimate_patch_edge_m = 2.0;
  options.estimate_line_count = 400'000;
  const auto groups = engine::light_groups(ready.scene, ready.animation, {}, 0);
  const auto keys_at = [&](double epsilon) {
    options.epsilon = epsilon;
    auto estimator =
        engine::Estimator::begin(ready.scene, ready.animation, ready.static_rays, groups, options, {});
    return engine::select_key_frames(*estimator, options, {})->keys.size();
  };
  return {keys_at(0.1), keys_at(0.2)};
}

testing::AssertionResult within(std::size_t count, std::size_t low, std::size_t high) {
  if (low <= count && count <= high) return testing::AssertionSuccess();
  return testing::AssertionFailure() << count << " key-frames, expected " << low << " .. " << high;
}

}  // namespace

// The ranges are those of another implementation over five seeds (71-72 and 38-43; 65-67 and 38 with a lamp
// off), 3 more on either side: two converged estimates differ in where their rays fall, and one key that
// moves by a frame moves those after it. Over four seeds ours gave 72-73 and 40; 66-68 and 38. The paper
// itself, whose lamps' power is not known, has 75 and 39, and 61 with a lamp off.

TEST(Table1, FindsTheKeyFramesOfTheGarage) {
  const KeyCounts keys = count_keys("animation.json");
  EXPECT_TRUE(within(keys.at_tenth, 71 - 3, 72 + 3));
  EXPECT_TRUE(within(keys.at_fifth, 38 - 3, 43 + 3));
}

TEST(Table1, FindsFewerKeyFramesWithALampOff) {
  const KeyCounts keys = count_keys("animation_light_off.json");
  EXPECT_TRUE(within(keys.at_tenth, 65 - 3, 67 + 3));
  EXPECT_TRUE(within(keys.at_fifth, 38 - 3, 38 + 3));
}

}  // namespace tests
