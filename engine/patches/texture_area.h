// The mean of a texture over a triangle of its plane.
#pragma once

#include <array>

#include "engine/patches/texture_pyramid.h"

namespace engine {

/// A point of a texture's plane, see Uv: in single precision the corners of small cells would be one.
struct TexturePoint {
  double u = 0, v = 0;
};

/// Mean over a triangle, the texture repeating without end; a texel is a rectangle of one colour.
///
/// Exact, but for rounding, for a triangle over up to kTexelsExactMax texels. Over more, blocks of 2^k x 2^k
/// texels are taken as one colour, k as small as that number of blocks allows: then some 2 % of the area is
/// in blocks on the rim that count with their whole mean instead of that of their part inside, and the error
/// is below 2 % of the contrast inside such blocks, mostly far below. Of a triangle over more than that many
/// whole textures it is the mean of the texture.
///
/// A triangle without area (its corners in one point or line, as where a model takes single colours out of a
/// palette) has the mean of points spread over it.
Rgb mean_over_triangle(const TexturePyramid& texture, const std::array<TexturePoint, 3>& triangle);

inline constexpr double kTexelsExactMax = 4'096;

}  // namespace engine
