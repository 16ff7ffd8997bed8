#include "engine/estimate/estimate_direct.h"

#include <algorithm>
#include <chrono>

#include "engine/direct/direct_checkpoint.h"

namespace engine {
namespace {

/// Shadow rays per light and coarse patch. A patch of metres stands for many fine ones: it gets more rays
/// than one of them, and all of them together are still few.
constexpr std::uint32_t kSamplesPerLight = 32;

/// Patches between two looks at the clock: seconds of work.
constexpr PatchId kPatchesPerBlock = 1024;

/// What took less is done again after a crash rather than saved at once.
constexpr std::chrono::seconds kWorthSaving{5};

/// All patches of the groups before `group`, and those of it before `patch`.
struct Done {
  std::uint64_t group = 0, patch = 0;
};

/// Some of the direct light of the groups, in what is kept of it.
class DirectSteps {
 public:
  DirectSteps(Checkpoints* files, std::vector<LitGroup>& groups) : files_(files), groups_(groups) {}

  void save(Done done) {
    if (!files_) return;
    std::vector<CheckpointPart> parts{part_of_checkpoint(done)};
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!begun(g, done)) break;
      add_parts(groups_[g].direct, parts);
    }
    (void)files_->save(kEstimateDirectName, parts);  // one that fails costs time only if the run is killed
  }

  /// `empty`: what a group's direct light has room for.
  Done load(const DirectLight& empty) {
    if (!files_) return {};
    auto saved = files_->load(kEstimateDirectName);
    Done done;
    if (!saved || !saved->take(done)) return {};
    for (std::size_t g = 0; g < groups_.size() && begun(g, done); ++g) {
      DirectLight found = empty;
      if (!take(*saved, found)) return {};
      groups_[g].direct = std::move(found);
    }
    return done;
  }

 private:
  static bool begun(std::size_t group, Done done) {
    return group < done.group || (group == done.group && done.patch > 0);
  }

  Checkpoints* files_;
  std::vector<LitGroup>& groups_;
};

}  // namespace

api::Status light_estimate_directly(const Animation& animation, const StaticRays& static_rays,
                                    const api::LightingOptions& options,
                                    const EstimateCheckpoints& checkpoints, Estimate& estimate,
                                    const Progress& progress) {
  const auto began = std::chrono::steady_clock::now();
  const auto frames = every_frame(animation);
  const PatchId patches = estimate.patches.count();
  const auto share = [&](std::size_t group, PatchId patch) {
    return (static_cast<double>(group) + static_cast<double>(patch) / patches) /
           static_cast<double>(estimate.groups.size());
  };
  DirectSteps steps(checkpoints.files, estimate.groups);
  Done done;
  for (std::size_t g = 0; g < estimate.groups.size(); ++g) {
    LitGroup& lit = estimate.groups[g];
    const DirectLighter lighter(estimate.patches, animation, lit.group.emission, static_rays, frames,
                                {kSamplesPerLight, 1, options.seed});
    if (g == 0) {
      done = steps.load(lighter.empty());
      if (done.group + done.patch > 0)
        checkpoints.go_on_from(share(done.group, static_cast<PatchId>(done.patch)));
    }
    if (g < done.group) continue;
    auto first = static_cast<PatchId>(g == done.group ? done.patch : 0);
    if (first == 0) lit.direct = lighter.empty();
    for (; first < patches; first += kPatchesPerBlock) {
      const PatchId end = std::min(first + kPatchesPerBlock, patches);
      const Progress part = part_of(progress, share(g, first), share(g, end));
      if (const auto s = lighter.light(first, end, lit.direct, part); !s) return s.error();
      const bool last = end == patches && g + 1 == estimate.groups.size();
      if ((checkpoints.files && checkpoints.files->due()) ||
          (last && std::chrono::steady_clock::now() - began > kWorthSaving))
        steps.save({g, end});
    }
  }
  return api::Done{};
}

}  // namespace engine
