#include "engine/direct/tile_view.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// A light whose middle is so many of its radii away contributes much the same with all its points.
constexpr float kSmallRadii = 2;

float squared_distance(Vec3 point, Vec3 lower, Vec3 upper) {
  const Vec3 outside = max(max(lower - point, point - upper), Vec3{});
  return dot(outside, outside);
}

}  // namespace

bool TileView::look(const PlacedTile& tile, const LightPose& light, float reach_m) {
  if (!begin(tile, light, reach_m)) return false;
  measure(0, tile.count());
  return true;
}

bool TileView::look_from(const PlacedTile& tile, std::uint32_t k, const LightPose& light, float reach_m) {
  if (!begin(tile, light, reach_m)) return false;
  measure(k, k + 1);
  return true;
}

bool TileView::begin(const PlacedTile& tile, const LightPose& light, float reach_m) {
  tile_ = &tile;
  light_ = &light;
  arrivals_.emplace(tile.facet(), light, reach_m);
  if (!arrivals_->possible()) return false;
  views_.resize(tile.count());
  means_.resize(tile.count());
  factors_.resize(tile.points().count);
  if (light.source) return true;
  const PlacedFacet& at = tile.facet().placed;
  const auto corners = light.facet.polygon();
  polygon_.emplace(at.origin, at.normal, corners, light.facet.placed.normal);
  lower_ = upper_ = corners[0];
  above_horizon_ = true;
  for (const Vec3 corner : corners) {
    lower_ = min(lower_, corner);
    upper_ = max(upper_, corner);
    above_horizon_ = above_horizon_ && dot(at.normal, corner - at.origin) > 0;
  }
  return true;
}

void TileView::measure(std::uint32_t first, std::uint32_t end) {
  const CellRule& rule = tile_->rule();
  const std::size_t from = std::size_t{first} * rule.points, count = std::size_t{end - first} * rule.points;
  const PointArrays all = tile_->points(), points{all.x + from, all.y + from, all.z + from, count};
  float* factors = factors_.data() + from;
  if (!light_->source) {
    polygon_->form_factors(points, factors);
  } else {
    for (std::size_t k = 0; k < count; ++k)
      factors[k] = arrivals_->source_factor({points.x[k], points.y[k], points.z[k]});
  }
  for (std::uint32_t k = first; k < end; ++k, factors += rule.points) {
    views_[k] = light_->source ? view_of_source(k) : view_of(k);
    means_[k] = 0;
    for (std::uint32_t p = 0; p < rule.points; ++p) means_[k] += rule.weight[p] * factors[p];
    if (views_[k] == View::apart && !(means_[k] > 0)) views_[k] = View::dark;
  }
}

View TileView::view_of(std::uint32_t k) const {
  const Vec3 middle = tile_->middle(k);
  const float radius = tile_->radius_m(k), far = kApartRadii * radius;
  const float before = dot(light_->facet.placed.normal, middle - light_->facet.placed.origin);
  if (before < -radius) return View::dark;
  if (before <= radius) return View::close;  // a part of the cell may be behind the light
  return squared_distance(middle, lower_, upper_) > far * far ? View::apart : View::close;
}

View TileView::view_of_source(std::uint32_t k) const {
  const SourceMotion& source = *light_->source;
  if (source.type == api::LightType::directional) return View::apart;
  const Vec3 apart = tile_->middle(k) - light_->position;
  const float radius = tile_->radius_m(k), distance = length(apart);
  if (!(distance > kApartRadii * radius)) return View::close;
  if (source.type == api::LightType::point) return View::apart;
  if (largest_spot_share(source, light_->direction, apart, radius) <= 0) return View::dark;
  const float cosine = std::clamp(dot(light_->direction, apart) / distance, -1.0f, 1.0f);
  constexpr float kRounding = 1e-3f;
  const float farthest = std::acos(cosine) + std::asin(radius / distance) + kRounding;
  return std::cos(farthest) >= source.inner_cosine ? View::apart : View::close;  // no falloff across it
}

std::array<float, 4> TileView::at_corners(std::uint32_t k) const {
  if (tile_->rule().points != 4) return {1, 1, 1, 1};
  constexpr float kHere = 1.36602540f, kThere = -0.366025404f;  // (1 +- sqrt 3) / 2: the line through both
  const float* f = factors_.data() + std::size_t{k} * 4;
  const float low_0 = kHere * f[0] + kThere * f[1], low_1 = kThere * f[0] + kHere * f[1];
  const float high_0 = kHere * f[2] + kThere * f[3], high_1 = kThere * f[2] + kHere * f[3];
  const float least = 0.1f * means_[k];
  return {std::max(least, kHere * low_0 + kThere * high_0), std::max(least, kHere * low_1 + kThere * high_1),
          std::max(least, kThere * low_0 + kHere * high_0), std::max(least, kThere * low_1 + kHere * high_1)};
}

bool TileView::is_small(std::uint32_t k) const {
  if (light_->source || (light_->facet.is_triangle && !above_horizon_)) return false;
  const Vec3 apart = light_->ball.middle - tile_->middle(k);
  const float far = kSmallRadii * light_->ball.radius_m;
  return dot(apart, apart) > far * far;
}

}  // namespace engine
