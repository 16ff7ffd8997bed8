#include "engine/patches/texture_area.h"

#include <algorithm>
#include <cmath>

namespace engine {
namespace {

/// Rows and columns that a triangle may span for its share of texels to be affordable however thin it is.
constexpr double kSpanMax = 1024;

/// In texels of one level, y downwards.
struct Point {
  double x = 0, y = 0;
};

/// A convex polygon: a triangle that a few straight cuts have gone through.
struct Convex {
  std::uint32_t count = 0;
  Point points[8];
};

using Triangle = std::array<Point, 3>;

/// What lies on the side of `limit` where sign * (coordinate - limit) <= 0.
template <double Point::*coordinate>
Convex clipped(const Convex& polygon, double limit, double sign) {
  Convex inside;
  for (std::uint32_t k = 0; k < polygon.count; ++k) {
    const Point &a = polygon.points[k], &b = polygon.points[(k + 1) % polygon.count];
    const double da = sign * (a.*coordinate - limit), db = sign * (b.*coordinate - limit);
    if (da <= 0) inside.points[inside.count++] = a;
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const double t = da / (da - db);
      Point cut{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
      cut.*coordinate = limit;
      inside.points[inside.count++] = cut;
    }
  }
  return inside;
}

double area(const Convex& polygon) {
  double doubled = 0;
  for (std::uint32_t k = 2; k < polygon.count; ++k) {
    const Point &o = polygon.points[0], &a = polygon.points[k - 1], &b = polygon.points[k];
    doubled += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  }
  return std::abs(doubled) / 2;
}

double area(const Triangle& t) {
  return area(Convex{3, {t[0], t[1], t[2]}});
}

struct Range {
  double low = 1e300, high = -1e300;
  double length() const { return high - low; }
};

template <double Point::*coordinate>
Range range_of(const Point* points, std::size_t count) {
  Range range;
  for (std::size_t k = 0; k < count; ++k) {
    range.low = std::min(range.low, points[k].*coordinate);
    range.high = std::max(range.high, points[k].*coordinate);
  }
  return range;
}

/// Sums in double: thousands of texels.
struct Sum {
  double r = 0, g = 0, b = 0, weight = 0;
  void add(Rgb colour, double by) {
    r += by * colour.r;
    g += by * colour.g;
    b += by * colour.b;
    weight += by;
  }
  Rgb mean() const {
    return {static_cast<float>(r / weight), static_cast<float>(g / weight), static_cast<float>(b / weight)};
  }
};

Triangle in_texels(const TexturePyramid& texture, std::uint32_t level, const Triangle& plane) {
  Triangle scaled = plane;
  for (Point& p : scaled) p = {p.x * texture.width(level), p.y * texture.height(level)};
  return scaled;
}

bool is_affordable(const Triangle& t) {
  return area(t) <= kTexelsExactMax && range_of<&Point::x>(t.data(), 3).length() <= kSpanMax &&
         range_of<&Point::y>(t.data(), 3).length() <= kSpanMax;
}

/// The columns [first, end) that a convex strip, the part of a polygon in row `row`, covers whole: between
/// what is left of it at the row's upper edge and at its lower one.
struct ColumnRange {
  std::int64_t first = 0, end = 0;
};
ColumnRange whole_columns(const Convex& strip, std::int64_t row) {
  Range upper, lower;
  for (std::uint32_t k = 0; k < strip.count; ++k) {
    const Point& p = strip.points[k];
    if (p.y == double(row)) upper = {std::min(upper.low, p.x), std::max(upper.high, p.x)};
    if (p.y == double(row + 1)) lower = {std::min(lower.low, p.x), std::max(lower.high, p.x)};
  }
  if (upper.low > upper.high || lower.low > lower.high) return {};
  const ColumnRange columns{static_cast<std::int64_t>(std::ceil(std::max(upper.low, lower.low))),
                            static_cast<std::int64_t>(std::floor(std::min(upper.high, lower.high)))};
  return columns.first < columns.end ? columns : ColumnRange{};
}

/// Adds the texels of row `row`, of which the triangle covers `strip`.
void add_row(const TexturePyramid& texture, std::uint32_t level, const Convex& strip, std::int64_t row,
             Sum& sum) {
  const std::uint32_t y = wrapped(row, texture.height(level)), width = texture.width(level);
  const Range columns = range_of<&Point::x>(strip.points, strip.count);
  const ColumnRange whole = whole_columns(strip, row);
  const auto last = static_cast<std::int64_t>(std::ceil(columns.high));
  const auto area_before = [&](std::int64_t x) {
    return x >= last ? area(strip) : area(clipped<&Point::x>(strip, double(x), 1));
  };
  double before = 0;
  for (auto x = static_cast<std::int64_t>(std::floor(columns.low)); x < last; ++x) {
    const bool is_whole = x >= whole.first && x < whole.end;
    const double up_to = is_whole && x + 1 < whole.end ? before + 1 : area_before(x + 1);
    sum.add(texture.at(level, wrapped(x, width), y), is_whole ? 1 : up_to - before);
    before = up_to;
  }
}

Sum sum_over(const TexturePyramid& texture, std::uint32_t level, const Triangle& t) {
  Sum sum;
  Convex rest{3, {t[0], t[1], t[2]}};
  const Range rows = range_of<&Point::y>(t.data(), 3);
  const auto last = static_cast<std::int64_t>(std::ceil(rows.high));
  for (auto y = static_cast<std::int64_t>(std::floor(rows.low)); y < last; ++y) {
    const Convex strip = clipped<&Point::y>(rest, double(y + 1), 1);
    rest = clipped<&Point::y>(rest, double(y + 1), -1);
    if (strip.count > 2) add_row(texture, level, strip, y, sum);
  }
  return sum;
}

/// Of 8 x 8 points spread evenly in the triangle, folded from the unit square.
Rgb mean_of_points(const TexturePyramid& texture, std::uint32_t level, const Triangle& t) {
  constexpr int kSide = 8;
  Sum sum;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      double a = (i + 0.5) / kSide, b = (j + 0.5) / kSide;
      if (a + b > 1) a = 1 - a, b = 1 - b;
      const Point p{t[0].x + a * (t[1].x - t[0].x) + b * (t[2].x - t[0].x),
                    t[0].y + a * (t[1].y - t[0].y) + b * (t[2].y - t[0].y)};
      const auto x = static_cast<std::int64_t>(std::floor(p.x)),
                 y = static_cast<std::int64_t>(std::floor(p.y));
      sum.add(texture.at(level, wrapped(x, texture.width(level)), wrapped(y, texture.height(level))), 1);
    }
  return sum.mean();
}

/// Moved by whole textures so that its corners are near 0, where numbers are fine; y downwards.
Triangle near_origin(const std::array<TexturePoint, 3>& triangle) {
  const double u = std::floor(triangle[0].u), v = std::floor(triangle[0].v);
  Triangle moved;
  for (std::size_t c = 0; c < 3; ++c) moved[c] = {triangle[c].u - u, v - triangle[c].v};
  return moved;
}

}  // namespace

Rgb mean_over_triangle(const TexturePyramid& texture, const std::array<TexturePoint, 3>& triangle) {
  const Triangle plane = near_origin(triangle);
  const std::uint32_t coarsest = texture.level_count() - 1;
  std::uint32_t level = 0;
  while (level < coarsest && !is_affordable(in_texels(texture, level, plane))) ++level;
  const Triangle t = in_texels(texture, level, plane);
  if (!is_affordable(t)) return texture.at(coarsest, 0, 0);
  // Areas of the thinnest are rounding.
  const double span = range_of<&Point::x>(t.data(), 3).length() + range_of<&Point::y>(t.data(), 3).length();
  if (area(t) <= 1e-6 * span * span) return mean_of_points(texture, level, t);
  return sum_over(texture, level, t).mean();
}

}  // namespace engine
