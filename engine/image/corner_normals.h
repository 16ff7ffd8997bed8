// The normals that a surface is shaded by, where they are not those of its facets: curved things made of flat
// pieces. They decide which nodes are one (see ShadingMesh) and nothing else: light sees the flat pieces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/patches/patches.h"

namespace engine {

/// Unit, on the front's side of the facet, in the order of Facet::corners.
using CornerNormals = std::array<Vec3, 4>;

/// [facet], from the normals of the OBJ: turned to the front's side where they point away from it, the
/// facet's own where the file gives the polygon none. Empty where it gives none at all.
std::vector<CornerNormals> corner_normals(const Scene& scene, const Patches& patches);

/// The front's normal at a point of facet `facet_index`: joined linearly (of a parallelogram bilinearly) from
/// its corners' and of unit length. `of_facets`: [facet], or empty where every facet is flat.
Vec3 shading_normal(const Patches& patches, std::span<const CornerNormals> of_facets,
                    std::uint32_t facet_index, float u, float v);

}  // namespace engine
