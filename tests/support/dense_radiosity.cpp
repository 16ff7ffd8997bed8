#include "tests/support/dense_radiosity.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <utility>

#include "engine/base/parallel.h"
#include "tests/support/visible_polygon.h"

namespace tests {
namespace {

using engine::FrameIndex;
using engine::PatchId;

/// Nearer to its plane than this, a polygon hides and shows nothing.
constexpr double kFlat_m = 1e-7;

Point as_point(engine::Vec3 v) {
  return {v.x, v.y, v.z};
}

Point placed(const engine::Pose& pose, const Point& p) {
  Point out;
  for (int i = 0; i < 3; ++i)
    out[i] = pose.m[i][0] * p[0] + pose.m[i][1] * p[1] + pose.m[i][2] * p[2] + pose.m[i][3];
  return out;
}

struct Surface {
  PointPolygon corners;  ///< counter-clockwise seen from the side it faces; empty: not there
  Point normal{};
  std::uint32_t facet = 0;
};

Surface surface_of(PointPolygon corners, std::uint32_t facet) {
  Point normal = cross(corners[1] - corners[0], corners.back() - corners[0]);
  normal = (1 / std::sqrt(dot(normal, normal))) * normal;
  return {std::move(corners), normal, facet};
}

/// The world of one frame.
struct World {
  std::vector<Surface> patches;  ///< [patch]
  std::vector<Surface> facets;   ///< those that are there

  World(const ReadyScene& ready, FrameIndex frame) : patches(ready.patches.count()) {
    for (std::uint32_t f = 0; f < ready.patches.facets.size(); ++f) add_facet(ready, frame, f);
  }

 private:
  void add_facet(const ReadyScene& ready, FrameIndex frame, std::uint32_t index) {
    const engine::Facet& facet = ready.patches.facets[index];
    if (facet.is_triangle) {
      std::cerr << "dense form factors are of parallelograms only\n";
      std::abort();
    }
    const auto& spans = ready.animation.objects[facet.object].spans;
    const auto span = std::find_if(spans.begin(), spans.end(),
                                   [&](const auto& s) { return s.first <= frame && frame <= s.last; });
    if (span == spans.end()) return;
    const Point origin = as_point(facet.origin), u = as_point(facet.edge_u), v = as_point(facet.edge_v);
    const auto at = [&](double s, double t) { return placed(span->pose, origin + s * u + t * v); };
    facets.push_back(surface_of({at(0, 0), at(1, 0), at(1, 1), at(0, 1)}, index));
    for (PatchId p = facet.first_patch; p < facet.first_patch + facet.patch_count(); ++p) {
      const std::uint32_t cell = ready.patches.cell_of(p);
      const double u0 = cell % facet.grid_u, v0 = cell / facet.grid_u;
      const double nu = facet.grid_u, nv = facet.grid_v;
      PointPolygon corners{at(u0 / nu, v0 / nv), at((u0 + 1) / nu, v0 / nv), at((u0 + 1) / nu, (v0 + 1) / nv),
                           at(u0 / nu, (v0 + 1) / nv)};
      if (ready.patches.is_back(p)) std::reverse(corners.begin(), corners.end());
      patches[p] = surface_of(std::move(corners), index);
    }
  }
};

PointPolygon relative_to(const Point& origin, const Surface& surface) {
  PointPolygon corners = surface.corners;
  for (Point& corner : corners) corner = corner - origin;
  return corners;
}

/// What stands above the horizon of one point of a receiver, seen from there.
class PointOfView {
 public:
  PointOfView(const World& world, const Surface& receiver, const Point& at)
      : world_(world), normal_(receiver.normal), at_(at) {
    for (const Surface& facet : world.facets) {
      const double off_plane = dot(facet.normal, facet.corners[0] - at);
      const bool above = std::any_of(facet.corners.begin(), facet.corners.end(), [&](const Point& corner) {
        return dot(normal_, corner - at) > kFlat_m;
      });
      if (above && std::abs(off_plane) > kFlat_m)
        blockers_.push_back({facet.facet, Shadow(relative_to(at, facet))});
    }
  }

  /// Form factor to what of patch `sender` is seen.
  double form_factor(PatchId sender) const {
    const Surface& surface = world_.patches[sender];
    if (surface.corners.empty() || dot(surface.normal, at_ - surface.corners[0]) <= kFlat_m) return 0;
    PointPolygon whole = clipped(relative_to(at_, surface), normal_, 0);
    if (whole.empty()) return 0;
    std::vector<PointPolygon> pieces{std::move(whole)};
    for (const auto& [facet, shadow] : blockers_)
      if (facet != surface.facet) shadow.subtract_from(pieces);
    double sum = 0;
    for (const PointPolygon& piece : pieces) sum += lambert(piece, normal_);
    return sum;
  }

 private:
  const World& world_;
  Point normal_, at_;
  std::vector<std::pair<std::uint32_t, Shadow>> blockers_;
};

using Row = std::vector<double>;                     ///< [sender]
using Colours = std::vector<std::array<double, 3>>;  ///< [patch][channel]

/// A part of a receiver in its own coordinates, 0 .. 1.
struct Part {
  double s = 0, t = 0, size = 1;
};

/// The form factors of a part of `receiver`, times its share of the area.
Row integrate(const World& world, const Surface& receiver, const Part& part) {
  constexpr std::array<double, 3> kAt{0.11270166537925831, 0.5, 0.88729833462074169};
  constexpr std::array<double, 3> kWeight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const Point u = receiver.corners[1] - receiver.corners[0], v = receiver.corners[3] - receiver.corners[0];
  Row row(world.patches.size());
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const double s = part.s + kAt[i] * part.size, t = part.t + kAt[j] * part.size;
      const double weight = kWeight[i] * kWeight[j] * part.size * part.size;
      const PointOfView view(world, receiver, receiver.corners[0] + s * u + t * v);
      for (PatchId sender = 0; sender < row.size(); ++sender)
        row[sender] += weight * view.form_factor(sender);
    }
  return row;
}

void add(Row& sum, const Row& row) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += row[k];
}

/// Quarters parts of one receiver until it makes no difference.
class Refinement {
 public:
  Refinement(const World& world, const Surface& receiver, const Colours& senders_w_m2, double tolerance_w_m2)
      : world_(world), receiver_(receiver), senders_(senders_w_m2), tolerance_(tolerance_w_m2) {}

  void run(Row& total) { refine({}, integrate(world_, receiver_, {}), 0, total); }
  const std::array<double, 3>& error_w_m2() const { return error_; }

 private:
  static constexpr int kDepthMin = 2, kDepthMax = 7;

  void refine(const Part& part, const Row& whole, int depth, Row& total) {
    const double half = part.size / 2;
    std::array<Part, 4> parts;
    std::array<Row, 4> rows;
    Row sum(whole.size());
    for (std::size_t k = 0; k < 4; ++k) {
      parts[k] = {part.s + half * static_cast<double>(k % 2), part.t + half * static_cast<double>(k / 2),
                  half};
      rows[k] = integrate(world_, receiver_, parts[k]);
      add(sum, rows[k]);
    }
    const std::array<double, 3> change = arriving(sum, whole);
    if (depth + 1 >= kDepthMin &&
        (std::max({change[0], change[1], change[2]}) < tolerance_ || depth + 1 == kDepthMax)) {
      add(total, sum);
      for (std::size_t c = 0; c < 3; ++c) error_[c] += change[c];
      return;
    }
    for (std::size_t k = 0; k < 4; ++k) refine(parts[k], rows[k], depth + 1, total);
  }

  /// | what arrives by `one` less what arrives by `other` |
  std::array<double, 3> arriving(const Row& one, const Row& other) const {
    std::array<double, 3> sum{};
    for (std::size_t k = 0; k < one.size(); ++k)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += (one[k] - other[k]) * senders_[k][c];
    return {std::abs(sum[0]), std::abs(sum[1]), std::abs(sum[2])};
  }

  const World& world_;
  const Surface& receiver_;
  const Colours& senders_;
  double tolerance_;
  std::array<double, 3> error_{};
};

/// Solves matrix x = right, both changed, with pivots from the rows.
std::vector<double> eliminated(std::vector<double> matrix, std::vector<double> right) {
  const std::size_t n = right.size();
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return matrix[i * n + j]; };
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    if (pivot != k) {
      std::swap_ranges(&at(k, 0), &at(k, 0) + n, &at(pivot, 0));
      std::swap(right[k], right[pivot]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = at(i, k) / at(k, k);
      if (factor == 0) continue;
      for (std::size_t j = k; j < n; ++j) at(i, j) -= factor * at(k, j);
      right[i] -= factor * right[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) right[k] -= at(k, j) * right[j];
    right[k] /= at(k, k);
  }
  return right;
}

constexpr std::array<float engine::Rgb::*, 3> kChannels{&engine::Rgb::r, &engine::Rgb::g, &engine::Rgb::b};

std::uint32_t material_of(const ReadyScene& ready, PatchId patch) {
  return ready.patches.facets[ready.patches.facet_of[patch]].material;
}

Colours reflectance_of(const ReadyScene& ready, FrameIndex frame) {
  Colours rho(ready.patches.count());
  for (PatchId p = 0; p < rho.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c)
      rho[p][c] = engine::material_reflectance(ready.scene, ready.animation, material_of(ready, p), frame).*
                  kChannels[c];
  return rho;
}

Colours exitance_of(const ReadyScene& ready, FrameIndex frame) {
  Colours exitance(ready.patches.count());
  for (PatchId p = 0; p < exitance.size(); ++p)
    for (std::size_t c = 0; c < 3 && !ready.patches.is_back(p); ++c)
      exitance[p][c] = ready.animation.emission.exitance(material_of(ready, p), frame).*kChannels[c];
  return exitance;
}

/// x = source + rho F x
Colours solved(const FormFactors& factors, const Colours& rho, const Colours& source) {
  const std::size_t n = factors.patch_count;
  Colours found(n);
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<double> matrix(n * n), right(n);
    for (PatchId i = 0; i < n; ++i) {
      for (PatchId j = 0; j < n; ++j) matrix[i * n + j] = (i == j) - rho[i][c] * factors.at(i, j);
      right[i] = source[i][c];
    }
    right = eliminated(std::move(matrix), std::move(right));
    for (std::size_t i = 0; i < n; ++i) found[i][c] = right[i];
  }
  return found;
}

/// F B
Colours arriving_from(const FormFactors& factors, const Colours& senders) {
  Colours arriving(senders.size());
  for (PatchId i = 0; i < senders.size(); ++i)
    for (PatchId j = 0; j < senders.size(); ++j)
      for (std::size_t c = 0; c < 3; ++c) arriving[i][c] += factors.at(i, j) * senders[j][c];
  return arriving;
}

double mean_of(const Colours& values) {
  double sum = 0;
  for (const auto& value : values) sum += std::max({value[0], value[1], value[2]});
  return sum / static_cast<double>(values.size());
}

}  // namespace

FormFactors dense_form_factors(const ReadyScene& ready, FrameIndex frame, unsigned parts) {
  const World world(ready, frame);
  FormFactors factors{ready.patches.count(), {}};
  factors.values.resize(std::size_t{factors.patch_count} * factors.patch_count);
  engine::parallel_for(factors.patch_count, [&](std::size_t p) {
    if (world.patches[p].corners.empty()) return;
    Row row(factors.patch_count);
    const double size = 1.0 / parts;
    for (unsigned i = 0; i < parts; ++i)
      for (unsigned j = 0; j < parts; ++j)
        add(row, integrate(world, world.patches[p], {i * size, j * size, size}));
    std::copy(row.begin(), row.end(), &factors.values[p * factors.patch_count]);
  });
  return factors;
}

DenseRadiosity dense_radiosity(const ReadyScene& ready, FrameIndex frame, double tolerance) {
  const Colours rho = reflectance_of(ready, frame), exitance = exitance_of(ready, frame);
  FormFactors factors = dense_form_factors(ready, frame, 1);
  const Colours first = solved(factors, rho, exitance);
  const double tolerance_w_m2 = tolerance * mean_of(arriving_from(factors, first));
  const World world(ready, frame);
  Colours error(first.size());
  engine::parallel_for(first.size(), [&](std::size_t p) {
    if (world.patches[p].corners.empty()) return;
    Refinement refinement(world, world.patches[p], first, tolerance_w_m2);
    Row row(first.size());
    refinement.run(row);
    std::copy(row.begin(), row.end(), &factors.values[p * first.size()]);
    for (std::size_t c = 0; c < 3; ++c) error[p][c] = rho[p][c] * refinement.error_w_m2()[c];
  });
  return {solved(factors, rho, exitance), solved(factors, rho, error)};
}

}  // namespace tests
