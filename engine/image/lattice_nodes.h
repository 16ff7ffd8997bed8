// The nodes of a facet whose cells are quartered. Internal to engine/image.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/image/seams.h"
#include "engine/patches/patches.h"

namespace engine {

/// Nodes of one side of a facet, by their place on its lattice (see LatticePoint).
class LatticeNodes {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  explicit LatticeNodes(const Facet& facet)
      : facet_(facet), size_u_(facet.grid_u * kLatticeParts), size_v_(facet.grid_v * kLatticeParts) {}

  const Facet& facet() const { return facet_; }
  /// kNone until it is set.
  std::uint32_t& at(LatticePoint point) { return nodes_.try_emplace(key(point), kNone).first->second; }
  /// kNone where there is none.
  std::uint32_t find(LatticePoint point) const {
    const auto node = nodes_.find(key(point));
    return node == nodes_.end() ? kNone : node->second;
  }
  bool is_on_rim(LatticePoint point) const {
    return point.i == 0 || point.j == 0 ||
           (facet_.is_triangle ? point.i + point.j == size_u_ : point.i == size_u_ || point.j == size_v_);
  }
  float u_of(LatticePoint point) const { return static_cast<float>(point.i) / static_cast<float>(size_u_); }
  float v_of(LatticePoint point) const { return static_cast<float>(point.j) / static_cast<float>(size_v_); }

 private:
  static std::uint64_t key(LatticePoint point) { return std::uint64_t{point.j} << 32 | point.i; }

  const Facet& facet_;
  std::uint32_t size_u_, size_v_;
  std::unordered_map<std::uint64_t, std::uint32_t> nodes_;
};

/// Appends the nodes that lie inside an edge of a larger cell.
void append_hanging(const LatticeNodes& nodes, std::vector<HangingNode>& hanging);

}  // namespace engine
