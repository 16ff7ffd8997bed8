#include "engine/scene/corner_attributes.h"

#include <algorithm>
#include <map>

#include "engine/scene/names.h"

namespace engine {
namespace {

template <class T>
void free_memory(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

/// Takes the index of all corners of a polygon where one of them has none that is `usable`.
template <class T, class Usable>
void settle(const std::vector<Polygon>& polygons, std::vector<std::uint32_t>& indices, std::vector<T>& values,
            const Usable& usable) {
  bool any = false;
  for (const Polygon& polygon : polygons) {
    if (indices.empty()) break;
    const auto begin = indices.begin() + polygon.first_corner, end = begin + polygon.corner_count;
    const bool all =
        std::all_of(begin, end, [&](std::uint32_t i) { return i != kNoIndex && usable(values[i]); });
    if (!all) std::fill(begin, end, kNoIndex);
    any |= all;
  }
  if (any) return;
  free_memory(indices);
  free_memory(values);
}

void warn_about_bare_polygons(Scene& scene) {
  std::map<std::uint32_t, std::size_t> bare;  // material -> polygons
  for (const Polygon& polygon : scene.polygons)
    if (scene.materials[polygon.material].texture >= 0 &&
        (scene.corner_uvs.empty() || scene.corner_uvs[polygon.first_corner] == kNoIndex))
      ++bare[polygon.material];
  for (const auto& [material, count] : bare)
    scene.warnings.push_back("scene.obj: " + std::to_string(count) + (count == 1 ? " polygon" : " polygons") +
                             " of material " + excerpt(scene.materials[material].name) +
                             " without texture coordinates: the mean of the texture is used there");
}

}  // namespace

void settle_corner_attributes(Scene& scene) {
  if (scene.textures.empty()) free_memory(scene.corner_uvs);
  settle(scene.polygons, scene.corner_uvs, scene.uvs, [](Uv) { return true; });
  settle(scene.polygons, scene.corner_normals, scene.normals, [](Vec3 n) { return n != Vec3{}; });
  warn_about_bare_polygons(scene);
}

}  // namespace engine
