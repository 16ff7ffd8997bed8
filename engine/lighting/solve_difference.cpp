#include "engine/lighting/solve_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "engine/lighting/carried_rows.h"
#include "engine/lighting/coarse_exchange.h"
#include "engine/lighting/convergence.h"
#include "engine/lighting/moving_light.h"
#include "engine/lighting/row_kernels.h"

namespace engine {
namespace {

std::vector<FrameIndex> frames_of(const WindowScene& window, const Columns& columns) {
  std::vector<FrameIndex> frames;
  for (const std::uint32_t slot : columns.slots()) frames.push_back(window.frames[slot]);
  return frames;
}

/// Of what lines carry, R_s + r.
Scale scale_of(const WindowScene& window, const CarriedRows& rows, const PatchSeries& r) {
  if (r.patch_count == 0) return {};
  std::vector<double> sums(r.patch_count), largest(r.patch_count), reflectance(r.patch_count);
  for_each_patch(r.patch_count, {}, [&](PatchId patch) {
    for (std::uint32_t c = 0; c < r.frame_count; ++c) {
      const double carried = max_channel(window.rest.radiosity_w_m2[patch] + r.at(patch, c));
      sums[patch] += carried;
      largest[patch] = std::max(largest[patch], carried);
    }
    reflectance[patch] = double{rows.largest_reflectance(patch)};
    sums[patch] *= window.lit.patches.area_m2[patch];
  });
  double area = 0;
  for (const float a : window.lit.patches.area_m2) area += double{a} * r.frame_count;
  return {std::max(0.0, std::accumulate(sums.begin(), sums.end(), 0.0) / area),
          *std::max_element(largest.begin(), largest.end()),
          *std::max_element(reflectance.begin(), reflectance.end())};
}

/// How much of the corrections is taken, of each channel of each column. They are those of the scene at rest,
/// K_G, with reflectances that are means over all frames: where a frame reflects less (K_f), or things that
/// move take the light away, they go too far, and beyond K_G > (1 + K_f) / 2 each further than the last one.
class CorrectionShares {
 public:
  explicit CorrectionShares(std::uint32_t columns) : shares_(3 * std::size_t{columns}, 1.0f) {}

  /// residual: in groups, as this iteration has left it. Where it has not become clearly less, g times as
  /// much as before, an error e became -g e or so, of K_f e - c e with some K_f in (0, 1): a share of the
  /// correction that is K_f / (K_f + g) of the last one would have left none.
  void look_at(const PatchSeries& residual) {
    constexpr float kClearlyLess = 0.7f, kReflected = 0.5f;
    std::vector<float> largest(shares_.size(), 0.0f);
    for (std::uint32_t group = 0; group < residual.patch_count; ++group)
      for (std::size_t k = 0; k < largest.size(); ++k)
        largest[k] = std::max(largest[k], std::abs((&residual.row(group)->r)[k]));
    for (std::size_t k = 0; k < shares_.size() && !last_.empty(); ++k) {
      const float grown = last_[k] > 0 ? largest[k] / last_[k] : 0.0f;
      if (grown > kClearlyLess) shares_[k] *= kReflected / (kReflected + grown);
    }
    last_ = std::move(largest);
  }
  void take_of(PatchSeries& correction) const {
    for (std::uint32_t group = 0; group < correction.patch_count; ++group)
      for (std::size_t k = 0; k < shares_.size(); ++k) (&correction.row(group)->r)[k] *= shares_[k];
  }

 private:
  std::vector<float> shares_, last_;
};

/// Iterates r <- s + rho D, D = M (R_s + r) + T_s r.
class DifferenceSolver {
 public:
  DifferenceSolver(const WindowScene& window, const Columns& columns)
      : window_(window),
        columns_(columns),
        at_rest_(window.transport.lines),
        moving_lines_(window.lines),
        coarse_(window.transport.coarse),
        rows_(window.lit, window.source, window.rest, frames_of(window, columns)),
        moving_(window.lines, columns, window.rest.radiosity_w_m2, rows_),
        shares_(columns.count()),
        r_(window.lit.patches.count(), columns.count()) {
    for (const PatchId patch : coarse_.others())
      if (window.lines.crossings.moving_row[patch] == kNoPatch) alone_.push_back(patch);
    light_.irradiance_w_m2 = PatchSeries(r_.patch_count, columns.count());
    for_each_patch(r_.patch_count, {}, [&](PatchId patch) { carry_on(patch); });
    scale_ = scale_of(window, rows_, r_);
  }

  api::Status iterate(const Progress& progress) {
    ConvergenceTest test(window_.enough);
    double change = kFirstChange * scale_.mean;
    for (;;) {
      const auto of_moving =
          moving_.solve(static_cast<float>(kMovingChange * change), light_.irradiance_w_m2, r_);
      PatchSeries residual(coarse_.group_count(), columns_.count());
      const auto at_rest = gather(residual, progress);
      if (!at_rest) return at_rest.error();
      change = std::max(*at_rest, of_moving);
      PatchSeries correction = coarse_.correction(residual);
      test.add(change, largest_value(correction), scale_, light_.convergence);
      if (!std::isfinite(light_.convergence.error_left))
        return api::Error{api::Fault::internal,
                          "the light that differs from the scene at rest grew without end"};
      progress.report(test.fraction(light_.convergence));
      if (test.may_end(light_.convergence)) return api::Done{};
      shares_.look_at(residual);
      shares_.take_of(correction);
      carry_on(correction);
    }
  }

  /// Y = T_s (rho D); r is not needed any more.
  void find_carried() {
    for_each_patch(r_.patch_count, {}, [&](PatchId patch) {
      rows_.reflected(patch, light_.irradiance_w_m2.row(patch), r_.row(patch));
    });
    light_.carried_w_m2 = PatchSeries(r_.patch_count, columns_.count());
    for_each_patch(r_.patch_count, {}, [&](PatchId patch) {
      at_rest_.gather_at_rest(r_, patch, light_.carried_w_m2.row(patch));
    });
  }

  DifferenceLight take() { return std::move(light_); }

 private:
  /// D of all patches, and the residual s + rho D - r, in groups; answers its largest value.
  api::Result<float> gather(PatchSeries& residual, const Progress& progress) {
    std::vector<float> changes(coarse_.group_count() + 1);
    const bool went_on = for_each_group(coarse_, progress, [&](std::uint32_t group) {
      for (const PatchId patch : coarse_.members(group))
        changes[group] = std::max(changes[group], gather(patch, residual.row(group)));
    });
    if (!went_on) return api::Error{api::Fault::stopped, "stopped while solving"};
    std::vector<Rgb> of_none(columns_.count());
    for (const PatchId patch : alone_)
      changes.back() = std::max(changes.back(), gather(patch, of_none.data()));
    return *std::max_element(changes.begin(), changes.end());
  }

  float gather(PatchId patch, Rgb* residual_of_group) {
    Rgb* arriving = light_.irradiance_w_m2.row(patch);
    at_rest_.gather_at_rest(r_, patch, arriving);
    moving_lines_.add_moving(window_.rest.radiosity_w_m2, r_, columns_, patch, arriving);
    std::array<Rgb, kWindowMax> next;
    rows_.radiosity_difference(patch, arriving, next.data());
    return add_changes(&r_.row(patch)->r, &next[0].r, coarse_.share(patch), 3 * std::size_t{columns_.count()},
                       &residual_of_group->r);
  }

  void carry_on(PatchId patch) {
    rows_.radiosity_difference(patch, light_.irradiance_w_m2.row(patch), r_.row(patch));
  }

  /// r for the next iteration.
  void carry_on(const PatchSeries& correction) {
    (void)for_each_group(coarse_, {}, [&](std::uint32_t group) {
      const Rgb* of_group = correction.row(group);
      for (const PatchId patch : coarse_.members(group)) {
        carry_on(patch);
        Rgb* r = r_.row(patch);
        for (std::uint32_t c = 0; c < columns_.count(); ++c) r[c] += of_group[c];
      }
    });
    for (const PatchId patch : alone_) carry_on(patch);
  }

  /// Of the mean: what the first iteration changes, about; and of what iterations change the rest: what is
  /// left to do between patches that move.
  static constexpr double kFirstChange = 0.05, kMovingChange = 0.05;

  const WindowScene& window_;
  const Columns& columns_;
  const SampledOperator at_rest_, moving_lines_;
  const CoarseExchange& coarse_;
  const CarriedRows rows_;
  MovingLight moving_;
  CorrectionShares shares_;
  std::vector<PatchId> alone_;  ///< at rest, and in no group since no line of T_s met them
  PatchSeries r_;
  Scale scale_;
  DifferenceLight light_;
};

}  // namespace

PatchSeries source_difference(const WindowScene& window, const Columns& columns) {
  const CarriedRows rows(window.lit, window.source, window.rest, frames_of(window, columns));
  PatchSeries r(window.lit.patches.count(), columns.count());
  for_each_patch(r.patch_count, {},
                 [&](PatchId patch) { rows.radiosity_difference(patch, r.row(patch), r.row(patch)); });
  return r;
}

api::Result<DifferenceLight> solve_difference(const WindowScene& window, const Columns& columns,
                                              const Progress& progress, Carried carried) {
  DifferenceSolver solver(window, columns);
  if (const auto s = solver.iterate(progress); !s) return s.error();
  if (carried == Carried::wanted) solver.find_carried();
  return solver.take();
}

}  // namespace engine
