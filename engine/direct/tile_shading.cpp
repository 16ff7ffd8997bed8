// The part of TileLighter that casts rays.
#include <algorithm>
#include <array>
#include <bit>

#include "engine/direct/cell_bits.h"
#include "engine/direct/tile_lighter.h"

namespace engine {
namespace {

/// Blocks of rays that are cast together: enough to keep the processor busy, few enough for its cache.
constexpr std::size_t kBatchBlocks = 16;

/// Uniform in [0, 1): chooses the piece of a light.
float piece_of(std::uint64_t seed, std::uint32_t index) {
  return static_cast<float>(mix(seed + index) >> 40) * 0x1p-24f;
}

/// Where a linear function that is `low` at 0 and `high` at 1 is positive, as [first, second].
std::pair<float, float> where_positive(float low, float high) {
  if (low <= 0 && high > 0) return {low / (low - high), 1.0f};
  if (low > 0 && high <= 0) return {0.0f, low / (low - high)};
  return {0.0f, 1.0f};
}

/// The light, or of a parallelogram the smallest part along its edges that holds what is above the horizon;
/// points on it are as dense as they contribute to `from`, or nearly so.
Spread spread_over(const LightPose& light, Vec3 from, const Receiver& receiver) {
  const PlacedFacet& at = light.facet.placed;
  Spread over{at.origin, at.edge_u, at.edge_v, light.facet.is_triangle, {1, 1, 1, 1}};
  if (light.facet.is_triangle) return over;
  const Vec3 normal = receiver.placed.normal;
  const float height = dot(normal, at.origin - receiver.placed.origin);
  const float along_u = dot(normal, at.edge_u), along_v = dot(normal, at.edge_v);
  const float most_u = height + std::max(0.0f, along_v), most_v = height + std::max(0.0f, along_u);
  const auto [u0, u1] = where_positive(most_u, most_u + along_u);
  const auto [v0, v1] = where_positive(most_v, most_v + along_v);
  over = {
      at.origin + u0 * at.edge_u + v0 * at.edge_v, (u1 - u0) * at.edge_u, (v1 - v0) * at.edge_v, false, {}};
  const Vec3 corners[4] = {over.corner, over.corner + over.edge_u, over.corner + over.edge_v,
                           over.corner + over.edge_u + over.edge_v};
  float most = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec3 apart = corners[c] - from;
    const float squared = dot(apart, apart);
    over.density[c] =
        std::max(0.0f, -dot(at.normal, apart)) * std::max(0.0f, dot(normal, apart)) / (squared * squared);
    most = std::max(most, over.density[c]);
  }
  for (float& density : over.density) density = most > 0 ? std::max(density, 0.1f * most) : 1;
  return over;
}

}  // namespace

std::uint64_t TileLighter::seed_of(std::uint32_t replicate, PatchId patch, std::uint32_t stream) const {
  return stream_seed(stream_seed(window_.options.seed, replicate), (std::uint64_t{patch} << 32) | stream);
}

/// Which points of the sequence the lanes hold.
void TileLighter::set_indices(const Draws& draws, std::vector<SobolBits>& bits) {
  bits.resize(draws.blocks());
  for (std::size_t k = 0; k < draws.samples(); ++k)
    bits[k / SobolBits::kCount].set(k % SobolBits::kCount,
                                    draws.first_index + static_cast<std::uint32_t>(k % draws.count));
}

/// Takes away what the contents of the shaft block; of cells close to the light, finds what arrives, too.
void TileLighter::shade(const Sight& sight, std::uint64_t cells, const Draws& draws) {
  batch_.clear();
  each_cell(cells, [&](std::uint32_t cell) {
    if (view_.of(cell) == View::apart && shadows_.none()) return;
    batch_.push_back(cell);
    if (batch_.size() * draws.blocks() >= kBatchBlocks) shade_batch(sight, draws);
  });
  if (!batch_.empty()) shade_batch(sight, draws);
}

void TileLighter::shade_batch(const Sight& sight, const Draws& draws) {
  place_samples(sight, draws);
  for (std::size_t k = 0; k < batch_.size(); ++k)
    if (view_.of(batch_[k]) == View::close) add_close(k, draws);
  if (!shadows_.none()) {
    for (std::size_t block = 0; block < shadows_.blocks(); ++block)
      rays_ += static_cast<std::uint64_t>(std::popcount(shadows_.is_set(block)));
    shadows_.cast(sight.slots);
    for (std::size_t k = 0; k < batch_.size(); ++k) darken(sight, k, draws);
  }
  batch_.clear();
}

/// Rays of the batch, and what each counts by the side of others of its cell.
void TileLighter::place_samples(const Sight& sight, const Draws& draws) {
  const std::size_t per_cell = draws.blocks(), blocks = batch_.size() * per_cell;
  shadows_.begin_blocks(blocks);
  weights_.resize(blocks);
  bits_of_.resize(blocks);
  seeds_.resize(blocks);
  numbers_.resize(blocks);
  over_here_.resize(blocks);
  here_.resize(blocks);
  const bool own = draws.first_index == 0 && draws.count == own_.count && draws.replicates == own_.replicates;
  if (!own) set_indices(draws, bits_);
  for (std::size_t k = 0; k < batch_.size(); ++k) {
    const Spread over = spread_of(*sight.tile, batch_[k]);
    for (std::size_t block = k * per_cell; block < (k + 1) * per_cell; ++block) {
      bits_of_[block] = &(own ? own_bits_ : bits_)[block - k * per_cell];
      over_here_[block] = over;
      set_seeds(sight, draws, k, block);
    }
  }
  scramble(bits_of_.data(), seeds_.data(), blocks, numbers_.data());
  spread(over_here_.data(), numbers_.data(), 0, blocks, here_.data());
  join_small(sight, draws);
  for (std::size_t k = 0; k < batch_.size(); ++k)
    if (!is_small(batch_[k]))
      for (std::size_t block = k * per_cell; block < (k + 1) * per_cell; ++block) aim(draws, k, block);
}

/// The cell, as dense as it is lit.
Spread TileLighter::spread_of(const PlacedTile& tile, std::uint32_t cell) const {
  const CellCorners& corners = tile.layout().cells[cell];
  const CellEdges edges = cell_edges(tile.facet().placed, corners);
  Spread over{edges.corner, edges.edge_u, edges.edge_v, corners.count == 3, {1, 1, 1, 1}};
  if (view_.of(cell) == View::apart) over.density = view_.at_corners(cell);
  return over;
}

void TileLighter::set_seeds(const Sight& sight, const Draws& draws, std::size_t k, std::size_t block) {
  const PatchId patch = sight.tile->layout().patches[batch_[k]];
  const std::size_t first = (block - k * draws.blocks()) * SobolBits::kCount;
  std::uint32_t replicate = draws.replicates;  // none yet
  std::uint64_t seed = 0;
  for (std::size_t lane = 0; lane < SobolBits::kCount; ++lane) {
    const auto r = static_cast<std::uint32_t>(std::min(first + lane, draws.samples() - 1) / draws.count);
    if (r != replicate) seed = seed_of(draws.first_replicate + r, patch, draws.stream);
    replicate = r;
    seeds_[block][lane] = seed;
  }
}

bool TileLighter::is_small(std::uint32_t cell) const {
  return view_.of(cell) == View::apart && view_.is_small(cell);
}

/// Rays to points of the light that are drawn by themselves, for the cells from which it is small.
void TileLighter::join_small(const Sight& sight, const Draws& draws) {
  if (std::none_of(batch_.begin(), batch_.end(), [&](std::uint32_t cell) { return is_small(cell); })) return;
  const std::size_t per_cell = draws.blocks(), blocks = batch_.size() * per_cell;
  over_there_.resize(blocks);
  there_.resize(blocks);
  const Receiver& facet = sight.tile->facet();
  for (std::size_t block = 0; block < blocks; ++block)
    over_there_[block] = block % per_cell == 0
                             ? spread_over(*sight.pose, sight.tile->middle(batch_[block / per_cell]), facet)
                             : over_there_[block - 1];
  spread(over_there_.data(), numbers_.data(), 2, blocks, there_.data());
  const Vec3 normal = facet.placed.normal, of_light = sight.pose->facet.placed.normal;
  const float off_here = clearance_m(facet.roughness, sight.pose->roughness);
  const float off_there = clearance_m(sight.pose->roughness, facet.roughness);
  join({normal, of_light, off_here * normal, off_there * of_light}, here_.data(), there_.data(), blocks,
       shadows_.lanes(), weights_.data());
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block % per_cell * RayLanes::kCount;
    std::uint32_t set = 0;
    for (std::uint32_t lane = 0; lane < RayLanes::kCount; ++lane)
      set |= weights_[block][lane] > 0 && first + lane < draws.samples() ? 1u << lane : 0u;
    shadows_.set_bits(block, set);
  }
}

/// A point of the light for every point of a cell, drawn in proportion to what it contributes there.
void TileLighter::aim(const Draws& draws, std::size_t k, std::size_t block) {
  const std::size_t first = (block - k * draws.blocks()) * RayLanes::kCount;
  const std::size_t count = std::min(RayLanes::kCount, draws.samples() - first);
  const SpreadPoints& here = here_[block];
  const SobolPoints& numbers = numbers_[block];
  SampleLanes& weights = weights_[block];
  weights.fill(0);
  shadows_.set_bits(block, 0);
  const Arrivals& arrivals = view_.arrivals();
  if (view_.light().source) {
    for (std::size_t lane = 0; lane < count; ++lane)
      weights[lane] = arrivals.source_factor({here.x[lane], here.y[lane], here.z[lane]});
  } else {
    view_.polygon().form_factors({here.x.data(), here.y.data(), here.z.data(), count}, weights.data());
  }
  for (std::size_t lane = 0; lane < count; ++lane) {
    if (!shadows_.none() && weights[lane] > 0) {
      const auto index = draws.first_index + static_cast<std::uint32_t>((first + lane) % draws.count);
      const LightDraw draw{numbers.of[2][lane], numbers.of[3][lane], piece_of(seeds_[block][lane], index)};
      shadows_.set(block * RayLanes::kCount + lane,
                   arrivals.shadow({here.x[lane], here.y[lane], here.z[lane]}, draw));
    }
    if (view_.of(batch_[k]) == View::apart) weights[lane] /= here.density[lane];
  }
}

/// The weights of the samples [first, end), those whose bits are set. Block by block, as sum_blocked adds
/// them.
template <class Bits>
float TileLighter::weigh(std::size_t first, std::size_t end, Bits&& bits) const {
  float sum = 0;
  for (std::size_t k = first; k < end;) {
    const std::size_t block = k / RayLanes::kCount;
    const std::uint32_t set = bits(block);
    float of_block = 0;
    for (; k < end && k / RayLanes::kCount == block; ++k)
      of_block += ((set >> (k % RayLanes::kCount)) & 1) != 0 ? weights_[block][k % RayLanes::kCount] : 0;
    sum += of_block;
  }
  return sum;
}

/// What arrives at a cell that is close to the light, if nothing is in the way.
void TileLighter::add_close(std::size_t k, const Draws& draws) {
  for (std::uint32_t r = 0; r < draws.replicates; ++r) {
    const std::size_t first = draws.first_sample(k, r);
    const float sum = weigh(first, first + draws.count, [](std::size_t) { return ~0u; });
    if (sum > 0)
      sums_.add_lit(batch_[k], draws.first_replicate + r,
                    sum / static_cast<float>(draws.count) * draws.weight);
  }
}

void TileLighter::darken(const Sight& sight, std::size_t k, const Draws& draws) {
  const std::uint32_t cell = batch_[k];
  for (std::uint32_t r = 0; r < draws.replicates; ++r) {
    const std::size_t first = draws.first_sample(k, r);
    Lot lot{cell, draws.first_replicate + r, first, first + draws.count, 0, 0};
    lot.sum = weigh(lot.first, lot.end, [&](std::size_t block) { return shadows_.is_set(block); });
    if (!(lot.sum > 0)) continue;
    const float open =
        view_.of(cell) == View::apart ? view_.factor(cell) : lot.sum / static_cast<float>(draws.count);
    lot.factor = open * draws.weight;
    darken_lot(sight, lot);
  }
}

void TileLighter::darken_lot(const Sight& sight, const Lot& lot) {
  const float blocked = weigh(lot.first, lot.end, [&](std::size_t block) { return shadows_.at_rest(block); });
  const float at_rest = lot.factor * (blocked / lot.sum);
  const std::size_t first_block = lot.first / RayLanes::kCount, last_block = (lot.end - 1) / RayLanes::kCount;
  bool moving = false;
  for (std::size_t block = first_block; block <= last_block; ++block) moving |= shadows_.any_moving(block);
  if (at_rest == 0 && !moving) return;
  sums_.dark_at_rest(lot.cell, lot.replicate) += at_rest;
  float* dark = sums_.dark(lot.cell, lot.replicate);
  const Slots touched = moving ? shadows_.touched() : Slots{sight.slots.end, sight.slots.end};
  if (at_rest > 0) {
    for (std::uint32_t slot = sight.slots.begin; slot < touched.begin; ++slot) dark[slot] += at_rest;
    for (std::uint32_t slot = touched.end; slot < sight.slots.end; ++slot) dark[slot] += at_rest;
  }
  if (!moving) return;
  const std::size_t slots = touched.end - touched.begin;
  std::array<float, kWindowMax> sums;
  std::fill_n(sums.begin(), slots, 0.0f);
  for (std::size_t block = first_block; block <= last_block; ++block) {
    const std::size_t begin = block * RayLanes::kCount;
    sum_blocked(shadows_.moving(block) + touched.begin, shadows_.at_rest(block), shadows_.is_set(block),
                weights_[block], std::max(lot.first, begin) - begin,
                std::min(lot.end, begin + RayLanes::kCount) - begin, slots, sums.data());
  }
  for (std::size_t k = 0; k < slots; ++k) dark[touched.begin + k] += lot.factor * (sums[k] / lot.sum);
}

}  // namespace engine
