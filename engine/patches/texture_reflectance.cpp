#include "engine/patches/texture_reflectance.h"

#include <algorithm>

#include "engine/base/parallel.h"

namespace engine {
namespace {

bool shows_texture(const Scene& scene, const Animation& animation, std::uint32_t material) {
  const bool keyed = material < animation.reflectance.size() && !animation.reflectance[material].empty();
  return scene.materials[material].texture >= 0 && !keyed;
}

Rgb below_one(Rgb a) {
  return {std::min(a.r, kTexelMax), std::min(a.g, kTexelMax), std::min(a.b, kTexelMax)};
}

TexturePoint mix(double a, TexturePoint p, double b, TexturePoint q) {
  return {a * p.u + b * q.u, a * p.v + b * q.v};
}

/// Mean over a cell: it is one triangle, or two of the same area.
Rgb mean_over_cell(const TexturePyramid& pyramid, const FacetTexture& texture, const Facet& facet,
                   const CellCorners& cell) {
  const auto mean_of = [&](int a, int b, int c) {
    return mean_over_triangle(
        pyramid, {texture.at(facet, cell.u[a], cell.v[a]), texture.at(facet, cell.u[b], cell.v[b]),
                  texture.at(facet, cell.u[c], cell.v[c])});
  };
  if (cell.count == 3) return mean_of(0, 1, 2);
  return 0.5f * (mean_of(0, 1, 2) + mean_of(0, 2, 3));
}

/// Front and back of a cell reflect alike.
void set_facet(const TexturePyramid& pyramid, const FacetTexture& texture, const Facet& facet,
               std::vector<Rgb>& reflectance) {
  for (std::uint32_t cell = 0; cell < facet.cell_count(); ++cell) {
    const Rgb mean = mean_over_cell(pyramid, texture, facet, cell_corners(facet, cell));
    reflectance[facet.first_patch + cell] = mean;
    if (facet.both_sides) reflectance[facet.first_patch + facet.cell_count() + cell] = mean;
  }
}

}  // namespace

TexturePoint FacetTexture::at(const Facet& facet, double u, double v) const {
  if (facet.is_triangle) return mix(1, mix(1 - u - v, corners[0], u, corners[1]), v, corners[2]);
  return mix(1 - v, mix(1 - u, corners[0], u, corners[1]), v, mix(1 - u, corners[3], u, corners[2]));
}

std::array<std::uint32_t, 4> polygon_corners(const Scene& scene, const Facet& facet) {
  const Polygon& polygon = scene.polygons[facet.polygon];
  std::array<std::uint32_t, 4> found;
  found.fill(polygon.first_corner);
  for (std::size_t k = 0; k < (facet.is_triangle ? 3 : 4); ++k)
    for (std::uint32_t c = polygon.first_corner; c < polygon.first_corner + polygon.corner_count; ++c)
      if (scene.vertices[scene.corners[c]] == facet.corners[k]) {
        found[k] = c;
        break;
      }
  return found;
}

std::optional<FacetTexture> facet_texture(const Scene& scene, const Animation& animation,
                                          const Facet& facet) {
  const std::uint32_t first = scene.polygons[facet.polygon].first_corner;
  if (!shows_texture(scene, animation, facet.material) || scene.corner_uvs.empty()) return {};
  if (scene.corner_uvs[first] == kNoIndex) return {};
  FacetTexture texture{static_cast<std::uint32_t>(scene.materials[facet.material].texture), {}};
  const auto corners = polygon_corners(scene, facet);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Uv uv = scene.uvs[scene.corner_uvs[corners[k]]];
    texture.corners[k] = {uv.u, uv.v};
  }
  return texture;
}

std::vector<Rgb> texture_reflectance(const Scene& scene, const Animation& animation, const Patches& patches) {
  std::vector<TexturePyramid> pyramids(scene.textures.size());
  bool any = false;
  for (const Facet& facet : patches.facets)
    if (const auto texture = facet_texture(scene, animation, facet)) {
      any = true;
      TexturePyramid& pyramid = pyramids[texture->texture];
      if (!pyramid.finest) pyramid = build_pyramid(scene.textures[texture->texture]);
    }
  if (!any) return {};

  std::vector<Rgb> reflectance(patches.count());
  parallel_for(patches.facets.size(), [&](std::size_t f) {
    const Facet& facet = patches.facets[f];
    if (const auto texture = facet_texture(scene, animation, facet))
      return set_facet(pyramids[texture->texture], *texture, facet, reflectance);
    Rgb all = material_reflectance(scene, animation, facet.material, 0);
    if (shows_texture(scene, animation, facet.material)) all = below_one(all);
    std::fill_n(reflectance.begin() + facet.first_patch, facet.patch_count(), all);
  });
  return reflectance;
}

}  // namespace engine
