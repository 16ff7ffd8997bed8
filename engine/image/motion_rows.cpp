#include "engine/image/motion_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/patches/placed_facet.h"

namespace engine {
namespace {

struct PixelPoint {
  float x = 0, y = 0;  ///< [pixels]
};

/// Beyond so many pixels points on an edge are no longer exact to a small part of one.
constexpr float kExactPixels = 32768;

/// One object in the picture: per row the pixels from its leftmost to its rightmost point.
class Silhouette {
 public:
  Silhouette(std::uint32_t width, std::uint32_t height)
      : width_(static_cast<float>(width)), rows_(height, {width, 0}) {}

  void add_rect(const PixelRect& rect) {
    for (std::uint32_t y = rect.y0; y < rect.y1; ++y) add(rows_[y], rect.x0, rect.x1);
  }

  /// The rows of a convex polygon begin and end at its edges.
  void add_edge(PixelPoint a, PixelPoint b) {
    if (a.y > b.y) std::swap(a, b);
    const auto height = static_cast<float>(rows_.size());
    const float first = std::clamp(std::floor(a.y) - 1, 0.0f, height);
    const float end = std::clamp(std::floor(b.y) + 2, 0.0f, height);
    const float slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0;
    for (float y = first; y < end; ++y) {
      float from = a.x,
            to = b.x;  // of an edge that begins or ends within a pixel of the row, and of flat ones
      if (b.y - a.y > 1) {
        from = a.x + slope * (std::clamp(y - 1, a.y, b.y) - a.y);
        to = a.x + slope * (std::clamp(y + 2, a.y, b.y) - a.y);
      }
      const float left = std::clamp(std::floor(std::min(from, to)) - 1, 0.0f, width_);
      const float right = std::clamp(std::floor(std::max(from, to)) + 2, 0.0f, width_);
      add(rows_[static_cast<std::size_t>(y)], static_cast<std::uint32_t>(left),
          static_cast<std::uint32_t>(right));
    }
  }

  const PixelSpan& row(std::size_t y) const { return rows_[y]; }

 private:
  static void add(PixelSpan& row, std::uint32_t x0, std::uint32_t x1) {
    row.x0 = std::min(row.x0, x0);
    row.x1 = std::max(row.x1, x1);
  }

  float width_;
  std::vector<PixelSpan> rows_;
};

void add_facet(const Facet& facet, const Pose& pose, const PinholeCamera& camera, Silhouette& silhouette) {
  const std::size_t count = facet.is_triangle ? 3 : 4;
  std::array<Vec3, 4> points;
  std::array<PixelPoint, 4> seen;
  bool exact = true;
  for (std::size_t c = 0; c < count; ++c) {
    points[c] = transform_point(pose, facet.corners[c]);
    exact = exact && camera.project(points[c], seen[c].x, seen[c].y) &&
            std::max(std::abs(seen[c].x), std::abs(seen[c].y)) < kExactPixels;
  }
  if (!exact) return silhouette.add_rect(pixels_around(camera, std::span(points.data(), count)));
  for (std::size_t c = 0; c < count; ++c) silhouette.add_edge(seen[c], seen[(c + 1) % count]);
}

/// Puts a span among those of a row, joined with those that it touches.
void insert(PixelSpan span, std::vector<PixelSpan>& row) {
  const auto first = std::lower_bound(row.begin(), row.end(), span.x0,
                                      [](const PixelSpan& other, std::uint32_t x) { return other.x1 < x; });
  auto last = first;
  for (; last != row.end() && last->x0 <= span.x1; ++last)
    span = {std::min(span.x0, last->x0), std::max(span.x1, last->x1)};
  row.insert(row.erase(first, last), span);
}

}  // namespace

MotionRows rows_with_motion(const Patches& patches, const Animation& animation, FrameIndex frame,
                            const PinholeCamera& camera) {
  std::vector<const Pose*> poses(animation.objects.size());  // none: it rests, or is not there
  for (std::size_t o = 0; o < poses.size(); ++o)
    if (!animation.objects[o].is_static(animation.frame_count))
      for (const PlacedRange& range : placed_ranges(animation.objects[o], std::span(&frame, 1)))
        poses[o] = range.pose;
  std::vector<std::vector<std::uint32_t>> facets(poses.size());
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f)
    if (poses[patches.facets[f].object]) facets[patches.facets[f].object].push_back(f);

  MotionRows rows(camera.height);
  for (std::size_t o = 0; o < poses.size(); ++o) {
    if (facets[o].empty()) continue;
    Silhouette silhouette(camera.width, camera.height);
    for (const std::uint32_t f : facets[o]) add_facet(patches.facets[f], *poses[o], camera, silhouette);
    for (std::uint32_t y = 0; y < camera.height; ++y)
      if (silhouette.row(y).x0 < silhouette.row(y).x1) insert(silhouette.row(y), rows[y]);
  }
  return rows;
}

MotionRows whole_rows(const PinholeCamera& camera) {
  return MotionRows(camera.height, {{0, camera.width}});
}

}  // namespace engine
