#include "engine/visibility/box_tree.h"

#include <algorithm>
#include <numeric>

namespace engine {
namespace {

Vec3 middle(const Box& box) {
  return 0.5f * (box.lower + box.upper);
}

}  // namespace

Box box_of(std::span<const Vec3> points) {
  Box box{points[0], points[0]};
  for (const Vec3 point : points) box = {min(box.lower, point), max(box.upper, point)};
  return box;
}

BoxTree::BoxTree(std::span<const Box> boxes, std::uint32_t boxes_per_leaf)
    : boxes_per_leaf_(boxes_per_leaf), order_(boxes.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!boxes.empty()) build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
}

void BoxTree::build(std::span<const Box> boxes, std::uint32_t first, std::uint32_t end) {
  Box around = boxes[order_[first]], middles{middle(around), middle(around)};
  for (std::uint32_t k = first; k < end; ++k) {
    const Vec3 m = middle(boxes[order_[k]]);
    around = join(around, boxes[order_[k]]);
    middles = join(middles, {m, m});
  }
  const std::size_t node = nodes_.size();
  nodes_.push_back({around});
  if (end - first <= boxes_per_leaf_) {
    nodes_[node].leaf = static_cast<std::uint32_t>(leaves_.size());
    leaves_.push_back({nodes_[node].leaf, first, end});
  } else {
    const Vec3 size = middles.upper - middles.lower;
    float Vec3::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3::x
                              : size.y >= size.z                   ? &Vec3::y
                                                                   : &Vec3::z;
    const std::uint32_t half = first + (end - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const float of_a = middle(boxes[a]).*axis, of_b = middle(boxes[b]).*axis;
                       return of_a != of_b ? of_a < of_b : a < b;
                     });
    build(boxes, first, half);
    build(boxes, half, end);
  }
  nodes_[node].beyond = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace engine
