#include "engine/image/textured_view.h"

#include <algorithm>
#include <cmath>

#include "engine/image/texture_filter.h"
#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

/// Reflectance from which on a patch counts fully.
constexpr float kFullWeight = 0.01f;

Rgb divided(Rgb a, Rgb b) {
  return {a.r / b.r, a.g / b.g, a.b / b.b};
}

Rgb at_least(Rgb a, float low) {
  return {std::max(a.r, low), std::max(a.g, low), std::max(a.b, low)};
}

/// w of a patch that shows a texture, one elsewhere.
Rgb weight_of(const TexturedView& view, PatchId patch) {
  if (!view.is_textured(view.patches.facet_of[patch])) return {1, 1, 1};
  const Rgb rho = view.patches.texture_reflectance[patch];
  return divided(rho, at_least(rho, kFullWeight));
}

PatchSeries weights(const TexturedView& view) {
  PatchSeries series(view.patches.count(), 1);
  for (PatchId patch = 0; patch < series.patch_count; ++patch) series.at(patch, 0) = weight_of(view, patch);
  return series;
}

/// w (B - E) / rho of the patches that show a texture, B elsewhere.
PatchSeries weighted_irradiance(const TexturedView& view, const PatchSeries& radiosity_w_m2,
                                std::uint32_t first_column, std::span<const FrameIndex> frames) {
  const auto frame_count = static_cast<std::uint32_t>(frames.size());
  PatchSeries series(radiosity_w_m2.patch_count, frame_count);
  for (PatchId patch = 0; patch < series.patch_count; ++patch) {
    const Rgb* from = radiosity_w_m2.row(patch) + first_column;
    std::copy_n(from, frame_count, series.row(patch));
    const std::uint32_t facet = view.patches.facet_of[patch];
    if (!view.is_textured(facet)) continue;
    const Rgb divisor = at_least(view.patches.texture_reflectance[patch], kFullWeight);
    const bool is_back = view.patches.is_back(patch);
    for (std::uint32_t f = 0; f < frame_count; ++f) {
      const Rgb exitance =
          is_back ? Rgb{} : view.animation.emission.exitance(view.patches.facets[facet].material, frames[f]);
      series.at(patch, f) = divided(at_least(series.at(patch, f) - exitance, 0), divisor);
    }
  }
  return series;
}

void lay_out_textures(const Scene& scene, TexturedView& view) {
  view.pyramids.resize(scene.textures.size());
  for (const Facet& facet : view.patches.facets) {
    const auto texture = facet_texture(scene, view.animation, facet);
    view.facet_texture_of.push_back(texture ? static_cast<std::uint32_t>(view.facet_textures.size())
                                            : kNoIndex);
    if (!texture) continue;
    view.facet_textures.push_back(*texture);
    TexturePyramid& pyramid = view.pyramids[texture->texture];
    if (!pyramid.finest) pyramid = build_pyramid(scene.textures[texture->texture]);
  }
}

const Pose& pose_in(const ObjectMotion& motion, FrameIndex frame) {
  const auto after = std::upper_bound(motion.spans.begin(), motion.spans.end(), frame,
                                      [](FrameIndex f, const PoseSpan& span) { return f < span.first; });
  return std::prev(after)->pose;
}

/// Changes of (u, v) on a facet while the picture moves by one pixel.
struct Drift {
  float u = 0, v = 0;
};

/// With P = o + t d on a plane of normal n, and d moving by e: dP = t (e - d (n.e) / (n.d)).
Drift drift_on(const PlacedFacet& facet, const TexturedHit& hit, Vec3 turn) {
  const Vec3 normal = cross(facet.edge_u, facet.edge_v), d = hit.ray.direction;
  const Vec3 moved = hit.at.distance * (turn - (dot(normal, turn) / dot(normal, d)) * d);
  const float square = dot(normal, normal);
  return {dot(moved, cross(facet.edge_v, normal)) / square, dot(moved, cross(normal, facet.edge_u)) / square};
}

}  // namespace

std::unique_ptr<TexturedView> make_textured_view(const Scene& scene, const Animation& animation,
                                                 const Patches& patches, const ShadingMesh& mesh) {
  if (patches.texture_reflectance.empty()) return nullptr;
  auto view = std::make_unique<TexturedView>(TexturedView{animation, patches, mesh, {}, {}, {}, {}, {}});
  lay_out_textures(scene, *view);
  for (std::uint32_t node = 0; node < mesh.node_count; ++node) {
    const PatchId patch = mesh.patches_around[mesh.first_patch[node]];
    view->shows_irradiance.push_back(view->is_textured(patches.facet_of[patch]));
  }
  std::vector<std::vector<Rgb>> of_nodes(1);
  node_radiosity(
      mesh, patches, weights(*view), 0, [] { return false; }, of_nodes);
  view->weight = std::move(of_nodes[0]);
  return view;
}

bool textured_node_values(const TexturedView& view, const Uncovered& uncovered,
                          const PatchSeries& radiosity_w_m2, std::uint32_t first_column,
                          std::span<const FrameIndex> frames, const std::function<bool()>& stop_requested,
                          std::span<std::vector<Rgb>> values_w_m2) {
  const auto count = static_cast<std::uint32_t>(values_w_m2.size());
  const PatchSeries block = weighted_irradiance(view, radiosity_w_m2, first_column, frames);
  if (!node_radiosity(view.mesh, view.patches, block, 0, stop_requested, values_w_m2)) return false;
  const auto irradiance = [](float sum, float weight) { return weight > 0 ? sum / weight : 0; };
  for (std::uint32_t f = 0; f < count; ++f) {
    std::vector<Rgb>& values = values_w_m2[f];
    for (std::uint32_t node = 0; node < view.mesh.node_count; ++node)
      if (const Rgb w = view.weight[node]; view.shows_irradiance[node])
        values[node] = {irradiance(values[node].r, w.r), irradiance(values[node].g, w.g),
                        irradiance(values[node].b, w.b)};
  }
  show_uncovered(
      uncovered, view.mesh, view.patches, block, 0, [&](PatchId patch) { return weight_of(view, patch); },
      values_w_m2);
  for (std::uint32_t f = 0; f < count; ++f) {
    std::vector<Rgb>& values = values_w_m2[f];
    const auto& exitance = view.animation.emission.exitance_w_m2;
    for (std::uint32_t material = 0; material < exitance.size(); ++material)
      values.push_back(view.animation.emission.exitance(material, frames[f]));
  }
  return true;
}

Rgb reflectance_in_sample(const TexturedView& view, const TexturedHit& hit, const PinholeCamera& camera,
                          std::uint32_t samples_per_pixel) {
  const Facet& facet = view.patches.facets[hit.at.facet];
  const FacetTexture& texture = view.facet_textures[view.facet_texture_of[hit.at.facet]];
  const PlacedFacet placed = place(facet, pose_in(view.animation.objects[facet.object], hit.frame));
  const float u = hit.at.u, v = hit.at.v;
  // Along u and v, of the texture's plane.
  const TexturePoint left = texture.at(facet, 0, v), right = texture.at(facet, 1, v);
  const TexturePoint low = texture.at(facet, u, 0), high = texture.at(facet, u, 1);
  const float spacing = 1 / std::sqrt(static_cast<float>(samples_per_pixel));
  const auto step = [&](Vec3 turn) {
    const Drift drift = drift_on(placed, hit, spacing * turn);
    return TexturePoint{drift.u * (right.u - left.u) + drift.v * (high.u - low.u),
                        drift.u * (right.v - left.v) + drift.v * (high.v - low.v)};
  };
  const TextureFootprint footprint{step((2 / static_cast<float>(camera.width)) * camera.right),
                                   step((-2 / static_cast<float>(camera.height)) * camera.upward)};
  return filtered_reflectance(view.pyramids[texture.texture], texture.at(facet, u, v), footprint);
}

}  // namespace engine
