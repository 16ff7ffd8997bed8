#include "tests/support/lit.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "engine/lighting/compose.h"
#include "engine/pipeline/light_directly.h"
#include "engine/pipeline/light_indirectly.h"

namespace tests {
namespace {

/// The value, or the end of the test program with the reason: nothing can be tested without it.
template <class T>
T value_or_abort(api::Result<T> result) {
  if (!result) {
    std::cerr << result.error().message << '\n';
    std::abort();
  }
  return std::move(*result);
}

}  // namespace

ReadyScene::ReadyScene(engine::Scene a_scene, engine::Animation an_animation, double patch_edge_m)
    : scene(std::move(a_scene)),
      animation(std::move(an_animation)),
      patches(value_or_abort(engine::mesh_into_patches(scene, patch_edge_m))),
      static_rays(patches, animation),
      lit{scene, animation, patches, static_rays} {}

std::vector<engine::PatchId> ReadyScene::patches_of_polygon(std::uint32_t polygon) const {
  std::vector<engine::PatchId> found;
  for (engine::PatchId p = 0; p < patches.count(); ++p)
    if (patches.facets[patches.facet_of[p]].polygon == polygon) found.push_back(p);
  return found;
}

std::vector<engine::PatchId> ReadyScene::patches_of_material(const std::string& name) const {
  std::vector<engine::PatchId> found;
  for (engine::PatchId p = 0; p < patches.count(); ++p)
    if (scene.materials[patches.facets[patches.facet_of[p]].material].name == name) found.push_back(p);
  return found;
}

bool ReadyScene::moves(engine::PatchId patch) const {
  return !animation.objects[patches.facets[patches.facet_of[patch]].object].is_static(animation.frame_count);
}

Example load_example(const std::string& folder, const std::string& json) {
  const std::filesystem::path path = std::filesystem::path(KEYLUME_SOURCE_DIR) / "api/examples" / folder;
  std::ifstream file(path / json, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  Example example;
  example.request = value_or_abort(api::parse_job_request(bytes));
  example.scene = value_or_abort(engine::load_scene(path, example.request.scene, {}, engine::refuse_texture));
  example.animation = engine::animate(example.scene, example.request);
  return example;
}

LitFrames light_frames(const ReadyScene& ready, const std::vector<engine::FrameIndex>& frames,
                       const api::LightingOptions& asked) {
  api::LightingOptions options = asked;
  options.mode = api::LightingMode::reference;
  const engine::RunHooks hooks;
  api::JobReport report;
  engine::StageClock clock(hooks, report);
  engine::Checkpoints none;
  const auto groups = value_or_abort(engine::light_directly(
      ready.lit, engine::light_groups(ready.scene, ready.animation, {}, 0), frames, options, none, clock));
  engine::KeyFrames chosen;
  chosen.keys = frames;
  engine::merge_solved(chosen);
  const auto indirect =
      value_or_abort(engine::light_indirectly(ready.lit, groups, options, chosen, none, clock));

  LitFrames lit;
  lit.indirect = indirect.irradiance_w_m2.mean();
  lit.counts = indirect.counts;
  lit.radiosity = lit.indirect;
  if (options.direct == api::DirectLight::apart) {
    lit.direct = groups[0].direct.irradiance_w_m2;
    add(lit.direct, lit.radiosity);
  }
  engine::to_radiosity(ready.lit, engine::pointers_to(groups), frames, lit.radiosity);
  return lit;
}

engine::Rgb mean_over(const ReadyScene& ready, const engine::PatchSeries& series,
                      const std::vector<engine::PatchId>& patches, std::uint32_t position) {
  double r = 0, g = 0, b = 0, area = 0;
  for (const engine::PatchId patch : patches) {
    const double a = ready.patches.area_m2[patch];
    const engine::Rgb value = series.at(patch, position);
    r += a * value.r, g += a * value.g, b += a * value.b;
    area += a;
  }
  return {static_cast<float>(r / area), static_cast<float>(g / area), static_cast<float>(b / area)};
}

}  // namespace tests
