// Boxes in a tree, for queries that say themselves which boxes they may meet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/visibility/box.h"

namespace engine {

/// Halved at the median of the longest side of the middles.
class BoxTree {
 public:
  struct Leaf {
    std::uint32_t number = 0;          ///< from 0 on, in the order of the tree
    std::uint32_t first = 0, end = 0;  ///< into order(); at most `boxes_per_leaf`
  };

  explicit BoxTree(std::span<const Box> boxes, std::uint32_t boxes_per_leaf = 1);

  /// Indices of the boxes, leaf after leaf.
  std::span<const std::uint32_t> order() const { return order_; }
  std::span<const Leaf> leaves() const { return leaves_; }

  /// Calls use(Leaf) for every leaf whose box `may_meet(Box)`, as do those of all nodes above it, in the
  /// order of the tree, as long as it answers true.
  template <class MayMeet, class Use>
  void each_leaf(MayMeet&& may_meet, Use&& use) const {
    for (std::uint32_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      if (!may_meet(node.box)) {
        n = node.beyond;
        continue;
      }
      if (node.leaf != kInner && !use(leaves_[node.leaf])) return;
      ++n;
    }
  }

 private:
  static constexpr std::uint32_t kInner = 0xffffffffu;

  /// Before its children, these one after the other; `beyond`: the node after all of them.
  struct Node {
    Box box;
    std::uint32_t beyond = 0, leaf = kInner;
  };

  void build(std::span<const Box> boxes, std::uint32_t first, std::uint32_t end);

  std::uint32_t boxes_per_leaf_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::vector<std::uint32_t> order_;
};

}  // namespace engine
