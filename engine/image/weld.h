// Finds points that coincide. Internal to engine/image.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/patches/patches.h"

namespace engine {

struct WeldPoint {
  Vec3 position;  ///< object space  [m]
  Vec3 normal;    ///< unit, of the side
  std::uint32_t object = 0, material = 0;
};

class Welder {
 public:
  /// Points coincide within some roundings of the largest coordinate of their object.
  explicit Welder(const Patches& patches);

  /// The node of an earlier point that coincides with this one and has its object, material and normal
  /// (within 1 degree); else `new_node`, which this point then stands for.
  std::uint32_t node_at(const WeldPoint& point, std::uint32_t new_node);

 private:
  /// A cube of an object's space and a material: where many objects are in one place, as where each has its
  /// own origin, they share no list.
  struct Cell {
    std::array<std::int64_t, 3> at{};
    std::uint32_t object = 0, material = 0;
    friend bool operator==(const Cell&, const Cell&) = default;
  };
  struct CellHash {
    std::size_t operator()(const Cell& cell) const;
  };
  struct Seen {
    WeldPoint point;
    std::uint32_t node = 0;
    std::uint32_t next = 0;  ///< in the same cell, or kNone
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  Cell cell_at(const WeldPoint& point, Vec3 position) const;
  std::uint32_t find(const Cell& cell, const WeldPoint& point) const;

  std::vector<float> tolerance_m_;  ///< [object]
  std::vector<Seen> seen_;
  std::unordered_map<Cell, std::uint32_t, CellHash> first_in_cell_;
};

}  // namespace engine
