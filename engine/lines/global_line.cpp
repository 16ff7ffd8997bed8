#include "engine/lines/global_line.h"

#include <array>
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

/// Up to 16 parallel lines that enter through one face.
class Bundle {
 public:
  Bundle(const LineBox& box, std::array<float, 4> point)
      : lower_(box.lower), extent_(box.upper - box.lower), u_(point[0]), v_(point[1]) {
    const double areas[3] = {double{extent_.y} * extent_.z, double{extent_.z} * extent_.x,
                             double{extent_.x} * extent_.y};
    const BoxFace face = choose_face(areas, u_);
    a_ = (face.axis + 1) % 3;
    b_ = (face.axis + 2) % 3;
    if (face.upper) component(lower_, face.axis) += component(extent_, face.axis);
    step_u_ = step(box.bundle_m, component(extent_, a_));
    step_v_ = step(box.bundle_m, component(extent_, b_));

    const float sine = std::sqrt(point[2]), angle = 2.0f * std::numbers::pi_v<float> * point[3];
    const float cosine = std::sqrt(std::max(0.0f, 1.0f - point[2]));
    component(direction_, face.axis) = face.upper ? -cosine : cosine;
    component(direction_, a_) = sine * std::cos(angle);
    component(direction_, b_) = sine * std::sin(angle);
    far_ = 2.0f * length(extent_);
  }

  Ray line(std::uint32_t lane) const {
    Ray ray{lower_, direction_, 0, far_};
    component(ray.origin, a_) += wrapped(u_ + static_cast<float>(lane % kSide) * step_u_) * along(a_);
    component(ray.origin, b_) += wrapped(v_ + static_cast<float>(lane / kSide) * step_v_) * along(b_);
    return ray;
  }

 private:
  static constexpr std::uint32_t kSide = 4;

  /// As a share of the face; the lattice fills it at most.
  static float step(float bundle_m, float extent_m) {
    return extent_m > 0 ? std::min(bundle_m / extent_m, 1.0f / kSide) : 0.0f;
  }
  static float wrapped(float u) { return u < 1.0f ? u : u - 1.0f; }
  float along(int axis) const { return axis == 0 ? extent_.x : axis == 1 ? extent_.y : extent_.z; }

  Vec3 lower_, extent_, direction_;
  float u_, v_, step_u_ = 0, step_v_ = 0, far_ = 0;
  int a_ = 0, b_ = 0;
};

/// Of the lines of a bundle, in mean edges of patches: so far that hardly two of them meet one patch. At one
/// edge they do, the more the steeper they come, so that of what a patch is met by too much is steep: light
/// from straight ahead was 4 % too bright with 2 crossings per patch, 1.2 % with 9. At two it is not found
/// any more.
constexpr double kEdgesApart = 2;

/// 0 for few patches.
float bundle_spacing_m(const Patches& patches) {
  if (patches.count() < kPatchesForBundles) return 0;
  double area_m2 = 0;
  for (const float area : patches.area_m2) area_m2 += area;
  return static_cast<float>(kEdgesApart * std::sqrt(area_m2 / patches.count()));
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
  return {box.lower - by, box.upper + by, bundle_spacing_m(patches)};
}

double surface_m2(const LineBox& box) {
  const Vec3 size = box.upper - box.lower;
  return 2.0 * (double{size.x} * size.y + double{size.y} * size.z + double{size.z} * size.x);
}

Ray global_line(const LineBox& box, std::uint32_t line, std::uint64_t seed) {
  const bool bundled = box.bundle_m > 0;
  return Bundle(box, owen_sobol(bundled ? line / kLanes : line, seed)).line(bundled ? line % kLanes : 0);
}

void global_lines(const LineBox& box, std::uint32_t first, std::uint32_t count, std::uint64_t seed,
                  LinePacket& packet) {
  packet.clear();
  if (box.bundle_m > 0) {
    const Bundle bundle(box, owen_sobol(first / kLanes, seed));
    for (std::uint32_t lane = 0; lane < count; ++lane) packet.push(bundle.line(lane));
    return;
  }
  for (std::uint32_t k = 0; k < count; ++k) packet.push(Bundle(box, owen_sobol(first + k, seed)).line(0));
}

double expected_crossings(std::uint64_t line_count, double patch_area_m2, double box_surface_m2) {
  return 2.0 * static_cast<double>(line_count) * patch_area_m2 / box_surface_m2;
}

}  // namespace engine
