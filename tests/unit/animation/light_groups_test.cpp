// Groups of lights against the emission they were made of.
#include "engine/animation/light_groups.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace engine {
namespace {

constexpr FrameIndex kFrames = 12;

/// A scene of materials and sources, all dark until a test lights them.
struct Lights {
  Scene scene;
  Animation animation;

  explicit Lights(const std::vector<std::string>& materials, const std::vector<std::string>& sources = {}) {
    animation.frame_count = kFrames;
    for (const std::string& name : materials) {
      scene.materials.push_back({name, {.5f, .5f, .5f}, {}, true});
      animation.emission.exitance_w_m2.push_back({Rgb{}});
    }
    for (const std::string& name : sources)
      animation.emission.sources.push_back({name, api::LightType::point, {{}}, {{0, 0, 1}}, {Rgb{}}});
  }
  std::vector<Rgb>& material(std::size_t m) { return animation.emission.exitance_w_m2[m]; }
  std::vector<Rgb>& source(std::size_t s) { return animation.emission.sources[s].intensity; }
  std::vector<LightGroup> groups(const std::map<std::string, std::vector<std::string>>& named = {}) const {
    return light_groups(scene, animation, named);
  }
};

/// `peak` times a curve.
std::vector<Rgb> varied(Rgb peak, const std::function<float(FrameIndex)>& curve) {
  std::vector<Rgb> series;
  for (FrameIndex f = 0; f < kFrames; ++f) series.push_back(peak * curve(f));
  return series;
}

float ramp(FrameIndex f) {
  return float(f) / 11;
}
float blinking(FrameIndex f) {
  return f / 3 % 2 ? 0.f : 1.f;
}
float wave(FrameIndex f) {
  return 0.5f + 0.5f * std::sin(0.7f * float(f));
}
float fading(FrameIndex f) {
  return std::exp(-0.3f * float(f));
}

/// Largest difference of sum_g scale_g x_g from x, relative to the peak of x.
double deviation(const std::vector<LightGroup>& groups, const std::vector<Rgb>& series,
                 const std::function<const std::vector<Rgb>&(const Emission&)>& of) {
  double worst = 0, peak = 1e-30;
  for (FrameIndex f = 0; f < kFrames; ++f) {
    Rgb sum;
    for (const LightGroup& group : groups) sum += in_frame(group.scale, f) * in_frame(of(group.emission), f);
    const Rgb off = sum - in_frame(series, f);
    worst = std::max<double>({worst, std::abs(off.r), std::abs(off.g), std::abs(off.b)});
    peak = std::max<double>(peak, max_channel(in_frame(series, f)));
  }
  return worst / peak;
}

/// Every material and source: reproduced, and lit by one group only.
void expect_whole(const Lights& lights, const std::vector<LightGroup>& groups) {
  const auto expect = [&](const std::string& name, const std::vector<Rgb>& series, const auto& of) {
    EXPECT_LT(deviation(groups, series, of), 1.1e-6) << name;  // 1e-6 between curves, and rounding
    int lit = 0;
    for (const LightGroup& group : groups)
      for (const Rgb e : of(group.emission))
        if (max_channel(e) > 0) {
          ++lit;
          break;
        }
    int emits = 0;
    for (const Rgb e : series) emits |= max_channel(e) > 0;
    EXPECT_EQ(lit, emits) << name;
  };
  const Emission& all = lights.animation.emission;
  for (std::size_t m = 0; m < all.exitance_w_m2.size(); ++m)
    expect(lights.scene.materials[m].name, all.exitance_w_m2[m],
           [m](const Emission& e) -> const std::vector<Rgb>& { return e.exitance_w_m2[m]; });
  for (std::size_t s = 0; s < all.sources.size(); ++s)
    expect(all.sources[s].name, all.sources[s].intensity,
           [s](const Emission& e) -> const std::vector<Rgb>& { return e.sources[s].intensity; });
}

bool is_scaled(const LightGroup& group) {
  return group.scale.size() > 1;
}

TEST(LightGroups, SteadyLightsAreOneGroupOfScaleOne) {
  Lights lights({"lamp", "wall", "sign"}, {"bulb"});
  lights.material(0) = {Rgb{9, 8, 7}};
  lights.material(2) = std::vector<Rgb>(kFrames, Rgb{1, 0, 0});  // said in every frame
  lights.source(0) = {Rgb{3, 3, 3}};
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].name, "");
  EXPECT_EQ(groups[0].scale, (std::vector<Rgb>{{1, 1, 1}}));
  expect_whole(lights, groups);
}

TEST(LightGroups, LightsOfOneCurveShareAGroupWhateverTheirColourAndKind) {
  Lights lights({"ceiling", "red"}, {"bulb"});
  lights.material(0) = varied({10, 10, 10}, wave);
  lights.material(1) = varied({0.3f, 0, 0}, wave);  // never green or blue: any curve fits there
  lights.source(0) = varied({700, 300, 200}, wave);
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].emission.exitance_w_m2[0].size(), 1u) << "constant; the scale varies";
  EXPECT_EQ(groups[0].emission.sources[0].intensity.size(), 1u);
  ASSERT_EQ(groups[0].scale.size(), kFrames);
  expect_whole(lights, groups);
}

TEST(LightGroups, ABlinkingLightIsConstantAndItsDarkFramesAreOfScaleZero) {
  Lights lights({"lamp", "neon"});
  lights.material(0) = {Rgb{5, 5, 5}};
  lights.material(1) = varied({2, 4, 8}, blinking);
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_FALSE(is_scaled(groups[0])) << "steady lights first";
  EXPECT_EQ(groups[1].emission.exitance_w_m2[1], (std::vector<Rgb>{{2, 4, 8}}));
  EXPECT_EQ(groups[1].emission.exitance_w_m2[0], (std::vector<Rgb>{{}}));
  EXPECT_EQ(groups[1].scale[2], (Rgb{1, 1, 1}));
  EXPECT_EQ(groups[1].scale[3], Rgb{});
  expect_whole(lights, groups);
}

TEST(LightGroups, CurvesMayDifferBetweenChannels) {
  Lights lights({"sunset", "strip"});
  for (FrameIndex f = 0; f < kFrames; ++f) {
    const Rgb e{1, wave(f), 0};
    lights.material(0).resize(kFrames), lights.material(1).resize(kFrames);
    lights.material(0)[f] = 7 * e;
    lights.material(1)[f] = 2 * e;
  }
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 1u);
  expect_whole(lights, groups);
  EXPECT_EQ(groups[0].scale[0].r, 1);
  EXPECT_LT(groups[0].scale[7].g, 1);
}

TEST(LightGroups, CurvesThatDifferByMoreThanRoundingAreApart) {
  Lights lights({"a", "b", "c"});
  lights.material(0) = varied({1, 1, 1}, wave);
  lights.material(1) = varied({3, 3, 3}, [](FrameIndex f) { return wave(f) * (1 + 3e-7f * float(f % 2)); });
  lights.material(2) = varied({3, 3, 3}, [](FrameIndex f) { return wave(f) + (f == 5 ? 1e-5f : 0); });
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_GT(groups[0].emission.exitance(1, 0).r, 0);
  EXPECT_GT(groups[1].emission.exitance(2, 0).r, 0);
  expect_whole(lights, groups);
}

TEST(LightGroups, NamedLightsAreApartEvenWhereTheyVaryAlike) {
  Lights lights({"ceiling", "desk", "door"}, {"bulb", "sun"});
  lights.material(0) = {Rgb{5, 5, 5}};
  lights.material(1) = varied({1, 1, 1}, ramp);
  lights.material(2) = {Rgb{1, 2, 3}};
  lights.source(0) = varied({20, 20, 20}, ramp);
  lights.source(1) = {Rgb{90, 90, 90}};
  const auto groups = lights.groups({{"inside", {"ceiling", "desk"}}, {"out", {"sun"}}, {"unlit", {"none"}}});
  std::vector<std::pair<std::string, bool>> kinds;
  for (const LightGroup& group : groups) kinds.emplace_back(group.name, is_scaled(group));
  EXPECT_EQ(kinds, (std::vector<std::pair<std::string, bool>>{
                       {"", false}, {"", true}, {"inside", false}, {"inside", true}, {"out", false}}));
  EXPECT_GT(groups[3].emission.exitance(1, 0).r, 0);
  EXPECT_GT(max_channel(groups[1].emission.sources[0].intensity[0]), 0);
  expect_whole(lights, groups);
}

TEST(LightGroups, CurvesBeyondTheMostStayWithTheSteadyLightsAsAnimated) {
  Lights lights({"e", "d", "c", "b", "a"});
  lights.material(0) = varied({4, 4, 4}, ramp);
  lights.material(1) = varied({4, 4, 4}, fading);
  lights.material(2) = varied({4, 4, 4}, wave);
  lights.material(3) = varied({4, 4, 4}, blinking);
  lights.material(4) = {Rgb{1, 1, 1}};
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 1 + kScaledGroupsMax);
  EXPECT_FALSE(is_scaled(groups[0]));
  EXPECT_EQ(groups[0].emission.exitance_w_m2[0], lights.material(0)) << "the last by name";
  EXPECT_GT(groups[0].emission.exitance(4, 0).r, 0);
  for (std::size_t g = 1; g < groups.size(); ++g) EXPECT_TRUE(is_scaled(groups[g])) << g;
  expect_whole(lights, groups);
}

TEST(LightGroups, TheMostCurvesAreThoseOfTheSceneNotOfEachNamedGroup) {
  Lights lights({"a", "b", "c", "d"});
  for (std::size_t m = 0; m < 4; ++m) lights.material(m) = varied({1, 1, 1}, wave);
  const auto groups = lights.groups({{"1", {"a"}}, {"2", {"b"}}, {"3", {"c"}}, {"4", {"d"}}});
  ASSERT_EQ(groups.size(), 4u);
  EXPECT_TRUE(is_scaled(groups[2]));
  EXPECT_FALSE(is_scaled(groups[3]));
  EXPECT_EQ(groups[3].emission.exitance_w_m2[3], lights.material(3));
  expect_whole(lights, groups);
}

TEST(LightGroups, ALightOfSeveralGroupsIsOfTheFirstAndAMovingOneCanBeSteady) {
  Lights lights({}, {"torch"});
  lights.source(0) = {Rgb{6, 6, 6}};
  auto& path = lights.animation.emission.sources[0].position;
  path.clear();
  for (FrameIndex f = 0; f < kFrames; ++f) path.push_back({float(f), 0, 0});
  const auto groups = lights.groups({{"b", {"torch"}}, {"a", {"torch"}}});
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_EQ(groups[0].name, "a");
  EXPECT_FALSE(is_scaled(groups[0]));
  EXPECT_EQ(groups[0].emission.sources[0].position.size(), kFrames);
  expect_whole(lights, groups);
}

TEST(LightGroups, ASourceMovesInItsOwnGroupOnly) {
  Lights lights({"lamp"}, {"torch"});
  lights.material(0) = {Rgb{1, 1, 1}};
  lights.source(0) = varied({6, 6, 6}, ramp);
  lights.animation.emission.sources[0].position.resize(kFrames, {3, 2, 1});
  const auto groups = lights.groups();
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_EQ(groups[0].emission.sources[0].position.size(), 1u);
  EXPECT_EQ(groups[1].emission.sources[0].position, lights.animation.emission.sources[0].position);
  EXPECT_EQ(groups[1].emission.sources[0].name, "torch");
  expect_whole(lights, groups);
}

TEST(LightGroups, WhereNothingEmitsThereIsOneDarkGroup) {
  const Lights lights({"wall"}, {"bulb"});
  const auto groups = lights.groups({{"named", {"bulb"}}});
  ASSERT_EQ(groups.size(), 1u);
  EXPECT_FALSE(groups[0].emission.ever_emits(0));
  EXPECT_FALSE(groups[0].emission.sources.at(0).ever_emits());
  expect_whole(lights, groups);
}

TEST(LightGroups, MeanExitanceIsThatOfAllFrames) {
  Lights lights({"lamp", "neon"});
  lights.material(0) = {Rgb{5, 6, 7}};
  lights.material(1) = varied({2, 4, 8}, blinking);  // on in half of the frames
  EXPECT_EQ(mean_exitance(lights.animation.emission, 0), (Rgb{5, 6, 7}));
  EXPECT_EQ(mean_exitance(lights.animation.emission, 1), (Rgb{1, 2, 4}));
}

}  // namespace
}  // namespace engine
