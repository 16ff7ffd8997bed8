// Boxes along the axes.
#pragma once

#include <span>

#include "engine/base/vec3.h"

namespace engine {

/// Axis-aligned, closed.
struct Box {
  Vec3 lower, upper;
};

/// The smallest box around points.
Box box_of(std::span<const Vec3> points);
/// Around both.
inline Box join(const Box& a, const Box& b) {
  return {min(a.lower, b.lower), max(a.upper, b.upper)};
}

}  // namespace engine
