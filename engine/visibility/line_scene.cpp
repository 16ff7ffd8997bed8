#include "engine/visibility/line_scene.h"

#include <algorithm>
#include <optional>

#include "engine/visibility/coincident.h"
#include "engine/visibility/scene_facets.h"

namespace engine {
namespace {

/// Of so few facets every line is tested against all.
constexpr std::uint32_t kFacetsTestedByAll = 24;
constexpr std::uint32_t kLeafMax = 4;

std::uint32_t leaf_max(std::size_t facets) {
  return facets <= kFacetsTestedByAll ? kFacetsTestedByAll : kLeafMax;
}

Box box_of_facet(const std::array<Vec3, 4>& corners, bool is_triangle) {
  return box_of(std::span(corners).first(is_triangle ? 3 : 4));
}

}  // namespace

LineScene LineScene::at_rest(const Patches& patches, const Animation& animation) {
  LineScene scene(patches);
  const std::vector<PlacedFacet> facets = static_facets(patches, animation);
  std::vector<Box> boxes;
  for (const PlacedFacet& placed : facets)
    boxes.push_back(box_of_facet(placed.corners, patches.facets[placed.facet].is_triangle));
  scene.set_centre(animation);
  scene.add_block(facets, build_hierarchy(boxes, leaf_max(facets.size())));
  scene.join_blocks();
  return scene;
}

// An object's tree has the same shape at every pose; only its boxes move.
LineScene LineScene::moving(const Patches& patches, const Animation& animation,
                            std::span<const FrameIndex> frames) {
  LineScene scene(patches);
  std::vector<std::vector<std::uint32_t>> of_object(animation.objects.size());
  for (std::uint32_t f = 0; f < patches.facets.size(); ++f) of_object[patches.facets[f].object].push_back(f);
  scene.set_centre(animation);
  for (std::size_t o = 0; o < of_object.size(); ++o) {
    const ObjectMotion& motion = animation.objects[o];
    if (of_object[o].empty() || motion.is_static(animation.frame_count)) continue;
    std::vector<Box> boxes;
    for (const std::uint32_t f : of_object[o])
      boxes.push_back(box_of_facet(patches.facets[f].corners, patches.facets[f].is_triangle));
    const BoxHierarchy shape = build_hierarchy(boxes, kLeafMax);
    std::vector<PlacedFacet> placed(of_object[o].size());
    for (const PlacedRange& range : placed_ranges(motion, frames)) {
      for (std::size_t k = 0; k < placed.size(); ++k) {
        placed[k] = place(patches.facets[of_object[o][k]], *range.pose);
        placed[k].facet = of_object[o][k];
        placed[k].first_slot = range.first_slot;
        placed[k].last_slot = range.last_slot;
      }
      scene.add_block(placed, shape);
    }
  }
  scene.join_blocks();
  return scene;
}

/// The same for every window, so that a line meets the same things in whichever window a frame is traced.
void LineScene::set_centre(const Animation& animation) {
  std::optional<Box> all;
  for (const Facet& facet : patches_->facets) {
    const ObjectMotion& motion = animation.objects[facet.object];
    if (motion.spans.empty()) continue;
    const Vec3 at = transform_point(motion.spans[0].pose, facet.origin);
    all = all ? join(*all, {at, at}) : Box{at, at};
  }
  if (!all) return;
  tree_->centre = 0.5f * (all->lower + all->upper);
  const float size = length(all->upper - all->lower) + length(tree_->centre);
  margin_ = Vec3{size, size, size} * 4e-6f;
}

void LineScene::add_block(std::span<const PlacedFacet> facets, const BoxHierarchy& shape) {
  if (facets.empty()) return;
  const auto node_base = static_cast<std::uint32_t>(tree_->nodes.size());
  const auto place_base = static_cast<std::uint32_t>(items_.size());
  std::vector<Box> boxes;
  for (const std::uint32_t k : shape.order) {
    const PlacedFacet& placed = facets[k];
    const Facet& facet = patches_->facets[placed.facet];
    boxes.push_back(box_of_facet(placed.corners, facet.is_triangle));
    boxes.back().lower = boxes.back().lower - tree_->centre - margin_;
    boxes.back().upper = boxes.back().upper - tree_->centre + margin_;
    tree_->tests.push_back(facet_test(placed, facet.is_triangle, tree_->centre));
    items_.push_back({placed.facet, 0, 0, 0, 0, static_cast<std::uint16_t>(placed.first_slot),
                      static_cast<std::uint16_t>(placed.last_slot)});
    number_patches(items_.back());
  }
  for (BoxNode node : shape.nodes) {
    node.first += node.count == 0 ? node_base : place_base;
    tree_->nodes.push_back(node);
  }
  refit(std::span(tree_->nodes).subspan(node_base), node_base, boxes, place_base);
  blocks_.push_back({node_base, facets[0].first_slot, facets[0].last_slot});
}

/// Where the patches of the facet begin and how they are laid out.
void LineScene::number_patches(Item& item) const {
  const Facet& facet = patches_->facets[item.facet];
  const bool is_grid = !facet.is_triangle && facet.trees.empty();
  item.first_patch = facet.first_patch;
  item.back = facet.both_sides ? facet.cell_count() : 0;
  item.grid_u = is_grid ? facet.grid_u : 0;
  item.grid_v = is_grid ? facet.grid_v : 0;
}

LineScene LineScene::of(const Patches& patches) const {
  LineScene scene = *this;
  scene.patches_ = &patches;
  for (Item& item : scene.items_) scene.number_patches(item);
  return scene;
}

/// A tree over the blocks, whose leaves become the blocks' roots.
void LineScene::join_blocks() {
  std::vector<Box> boxes;
  for (const Block& block : blocks_)
    boxes.push_back({tree_->nodes[block.root].lower, tree_->nodes[block.root].upper});
  const BoxHierarchy top = build_hierarchy(boxes, 1);
  root_ = static_cast<std::uint32_t>(tree_->nodes.size());
  for (BoxNode node : top.nodes) {
    if (node.count > 0)
      node = tree_->nodes[blocks_[top.order[node.first]].root];
    else
      node.first += root_;
    tree_->nodes.push_back(node);
  }
}

inline bool LineScene::is_before(const PacketHit& a, const PacketHit& b) const {
  if (a.distance != b.distance) return a.distance < b.distance;
  const Item &of_a = items_[a.item], &of_b = items_[b.item];
  return of_a.facet != of_b.facet ? of_a.facet < of_b.facet : of_a.first_slot < of_b.first_slot;
}

inline MovingCrossing LineScene::crossing_of(const PacketHit& hit) const {
  const Item& item = items_[hit.item];
  const std::uint32_t cell =
      item.grid_u > 0 ? index_in_grid(hit.v, item.grid_v) * item.grid_u + index_in_grid(hit.u, item.grid_u)
                      : cell_at(patches_->facets[item.facet], hit.u, hit.v);
  const PatchId front = item.first_patch + cell, back = item.back > 0 ? front + item.back : kNoPatch;
  MovingCrossing crossing;
  crossing.distance = hit.distance;
  crossing.facing_back = hit.front != 0 ? front : back;
  crossing.facing_forward = hit.front != 0 ? back : front;
  crossing.first_slot = item.first_slot;
  crossing.last_slot = item.last_slot;
  return crossing;
}

void LineScene::all_hits(const LinePacket& packet, Buffers& buffers, PacketCrossings& found) const {
  buffers.hits.clear();
  if (!empty()) trace_packet(*tree_, std::span(&root_, 1), packet, buffers.lists, buffers.hits);
  list_hits(0, kWindowMax - 1, buffers, found);
}

void LineScene::all_hits(const LinePacket& packet, std::uint32_t first_slot, std::uint32_t last_slot,
                         Buffers& buffers, PacketCrossings& found) const {
  buffers.hits.clear();
  buffers.roots.clear();
  for (const Block& block : blocks_)
    if (block.first_slot <= last_slot && first_slot <= block.last_slot) buffers.roots.push_back(block.root);
  trace_packet(*tree_, buffers.roots, packet, buffers.lists, buffers.hits);
  list_hits(first_slot, last_slot, buffers, found);
}

void LineScene::list_hits(std::uint32_t first_slot, std::uint32_t last_slot, Buffers& buffers,
                          PacketCrossings& found) const {
  sort_by_lane(buffers, found);
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const std::uint32_t first = found.begin[lane], count = found.begin[lane + 1] - first;
    found.begin[lane] = static_cast<std::uint32_t>(found.crossings.size());
    list_lane(std::span(buffers.sorted).subspan(first, count), first_slot, last_slot, buffers, found);
  }
  found.begin[kLanes] = static_cast<std::uint32_t>(found.crossings.size());
}

/// Into buffers.sorted, each lane's from found.begin[lane] on and by distance. Empties `found`.
void LineScene::sort_by_lane(Buffers& buffers, PacketCrossings& found) const {
  found.crossings.clear();
  found.begin.fill(0);
  for (const PacketHit& hit : buffers.hits) ++found.begin[hit.lane + 1];
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) found.begin[lane + 1] += found.begin[lane];
  if (buffers.sorted.size() < buffers.hits.size()) buffers.sorted.resize(buffers.hits.size());
  std::array<std::uint32_t, kLanes> next;
  std::copy_n(found.begin.begin(), kLanes, next.begin());
  PacketHit* const sorted = buffers.sorted.data();
  constexpr std::uint32_t kFew = 12;  // beyond them, moving one by one takes too long
  for (const PacketHit& hit : buffers.hits) {
    const std::uint32_t begin = found.begin[hit.lane];
    std::uint32_t place = next[hit.lane]++;
    if (found.begin[hit.lane + 1] - begin <= kFew)
      for (; place > begin && is_before(hit, sorted[place - 1]); --place) sorted[place] = sorted[place - 1];
    sorted[place] = hit;
  }
  const auto before = [this](const PacketHit& a, const PacketHit& b) { return is_before(a, b); };
  for (std::uint32_t lane = 0; lane < kLanes; ++lane)
    if (found.begin[lane + 1] - found.begin[lane] > kFew)
      std::sort(sorted + found.begin[lane], sorted + found.begin[lane + 1], before);
}

bool LineScene::has_ties(std::span<const PacketHit> hits) const {
  bool ties = false;
  for (std::size_t k = 1; k < hits.size(); ++k) ties |= is_same_distance(hits[k - 1], hits[k]);
  return ties;
}

MovingHit LineScene::hit_of(const PacketHit& hit) const {
  const Item& item = items_[hit.item];
  MovingHit of;
  static_cast<SurfaceHit&>(of) = {hit.distance, item.facet, hit.u, hit.v, hit.front != 0};
  of.first_slot = item.first_slot;
  of.last_slot = item.last_slot;
  return of;
}

/// Appends what is there in some of the slots.
void LineScene::list_lane(std::span<const PacketHit> hits, std::uint32_t first_slot, std::uint32_t last_slot,
                          Buffers& buffers, PacketCrossings& found) const {
  const auto append = [&](MovingCrossing crossing) {
    crossing.first_slot = std::max(crossing.first_slot, first_slot);
    crossing.last_slot = std::min(crossing.last_slot, last_slot);
    if (crossing.first_slot <= crossing.last_slot) found.crossings.push_back(crossing);
  };
  if (!has_ties(hits)) {
    for (const PacketHit& hit : hits) append(crossing_of(hit));
    return;
  }
  buffers.apart.clear();
  for (const PacketHit& hit : hits) add_crossing(buffers.apart, hit_of(hit));
  for (const MovingHit& hit : buffers.apart) {
    MovingCrossing crossing;
    static_cast<Crossing&>(crossing) = engine::crossing_of(*patches_, hit);
    crossing.first_slot = hit.first_slot;
    crossing.last_slot = hit.last_slot;
    append(crossing);
  }
}

}  // namespace engine
