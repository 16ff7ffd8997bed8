// Colour: three channels are three grey solutions, and walls give theirs to what they light.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/lit.h"

namespace tests {
namespace {

using engine::PatchId;
using engine::Rgb;
using engine::Vec3;

const Example& cornell_box() {
  static const Example example = load_example("cornell_box");
  return example;
}

api::LightingOptions many_lines() {
  api::LightingOptions options;
  options.line_count = 500'000;
  return options;
}

/// The floor's patches within 1 m of the wall at x = `wall_x_m`.
std::vector<PatchId> floor_near(const ReadyScene& ready, float wall_x_m) {
  std::vector<PatchId> found;
  for (const PatchId p : ready.patches_of_material("white")) {
    const engine::Facet& facet = ready.patches.facets[ready.patches.facet_of[p]];
    if (facet.object != 0 || facet.normal.y < 0.9f || facet.origin.y > 0.1f) continue;
    const engine::CellCorners cell = engine::cell_corners(facet, ready.patches.cell_of(p));
    const Vec3 corner = facet.origin + cell.u[0] * facet.edge_u + cell.v[0] * facet.edge_v;
    if (std::abs(corner.x - wall_x_m) < 1.0f) found.push_back(p);
  }
  return found;
}

/// The scene in which every channel is the channel `pick` answers.
template <class Pick>
Example in_grey(Example example, Pick pick) {
  const auto grey = [&](Rgb& colour) { colour = Rgb{pick(colour), pick(colour), pick(colour)}; };
  for (engine::Material& material : example.scene.materials) {
    grey(material.reflectance);
    grey(material.exitance_w_m2);
  }
  for (auto& series : example.animation.emission.exitance_w_m2)
    for (Rgb& exitance : series) grey(exitance);
  return example;
}

}  // namespace

// In the same scene painted grey throughout nothing is tinted, so a tint is no artefact of the estimate: the
// lines are the same in all channels.
TEST(Colour, WallsTintTheFloorBesideThem) {
  const ReadyScene ready(cornell_box().scene, cornell_box().animation, 0.25);
  const LitFrames lit = light_frames(ready, {0}, many_lines());
  const auto near_green = floor_near(ready, 0), near_red = floor_near(ready, 5.55f);
  ASSERT_GT(near_green.size(), 20u);
  ASSERT_GT(near_red.size(), 20u);
  // Direct light has the lamp's colour, so what tints is the indirect light.
  const Rgb by_green = mean_over(ready, lit.indirect, near_green, 0);
  const Rgb by_red = mean_over(ready, lit.indirect, near_red, 0);
  EXPECT_GT(by_red.r / by_red.g, 1.2 * by_green.r / by_green.g);
  const Rgb lamp = ready.lit.exitance(ready.animation.emission, ready.patches_of_material("light")[0], 0);
  EXPECT_GT(by_red.r / by_red.g, lamp.r / lamp.g) << "redder than the lamp";
  EXPECT_LT(by_green.r / by_green.g, lamp.r / lamp.g) << "greener than the lamp";
}

// The same lines and the same sums, channel by channel. Only the iteration may stop at another step, since it
// ends when no channel changes any more: each solution is within 1e-5 rho / (1 - rho) = 2.7e-5 of its mean
// source, the reflected direct light, which is less than the largest indirect irradiance.
TEST(Colour, EachChannelIsASolutionInGrey) {
  const ReadyScene ready(cornell_box().scene, cornell_box().animation, 0.5);
  const LitFrames rgb = light_frames(ready, {0, 30}, many_lines());
  constexpr std::array<float Rgb::*, 3> kChannels{&Rgb::r, &Rgb::g, &Rgb::b};
  for (const float Rgb::*channel : kChannels) {
    const Example grey = in_grey(cornell_box(), [&](Rgb colour) { return colour.*channel; });
    const ReadyScene ready_in_grey(grey.scene, grey.animation, 0.5);
    const LitFrames alone = light_frames(ready_in_grey, {0, 30}, many_lines());
    double worst = 0, largest = 0;
    for (std::size_t k = 0; k < rgb.radiosity.values.size(); ++k) {
      ASSERT_EQ(rgb.direct.values[k].*channel, alone.direct.values[k].r);
      worst =
          std::max(worst, std::abs(double{rgb.radiosity.values[k].*channel} - alone.radiosity.values[k].r));
      largest = std::max(largest, double{rgb.indirect.values[k].*channel});
    }
    EXPECT_LT(worst, 1e-4 * largest);
  }
}

}  // namespace tests
