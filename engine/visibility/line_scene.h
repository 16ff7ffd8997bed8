// The facets of a scene as lines meet them, sixteen lines at a time.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/visibility/box_hierarchy.h"
#include "engine/visibility/crossing.h"
#include "engine/visibility/line_packet.h"
#include "engine/visibility/packet_kernel.h"

namespace engine {

/// The crossings of a packet: those of lane k are crossings[begin[k]] .. crossings[begin[k + 1]], by
/// distance.
struct PacketCrossings {
  std::vector<MovingCrossing> crossings;
  std::array<std::uint32_t, kLanes + 1> begin{};

  std::span<const MovingCrossing> of(std::uint32_t lane) const {
    return std::span(crossings).subspan(begin[lane], begin[lane + 1] - begin[lane]);
  }
};

/// `patches` outlive it. All calls are const and may run from many threads, each with buffers of its own.
class LineScene {
 public:
  /// What `all_hits` needs while it works; reused, it allocates nothing.
  struct Buffers {
    std::vector<PacketHit> hits, sorted;
    std::vector<std::uint32_t> roots;
    std::vector<MovingHit> apart;
    TraceLists lists;
  };

  /// The facets that never move, in slots [0, 0].
  static LineScene at_rest(const Patches& patches, const Animation& animation);
  /// Those that move, at every pose they take in the slots of the window `frames` (0 .. kWindowMax).
  static LineScene moving(const Patches& patches, const Animation& animation,
                          std::span<const FrameIndex> frames);

  /// The same facets with the patches of another mesh. The tree is shared.
  LineScene of(const Patches& patches) const;

  bool empty() const { return tree_->nodes.empty(); }

  /// Every crossing between near and far. A line through an edge that two facets share crosses the surface
  /// once in every slot; ties in distance are in the order of the facets.
  void all_hits(const LinePacket& packet, Buffers& buffers, PacketCrossings& found) const;

  /// The same of what is there in some of the slots [first_slot, last_slot], with no other slots named.
  void all_hits(const LinePacket& packet, std::uint32_t first_slot, std::uint32_t last_slot, Buffers& buffers,
                PacketCrossings& found) const;

 private:
  /// A facet at a pose. 32 bytes.
  struct Item {
    std::uint32_t facet = 0;
    PatchId first_patch = 0;
    std::uint32_t back = 0;                ///< added to the number of a front: its back; 0: it has none
    std::uint32_t grid_u = 0, grid_v = 0;  ///< of a parallelogram without trees; else 0
    std::uint16_t first_slot = 0, last_slot = 0;
  };
  /// The facets of an object at a pose.
  struct Block {
    std::uint32_t root = 0;
    std::uint32_t first_slot = 0, last_slot = 0;
  };

  explicit LineScene(const Patches& patches) : patches_(&patches) {}
  void set_centre(const Animation& animation);
  void add_block(std::span<const PlacedFacet> facets, const BoxHierarchy& shape);
  void number_patches(Item& item) const;
  void join_blocks();
  void list_hits(std::uint32_t first_slot, std::uint32_t last_slot, Buffers& buffers,
                 PacketCrossings& found) const;
  void sort_by_lane(Buffers& buffers, PacketCrossings& found) const;
  void list_lane(std::span<const PacketHit> hits, std::uint32_t first_slot, std::uint32_t last_slot,
                 Buffers& buffers, PacketCrossings& found) const;
  bool is_before(const PacketHit& a, const PacketHit& b) const;
  bool has_ties(std::span<const PacketHit> hits) const;
  MovingHit hit_of(const PacketHit& hit) const;
  MovingCrossing crossing_of(const PacketHit& hit) const;

  const Patches* patches_;
  std::shared_ptr<FacetTree> tree_ = std::make_shared<FacetTree>();
  std::vector<Item> items_;  ///< [place in tree_.tests]
  std::vector<Block> blocks_;
  std::uint32_t root_ = 0;
  Vec3 margin_;  ///< boxes are larger by this than what they hold: many times what rounding comes to  [m]
};

}  // namespace engine
