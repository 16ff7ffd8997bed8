#include "engine/direct/tile_lighter.h"

#include <algorithm>

#include "engine/direct/cell_bits.h"

namespace engine {
namespace {

/// Streams of the draws among many lights, beside those of single lights.
constexpr std::uint32_t kStaticStream = 0xffffffffu, kMovingStream = 0xfffffffeu;

/// A ray asks a tree in the time it takes to look at about so many facets, sixteen rays at once.
constexpr std::size_t kFacetsPerRay = 32;

/// A facet takes sixteen rays about so much less time than a shaft takes, with what is sifted by it.
constexpr std::size_t kFacetsPerShaft = 16;

/// Tiles of 64 cells, their quarters, and those of these.
constexpr std::size_t kLevels = 4;

/// Uniform in [0, 1): where in part `index` of the row of probabilities a light is drawn.
double place_in_part(std::uint32_t index, std::uint64_t seed) {
  return static_cast<double>(mix(~seed + index) >> 11) * 0x1p-53;
}

ShaftEnd end_at(const LightPose& light, const ShaftEnd& receiver, const Roughness& there, float reach_m) {
  ShaftEnd end;
  end.slack_m = clearance_m(light.roughness, there);
  if (!light.source) {
    const auto polygon = light.facet.polygon();
    end.count = static_cast<std::uint32_t>(polygon.size());
    std::copy(polygon.begin(), polygon.end(), end.corners.begin());
    end.normal = light.facet.placed.normal;
  } else if (light.source->type == api::LightType::directional) {
    end.count = receiver.count;
    for (std::uint32_t c = 0; c < end.count; ++c)
      end.corners[c] = receiver.corners[c] - reach_m * light.direction;
  } else {
    end.count = 1;
    end.corners[0] = light.position;
  }
  return end;
}

float radius_of(const ShaftEnd& end) {
  Vec3 lower = end.corners[0], upper = end.corners[0];
  for (std::uint32_t c = 1; c < end.count; ++c) {
    lower = min(lower, end.corners[c]);
    upper = max(upper, end.corners[c]);
  }
  return 0.5f * length(upper - lower);
}

/// Are shafts for the parts of a node worth their time? Those of its quarters are less than three quarters as
/// wide only where the node is larger than the light; and what is short already costs less to look at.
bool worth_parting(const ShaftEnd& here, const LightPose& light, std::uint32_t cells,
                   const Candidates& found) {
  if (found.many_at_rest || found.some_slots_many()) return true;
  const std::size_t facets = found.at_rest.facets.size() + found.moving.facets.size();
  return cells * facets > 4 * kFacetsPerShaft && radius_of(here) > light.ball.radius_m;
}

void list_all(const Candidates& found, ShaftContents& contents) {
  contents.at_rest.assign(found.at_rest.facets.begin(), found.at_rest.facets.end());
  contents.moving.assign(found.moving.facets.begin(), found.moving.facets.end());
}

}  // namespace

TileLighter::TileLighter(const LightingWindow& window, TileSums& sums)
    : window_(window), sums_(sums), shadows_(*window.static_rays, window.moving_rays), levels_(kLevels) {
  own_.replicates = sums.replicates();
  own_.count = samples_per_replicate(1);
  set_indices(own_, own_bits_);
}

void TileLighter::light(const PlacedTile& tile, std::uint64_t cells) {
  choose(tile, cells);
  for (const LightGroup& group : window_.lights->groups) add_group(tile, group, cells);
  for (const bool at_rest : {true, false}) {
    const auto& choices = choices_[at_rest ? 0 : 1];
    if (!choices.empty())
      each_cell(cells, [&](std::uint32_t cell) { add_drawn(tile, cell, choices[cell], at_rest); });
  }
}

/// Which lights have samples of their own; where that can be all, all have.
void TileLighter::choose(const PlacedTile& tile, std::uint64_t cells) {
  const std::span<const WindowLight> all = window_.lights->lights;
  const std::size_t rest = window_.lights->static_count;
  own_cells_.assign(all.size(), cells);
  for (const bool moving : {false, true}) {
    const auto lights = moving ? all.subspan(rest) : all.first(rest);
    auto& choices = choices_[moving ? 1 : 0];
    choices.clear();
    if (lights.size() <= kLightsEachMax) continue;
    std::uint64_t* own = own_cells_.data() + (moving ? rest : 0);
    std::fill_n(own, lights.size(), std::uint64_t{0});
    choices.resize(tile.count());
    each_cell(cells, [&](std::uint32_t cell) {
      choices[cell] = choose_lights(tile.receiver(cell), lights, window_.lights->brightness);
      for (const std::uint32_t l : choices[cell].each) own[l] |= std::uint64_t{1} << cell;
    });
  }
}

/// False where the light cannot shine on the tile.
bool TileLighter::see(const PlacedTile& tile, const WindowLight& light, const LightPose& pose,
                      Sight& sight) const {
  const Receiver& receiver = tile.facet();
  if (light.facet == receiver.facet) return false;  // flat: rounding alone puts it in its own sight
  const Brightness& brightness = window_.lights->brightness.of[light.brightness];
  const bool rests = window_.with_rest && receiver.is_static && light.is_static;
  const Slots slots = narrow_to_lit(brightness.lit, overlap(receiver.slots, pose.slots));
  if (slots.empty() && !rests) return false;
  sight = {&tile, &light, &pose, &brightness, slots, rests};
  return true;
}

void TileLighter::add_group(const PlacedTile& tile, const LightGroup& group, std::uint64_t cells) {
  Sight sight;
  for (const LightGroup::Member& member : group.members) {
    const WindowLight& light = window_.lights->lights[member.light];
    const std::uint64_t own = cells & own_cells_[member.light];
    if (own != 0 && see(tile, light, light.poses[member.pose], sight)) add_light(sight, own);
  }
  if (sight.tile) sums_.end_group(*sight.brightness, sight.slots, sight.rests);
}

/// A light with samples of its own.
void TileLighter::add_light(const Sight& sight, std::uint64_t cells) {
  if (!view_.look(*sight.tile, *sight.pose, window_.reach_m)) return;
  own_.stream = sight.light->stream;
  std::uint64_t open = 0;
  each_cell(cells, [&](std::uint32_t cell) {
    add_cell(cell, own_);
    if (view_.of(cell) != View::dark) open |= std::uint64_t{1} << cell;
  });
  if (open != 0) descend(sight, 0, nullptr, 0, open);
}

/// What arrives at a cell whose samples are not needed for that.
void TileLighter::add_cell(std::uint32_t cell, const Draws& draws) {
  samples_taken_ += std::uint64_t{draws.replicates} * draws.count;
  if (view_.of(cell) != View::apart) return;
  const float factor = view_.factor(cell) * draws.weight;
  for (std::uint32_t r = 0; r < draws.replicates; ++r) sums_.add_lit(cell, draws.first_replicate + r, factor);
}

/// One draw in each of n equal parts of the row of probabilities: a light of p gets n p draws, one more or
/// less, and all of its draws follow one another.
void TileLighter::add_drawn(const PlacedTile& tile, std::uint32_t cell, const LightChoice& choice,
                            bool at_rest) {
  if (choice.drawn.empty()) return;
  const std::size_t first_light = at_rest ? 0 : window_.lights->static_count;
  const std::uint32_t count = samples_per_replicate(choice.shared_lights);
  const auto n = static_cast<double>(count);
  for (std::uint32_t r = 0; r < sums_.replicates(); ++r) {
    Draws draws{r, 1, 0, 0, at_rest ? kStaticStream : kMovingStream, 1};
    const std::uint64_t seed = seed_of(r, tile.layout().patches[cell], draws.stream);
    double below = 0;  // probability of the lights before
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < choice.drawn.size() && next < count; ++k) {
      const DrawnLight& drawn = choice.drawn[k];
      below += drawn.probability;
      draws.first_index = next;
      const bool is_last = k + 1 == choice.drawn.size();  // takes what rounding leaves
      while (next < count && (is_last || next + place_in_part(next, seed) < n * below)) ++next;
      draws.count = next - draws.first_index;
      draws.weight = static_cast<float>(draws.count / (n * drawn.probability));
      if (draws.count > 0)
        add_drawn_light(tile, cell, window_.lights->lights[first_light + drawn.light], draws);
    }
  }
}

void TileLighter::add_drawn_light(const PlacedTile& tile, std::uint32_t cell, const WindowLight& light,
                                  const Draws& draws) {
  for (const LightPose& pose : light.poses) {
    Sight sight;
    if (!see(tile, light, pose, sight) || !view_.look_from(tile, cell, pose, window_.reach_m)) continue;
    add_cell(cell, draws);
    if (view_.of(cell) != View::dark) {
      const ShaftEnd here = tile.end_at(cell, clearance_m(tile.facet().roughness, pose.roughness));
      collect(source(sight), shaft_of(here, sight), shadows_.contents);
      shade(sight, std::uint64_t{1} << cell, draws);
    }
    sums_.end_group(*sight.brightness, sight.slots, sight.rests);
  }
}

Shaft TileLighter::shaft_of(const ShaftEnd& here, const Sight& sight) const {
  return Shaft(here, end_at(*sight.pose, here, sight.tile->facet().roughness, window_.reach_m));
}

OccluderSource TileLighter::source(const Sight& sight) const {
  return {*window_.static_occluders, *window_.moving_occluders,
          kFacetsPerRay * std::max<std::size_t>(RayLanes::kCount, own_.replicates * own_.count),
          sight.slots.begin, sight.slots.end};
}

/// Finds what stands between the cells of a node and the light, and shades them.
void TileLighter::descend(const Sight& sight, std::uint32_t n, const Candidates* of_parent, std::size_t depth,
                          std::uint64_t cells) {
  const TileNode& node = sight.tile->layout().nodes[n];
  cells &= run_of(node.first, node.end);
  if (cells == 0) return;
  const float slack = clearance_m(sight.tile->facet().roughness, sight.pose->roughness);
  const ShaftEnd here = sight.tile->end_at(node, slack);
  const Shaft shaft = shaft_of(here, sight);
  const OccluderSource from = source(sight);
  if (node.end - node.first == 1) {
    of_parent ? sift(from, *of_parent, shaft, shadows_.contents) : collect(from, shaft, shadows_.contents);
    return shade(sight, cells, own_);
  }
  Candidates& found = levels_[depth];
  of_parent ? sift(from, *of_parent, shaft, found) : collect(from, shaft, found);
  if (found.none()) {
    shadows_.contents.clear();
    return shade(sight, cells, own_);
  }
  if (!worth_parting(here, *sight.pose, node.end - node.first, found)) {
    shadows_.contents.clear();
    list_all(found, shadows_.contents);
    return shade(sight, cells, own_);
  }
  for (std::uint32_t child = n + 1; child < node.beyond; child = sight.tile->layout().nodes[child].beyond)
    descend(sight, child, &found, depth + 1, cells);
}

/// For as many as `lights` lights.
std::uint32_t TileLighter::samples_per_replicate(float lights) const {
  const float all = lights * static_cast<float>(window_.options.samples_per_light);
  return std::max(1u, static_cast<std::uint32_t>(all / static_cast<float>(sums_.replicates())));
}

}  // namespace engine
