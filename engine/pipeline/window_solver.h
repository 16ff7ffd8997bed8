// One window of frames under one replicate's lines, solved frame by frame as they are asked for.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/lighting/compose.h"
#include "engine/lighting/light_at_rest.h"
#include "engine/lighting/solve_difference.h"

namespace engine {

class WindowSolver {
 public:
  /// rests, sources: of each of `groups`. Everything outlives it but `lines`, which it keeps.
  WindowSolver(const LitScene& lit, std::span<const LitGroup> groups, std::span<const GroupSource> sources,
               std::span<const RestLight> rests, const RestTransport& transport,
               std::span<const FrameIndex> frames, TracedLines lines);

  /// Solves those of `frames` (increasing, all of the window) that are not solved yet. Error: stopped.
  /// carried: is Y wanted of them? Always the same.
  api::Status solve(std::span<const FrameIndex> frames, Carried carried, SolveCounts& counts,
                    const Progress& progress);

  std::span<const FrameIndex> frames() const { return frames_; }
  const std::vector<FrameIndex>& solved() const { return solved_; }
  /// Y of each group, [patch][position in solved()].
  std::vector<const PatchSeries*> carried() const;

  /// Indirect irradiance X = X_s + D of group `g`, [patch][position in solved()].
  PatchSeries at_solved(std::size_t g) const;
  /// The same, and it is not kept.
  PatchSeries take_at_solved(std::size_t g);
  /// The same, [patch][slot of the window], the frames between filled. Error: stopped.
  api::Result<PatchSeries> in_every_frame(std::size_t g, api::Interpolation interpolation,
                                          const Progress& progress) const;

  /// B of the groups named `name`, or of all (null), at the solved frames  [W/m^2], [patch][position in
  /// solved()].
  PatchSeries radiosity_at_solved(const std::string* name = nullptr) const;

  /// Patches and slots: they move, are there, and no line met them.
  EmptyRows empty_rows() const;
  const TracedLines& lines() const { return lines_; }

 private:
  WindowScene scene_of(std::size_t g) const;
  Columns columns_of(std::span<const FrameIndex> frames) const;
  void add_rest(std::size_t g, PatchSeries& difference) const;

  const LitScene& lit_;
  std::span<const LitGroup> groups_;
  std::span<const GroupSource> sources_;
  std::span<const RestLight> rests_;
  const RestTransport& transport_;
  std::span<const FrameIndex> frames_;
  TracedLines lines_;
  std::vector<FrameIndex> solved_;
  std::vector<DifferenceLight> of_group_;  ///< at solved_
};

}  // namespace engine
