// What patches send on, row by row of frames.
#pragma once

#include <span>
#include <vector>

#include "engine/lighting/solve_at_rest.h"
#include "engine/lighting/sources.h"

namespace engine {

/// One group's light in some frames, from what arrives beyond the light of the scene at rest. Rows are
/// [column]; each function may write the row it reads.  [W/m^2]
class CarriedRows {
 public:
  /// frames: [column]. All but them outlive it.
  CarriedRows(const LitScene& lit, const GroupSource& source, const RestLight& rest,
              std::vector<FrameIndex> frames);

  std::uint32_t columns() const { return static_cast<std::uint32_t>(frames_.size()); }

  /// R_f = S_f + rho_f (X_s + D_f)
  void radiosity(PatchId patch, const Rgb* difference, Rgb* to) const;
  /// r_f = R_f - R_s
  void radiosity_difference(PatchId patch, const Rgb* difference, Rgb* to) const;
  /// rho_f D_f
  void reflected(PatchId patch, const Rgb* difference, Rgb* to) const;
  /// Largest channel of rho_f.
  float largest_reflectance(PatchId patch) const;

 private:
  const Rgb* of_direct(const PatchSeries& series, PatchId patch, Rgb* room) const;
  void carry(PatchId patch, const Rgb* difference, Rgb subtracted, Rgb* to) const;
  void carry_keyed(PatchId patch, const Rgb* difference, Rgb subtracted, Rgb* to) const;
  void add_exitance(PatchId patch, Rgb* to) const;

  const LitScene& lit_;
  const GroupSource source_;
  const RestLight& rest_;
  std::vector<FrameIndex> frames_;
  std::vector<std::uint32_t> direct_column_;  ///< [column], in source_.direct
  bool side_by_side_ = true;                  ///< direct_column_ counts up
};

}  // namespace engine
