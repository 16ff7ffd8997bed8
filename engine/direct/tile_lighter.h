// One tile, lit by all lights of a window of frames.
#pragma once

#include "engine/direct/direct_light.h"
#include "engine/direct/light_choice.h"
#include "engine/direct/shadow_samples.h"
#include "engine/direct/shadows.h"
#include "engine/direct/tile_sums.h"
#include "engine/direct/tile_view.h"

namespace engine {

/// What lights a patch and what stands in the way, in one window. Pointers are never null but `moving_rays`,
/// which is where there are no frames.
struct LightingWindow {
  const StaticRays* static_rays = nullptr;
  const MovingRays* moving_rays = nullptr;
  const StaticOccluders* static_occluders = nullptr;
  const MovingOccluders* moving_occluders = nullptr;
  const WindowLights* lights = nullptr;
  DirectOptions options;
  float reach_m = 0;       ///< see Arrivals
  bool with_rest = false;  ///< finds the light of the scene at rest, too
};

/// Adds up the light of one tile after the other; one per task.
///
/// What may stand in the way is found for all of a tile at once, and of that for its quarters, and so on:
/// where nothing does, nothing is left to do for what is below. That says only where rays are worth it; what
/// a patch gets does not depend on it.
class TileLighter {
 public:
  /// `window` and `sums` outlive it.
  TileLighter(const LightingWindow& window, TileSums& sums);

  /// Adds the light that arrives at `cells` (bits) of the tile where it is.
  void light(const PlacedTile& tile, std::uint64_t cells);

  std::uint64_t samples() const { return samples_taken_; }  ///< each a point of a patch against a light
  std::uint64_t rays() const { return rays_; }              ///< of them those that had to be traced

 private:
  /// Samples of a cell: `count` of each of some replicates.
  struct Draws {
    std::uint32_t first_replicate = 0, replicates = 1;
    std::uint32_t first_index = 0, count = 1;
    std::uint32_t stream = 0;  ///< of the random numbers
    float weight = 1;          ///< of the light

    std::size_t samples() const { return std::size_t{replicates} * count; }
    std::size_t blocks() const { return (samples() + RayLanes::kCount - 1) / RayLanes::kCount; }
    /// Of a replicate of cell `k` of a batch, whose cells begin with a block each.
    std::size_t first_sample(std::size_t k, std::uint32_t replicate) const {
      return k * blocks() * RayLanes::kCount + std::size_t{replicate} * count;
    }
  };
  /// The tile against a light, both where they are in some slots.
  struct Sight {
    const PlacedTile* tile = nullptr;
    const WindowLight* light = nullptr;
    const LightPose* pose = nullptr;
    const Brightness* brightness = nullptr;
    Slots slots;
    bool rests = false;  ///< belongs to the scene at rest
  };

  void choose(const PlacedTile& tile, std::uint64_t cells);
  bool see(const PlacedTile& tile, const WindowLight& light, const LightPose& pose, Sight& sight) const;
  void add_group(const PlacedTile& tile, const LightGroup& group, std::uint64_t cells);
  void add_light(const Sight& sight, std::uint64_t cells);
  void add_drawn(const PlacedTile& tile, std::uint32_t cell, const LightChoice& choice, bool at_rest);
  void add_drawn_light(const PlacedTile& tile, std::uint32_t cell, const WindowLight& light,
                       const Draws& draws);

  Shaft shaft_of(const ShaftEnd& here, const Sight& sight) const;
  OccluderSource source(const Sight& sight) const;
  void descend(const Sight& sight, std::uint32_t node, const Candidates* of_parent, std::size_t depth,
               std::uint64_t cells);
  void add_cell(std::uint32_t cell, const Draws& draws);
  void shade(const Sight& sight, std::uint64_t cells, const Draws& draws);

  /// The samples [first, end) of one replicate.
  struct Lot {
    std::uint32_t cell = 0, replicate = 0;
    std::size_t first = 0, end = 0;
    float sum = 0;     ///< of the weights
    float factor = 0;  ///< what they stand for
  };

  std::uint64_t seed_of(std::uint32_t replicate, PatchId patch, std::uint32_t stream) const;
  static void set_indices(const Draws& draws, std::vector<SobolBits>& bits);
  void shade_batch(const Sight& sight, const Draws& draws);
  void place_samples(const Sight& sight, const Draws& draws);
  Spread spread_of(const PlacedTile& tile, std::uint32_t cell) const;
  void set_seeds(const Sight& sight, const Draws& draws, std::size_t k, std::size_t block);
  bool is_small(std::uint32_t cell) const;
  void join_small(const Sight& sight, const Draws& draws);
  void aim(const Draws& draws, std::size_t k, std::size_t block);
  template <class Bits>
  float weigh(std::size_t first, std::size_t end, Bits&& bits) const;
  void add_close(std::size_t k, const Draws& draws);
  void darken(const Sight& sight, std::size_t k, const Draws& draws);
  void darken_lot(const Sight& sight, const Lot& lot);
  std::uint32_t samples_per_replicate(float lights) const;

  const LightingWindow& window_;
  TileSums& sums_;
  Shadows shadows_;
  TileView view_;
  Draws own_;  ///< of a light with samples of its own
  std::vector<SobolBits> own_bits_, bits_;
  std::vector<std::uint32_t> batch_;       ///< cells whose rays are cast together
  std::vector<const SobolBits*> bits_of_;  ///< from here on [block], those of a cell one after the other
  std::vector<SobolSeeds> seeds_;
  std::vector<SobolPoints> numbers_;
  std::vector<Spread> over_here_, over_there_;
  std::vector<SpreadPoints> here_, there_;
  std::vector<SampleLanes> weights_;
  std::vector<Candidates> levels_;        ///< [depth of a node]
  std::vector<LightChoice> choices_[2];   ///< [moving][cell]; empty where every light has its own samples
  std::vector<std::uint64_t> own_cells_;  ///< [light]: cells against which it has samples of its own
  std::uint64_t samples_taken_ = 0, rays_ = 0;
};

}  // namespace engine
