// One frame of an animation, line by line and hit by hit: what a traced window of many frames must agree
// with.
#pragma once

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "engine/lines/trace_lines.h"
#include "engine/visibility/line_scene.h"
#include "tests/unit/engine/scenes.h"

namespace tests {

using PairCounts = std::map<std::pair<engine::PatchId, engine::PatchId>, int>;  ///< without zeros

/// Everything that is there in `frame`, at rest in an animation of one frame.
inline engine::Animation at_rest_in(const World& world, engine::FrameIndex frame) {
  engine::Animation rest = still(world.scene, 1);
  for (std::size_t object = 0; object < rest.objects.size(); ++object) {
    rest.objects[object].spans.clear();
    for (const engine::PoseSpan& span : world.animation.objects[object].spans)
      if (span.first <= frame && frame <= span.last) rest.objects[object].spans = {{0, 0, span.pose}};
  }
  return rest;
}

struct OneFrame {
  PairCounts pairs;                      ///< (receiver, sender) -> lines
  std::vector<std::uint32_t> crossings;  ///< [patch]
};

/// Global lines [first, last) in `frame` alone.
inline OneFrame trace_one_frame(const World& world, engine::FrameIndex frame, std::uint32_t first,
                                std::uint32_t last, std::uint64_t seed) {
  const engine::Animation rest = at_rest_in(world, frame);
  const engine::LineScene scene = engine::LineScene::at_rest(world.patches, rest);
  const engine::LineBox box = engine::line_box(world.patches, world.animation);
  OneFrame found{{}, std::vector<std::uint32_t>(world.patches.count(), 0)};
  engine::LineScene::Buffers buffers;
  engine::PacketCrossings hits;
  engine::LinePacket packet;
  for (std::uint32_t line = first; line < last; ++line) {
    packet.clear();
    packet.push(engine::global_line(box, line, seed));
    scene.all_hits(packet, buffers, hits);
    engine::PatchId before = engine::kNoPatch;
    for (const engine::Crossing& crossing : hits.of(0)) {
      for (const engine::PatchId patch : {crossing.facing_back, crossing.facing_forward})
        if (patch != engine::kNoPatch) ++found.crossings[patch];
      if (before != engine::kNoPatch && crossing.facing_back != engine::kNoPatch) {
        ++found.pairs[{before, crossing.facing_back}];
        ++found.pairs[{crossing.facing_back, before}];
      }
      before = crossing.facing_forward;
    }
  }
  return found;
}

/// (receiver, sender) -> lines in one slot of a traced window.
inline PairCounts exchanges_in(const engine::TracedLines& lines, std::uint32_t patch_count,
                               std::uint32_t slot) {
  PairCounts counts;
  for (engine::PatchId patch = 0; patch < patch_count; ++patch) {
    for (const engine::Exchange& e : lines.static_rows.row(patch))
      counts[{patch, e.sender()}] += static_cast<int>(e.count());
    for (const engine::SlotExchange& e : lines.moving_rows.row(patch))
      if (e.first_slot <= slot && slot <= e.last_slot) counts[{patch, e.sender}] += e.weight;
  }
  std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
  return counts;
}

/// A square matrix of doubles.
struct Dense {
  std::size_t size = 0;
  std::vector<double> values;  ///< [row][column]

  explicit Dense(std::size_t n) : size(n), values(n * n) {}
  double& at(std::size_t row, std::size_t column) { return values[row * size + column]; }
  double at(std::size_t row, std::size_t column) const { return values[row * size + column]; }

  std::vector<double> times(const std::vector<double>& b) const {
    std::vector<double> product(size);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t j = 0; j < size; ++j) product[i] += at(i, j) * b[j];
    return product;
  }
};

/// T of one frame: exchanges over crossings; rows without crossings are zero.
inline Dense operator_of(const OneFrame& frame) {
  Dense t(frame.crossings.size());
  for (const auto& [pair, count] : frame.pairs)
    t.at(pair.first, pair.second) = double(count) / frame.crossings[pair.first];
  return t;
}

/// T of one slot of a window.
inline Dense operator_in(const engine::TracedLines& lines, std::uint32_t patch_count, std::uint32_t slot) {
  OneFrame frame{exchanges_in(lines, patch_count, slot), {}};
  for (engine::PatchId patch = 0; patch < patch_count; ++patch)
    frame.crossings.push_back(lines.crossings.at(patch, slot));
  return operator_of(frame);
}

/// x of A x = b, by elimination with row pivots.
inline std::vector<double> solve_dense(Dense a, std::vector<double> b) {
  const std::size_t n = a.size;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a.at(i, k)) > std::abs(a.at(pivot, k))) pivot = i;
    for (std::size_t j = k; j < n; ++j) std::swap(a.at(k, j), a.at(pivot, j));
    std::swap(b[k], b[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a.at(i, k) / a.at(k, k);
      if (factor == 0) continue;
      for (std::size_t j = k; j < n; ++j) a.at(i, j) -= factor * a.at(k, j);
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a.at(k, j) * b[j];
    b[k] /= a.at(k, k);
  }
  return b;
}

}  // namespace tests
