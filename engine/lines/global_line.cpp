#include "engine/lines/global_line.h"

#include <limits>
#include <numbers>

#include "engine/base/sobol.h"

namespace engine {
namespace {

void include_facet(LineBox& box, const Facet& facet, const Pose& pose) {
  const Vec3 o = facet.origin, u = facet.edge_u, v = facet.edge_v;
  for (const Vec3 corner : {o, o + u, o + v, facet.is_triangle ? o : o + u + v}) {
    const Vec3 placed = transform_point(pose, corner);
    box.lower = min(box.lower, placed);
    box.upper = max(box.upper, placed);
  }
}

/// Orthonormal tangents of the axis-aligned face number `face` (0 .. 5: -x, +x, -y, ...) are the other axes.
struct BoxFace {
  int axis;
  bool upper;
};

float& component(Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// Chooses a face by area with u in [0, 1), and stretches what is left of u to [0, 1) again.
BoxFace choose_face(const double (&areas)[3], float& u) {
  double rest = u * 2.0 * (areas[0] + areas[1] + areas[2]);
  for (int face = 0; face < 6; ++face) {
    const double area = areas[face / 2];
    if (rest < area || face == 5) {
      u = area > 0 ? static_cast<float>(std::min(rest / area, 1.0)) : 0.0f;
      return {face / 2, face % 2 == 1};
    }
    rest -= area;
  }
  return {2, true};
}

}  // namespace

LineBox line_box(const Patches& patches, const Animation& animation) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  LineBox box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (const Facet& facet : patches.facets)
    for (const PoseSpan& span : animation.objects[facet.object].spans) include_facet(box, facet, span.pose);
  if (!(box.lower.x <= box.upper.x)) return {{-1, -1, -1}, {1, 1, 1}};  // nothing is ever visible
  const float margin = 1e-3f * length(box.upper - box.lower);
  const Vec3 by{margin, margin, margin};
  return {box.lower - by, box.upper + by};
}

double surface_m2(const LineBox& box) {
  const Vec3 size = box.upper - box.lower;
  return 2.0 * (double{size.x} * size.y + double{size.y} * size.z + double{size.z} * size.x);
}

Ray global_line(const LineBox& box, std::uint32_t line, std::uint64_t seed) {
  auto [u0, u1, u2, u3] = owen_sobol(line, seed);
  const Vec3 size = box.upper - box.lower;
  const double areas[3] = {double{size.y} * size.z, double{size.z} * size.x, double{size.x} * size.y};
  const BoxFace face = choose_face(areas, u0);
  const int a = (face.axis + 1) % 3, b = (face.axis + 2) % 3;

  Ray ray;
  ray.origin = box.lower;
  Vec3 extent = size;
  component(ray.origin, face.axis) += face.upper ? component(extent, face.axis) : 0.0f;
  component(ray.origin, a) += u0 * component(extent, a);
  component(ray.origin, b) += u1 * component(extent, b);

  const float sine = std::sqrt(u2), angle = 2.0f * std::numbers::pi_v<float> * u3;
  const float cosine = std::sqrt(std::max(0.0f, 1.0f - u2));
  component(ray.direction, face.axis) = face.upper ? -cosine : cosine;
  component(ray.direction, a) = sine * std::cos(angle);
  component(ray.direction, b) = sine * std::sin(angle);
  ray.far = 2.0f * length(size);
  return ray;
}

double expected_crossings(std::uint64_t line_count, double patch_area_m2, double box_surface_m2) {
  return 2.0 * static_cast<double>(line_count) * patch_area_m2 / box_surface_m2;
}

}  // namespace engine
