#include "engine/visibility/box_hierarchy.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace engine {
namespace {

constexpr std::uint32_t kBins = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Box kNoBox{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

/// What testing a box costs, in tests of a member.
constexpr float kBoxCost = 0.6f;

float along(Vec3 v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// Half of it.
float surface(const Box& box) {
  const Vec3 size = box.upper - box.lower;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

Vec3 twice_centre(const Box& box) {
  return box.lower + box.upper;
}

struct Split {
  int axis = -1;
  std::uint32_t bin = 0;  ///< the first on the right
  float cost = kInfinity;
};

/// Bins of one axis by (twice the) centre.
struct Bins {
  int axis;
  float lower, scale;

  std::uint32_t of(const Box& box) const {
    const float place = (along(twice_centre(box), axis) - lower) * scale;
    return std::min(static_cast<std::uint32_t>(std::max(place, 0.0f)), kBins - 1);
  }
};

class Builder {
 public:
  Builder(std::span<const Box> boxes, std::uint32_t leaf_max) : boxes_(boxes), leaf_max_(leaf_max) {
    tree_.order.resize(boxes.size());
    std::iota(tree_.order.begin(), tree_.order.end(), 0u);
  }

  BoxHierarchy build() {
    if (boxes_.empty()) return {};
    tree_.nodes.emplace_back();
    todo_.push_back({0, 0, static_cast<std::uint32_t>(boxes_.size()), 0});
    while (!todo_.empty()) {
      const Part part = todo_.back();
      todo_.pop_back();
      divide(part);
    }
    return std::move(tree_);
  }

 private:
  struct Part {
    std::uint32_t node, begin, end, depth;
  };

  const Box& box(std::uint32_t place) const { return boxes_[tree_.order[place]]; }

  void divide(const Part& part) {
    Box all = kNoBox, centres = kNoBox;
    for (std::uint32_t k = part.begin; k < part.end; ++k) {
      all = join(all, box(k));
      const Vec3 centre = twice_centre(box(k));
      centres = join(centres, {centre, centre});
    }
    BoxNode& node = tree_.nodes[part.node];
    node.lower = all.lower;
    node.upper = all.upper;
    const std::uint32_t count = part.end - part.begin;
    Split split;
    if (count > 1 && part.depth < kHierarchyDepth / 2) split = best_split(part, centres);
    const float cost = kBoxCost * 2 + split.cost / std::max(surface(all), 1e-30f);
    if (count <= leaf_max_ && (split.axis < 0 || cost >= static_cast<float>(count))) {
      node.first = part.begin;
      node.count = count;
      return;
    }
    const std::uint32_t middle = split.axis < 0 ? part.begin + count / 2 : parted(part, centres, split);
    const auto left = static_cast<std::uint32_t>(tree_.nodes.size());
    node.first = left;
    tree_.nodes.resize(left + 2);
    todo_.push_back({left, part.begin, middle, part.depth + 1});
    todo_.push_back({left + 1, middle, part.end, part.depth + 1});
  }

  static Bins bins_of(const Box& centres, int axis) {
    const float lower = along(centres.lower, axis), width = along(centres.upper, axis) - lower;
    return {axis, lower, static_cast<float>(kBins) / width};
  }

  Split best_split(const Part& part, const Box& centres) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(along(centres.upper, axis) > along(centres.lower, axis))) continue;
      const Bins bins = bins_of(centres, axis);
      std::array<Box, kBins> box_of;
      std::array<std::uint32_t, kBins> count{};
      box_of.fill(kNoBox);
      for (std::uint32_t k = part.begin; k < part.end; ++k) {
        const std::uint32_t bin = bins.of(box(k));
        box_of[bin] = join(box_of[bin], box(k));
        ++count[bin];
      }
      consider(box_of, count, axis, best);
    }
    return best;
  }

  static void consider(const std::array<Box, kBins>& box_of, const std::array<std::uint32_t, kBins>& count,
                       int axis, Split& best) {
    std::array<float, kBins> right_cost{};
    Box right = kNoBox;
    std::uint32_t on_right = 0;
    for (std::uint32_t bin = kBins - 1; bin > 0; --bin) {
      right = join(right, box_of[bin]);
      on_right += count[bin];
      right_cost[bin] = on_right > 0 ? static_cast<float>(on_right) * surface(right) : kInfinity;
    }
    Box left = kNoBox;
    std::uint32_t on_left = 0;
    for (std::uint32_t bin = 1; bin < kBins; ++bin) {
      left = join(left, box_of[bin - 1]);
      on_left += count[bin - 1];
      if (on_left == 0) continue;
      const float cost = static_cast<float>(on_left) * surface(left) + right_cost[bin];
      if (cost < best.cost) best = {axis, bin, cost};
    }
  }

  /// Both sides have members: the first and the last bin do.
  std::uint32_t parted(const Part& part, const Box& centres, const Split& split) {
    const Bins bins = bins_of(centres, split.axis);
    const auto begin = tree_.order.begin();
    const auto middle =
        std::stable_partition(begin + part.begin, begin + part.end,
                              [&](std::uint32_t member) { return bins.of(boxes_[member]) < split.bin; });
    return static_cast<std::uint32_t>(middle - begin);
  }

  const std::span<const Box> boxes_;
  const std::uint32_t leaf_max_;
  BoxHierarchy tree_;
  std::vector<Part> todo_;
};

}  // namespace

BoxHierarchy build_hierarchy(std::span<const Box> boxes, std::uint32_t leaf_max) {
  return Builder(boxes, leaf_max).build();
}

void refit(std::span<BoxNode> nodes, std::uint32_t node_base, std::span<const Box> boxes,
           std::uint32_t place_base) {
  for (std::size_t n = nodes.size(); n-- > 0;) {
    BoxNode& node = nodes[n];
    Box all = kNoBox;
    for (std::uint32_t k = 0; k < node.count; ++k) all = join(all, boxes[node.first - place_base + k]);
    for (std::uint32_t k = 0; k < 2 && node.count == 0; ++k) {
      const BoxNode& child = nodes[node.first - node_base + k];
      all = join(all, {child.lower, child.upper});
    }
    node.lower = all.lower;
    node.upper = all.upper;
  }
}

}  // namespace engine
