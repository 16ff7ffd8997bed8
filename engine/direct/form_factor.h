// How much of a polygon's light reaches a point, in closed form.
#pragma once

#include <span>

#include "engine/base/vec3.h"

namespace engine {

/// Form factor from the surface element at `point` with unit normal `normal` to a planar polygon, without
/// occluders, clipped at the element's horizon:
///
///     F = 1 / (2 pi) | sum_k gamma_k  n . (r_k x r_k+1) / |r_k x r_k+1| |    [-], 0 .. 1
///
/// r_k are the vectors from the point to the corners, gamma_k the angle between r_k and r_k+1. Irradiance
/// from a polygon of uniform exitance E is E F. Which side of the polygon the point is on does not matter.
/// `corners`: 3 .. 8, planar.
/// Source: Lambert, Photometria, 1760; Baum, Rushmeier & Winget, SIGGRAPH 1989.
float point_to_polygon_form_factor(Vec3 point, Vec3 normal, std::span<const Vec3> corners);

}  // namespace engine
