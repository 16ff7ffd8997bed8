// How far a sequence is off another one of the same patches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "api/result.h"
#include "engine/base/rgb.h"

namespace engine {

/// Area of each patch  [m^2]; 0 for those that emit and so are left out.
using PatchWeights = std::vector<double>;

/// Area-weighted sums over the patches of one frame, or of many.
struct ErrorSums {
  double weight = 0;     ///< sum of A  [m^2]
  double squares = 0;    ///< sum of A |B^ - B|^2, the mean over the channels  [W^2/m^2]
  double radiosity = 0;  ///< sum of A B of the reference, the mean over the channels  [W]

  ErrorSums& operator+=(const ErrorSums& other);
  double rmse_w_m2() const;  ///< sqrt(squares / weight)
  double mean_w_m2() const;  ///< radiosity / weight
};

ErrorSums compare(const PatchWeights& weights, std::span<const Rgb> values, std::span<const Rgb> reference);

/// A frame of one sequence, and that of another to which it is compared.
struct FramePair {
  std::uint32_t values = 0, reference = 0;
};

/// Sums over the patches of each of `sets`, over `frames` (none given: all, one by one), of radiosity.npy
/// against that of a reference. Errors: of RadiosityFile; invalid_request where numbers of patches differ,
/// or a frame is not there.
api::Result<std::vector<ErrorSums>> compare_sequences(std::span<const PatchWeights> sets,
                                                      const std::filesystem::path& values,
                                                      const std::filesystem::path& reference,
                                                      std::span<const FramePair> frames = {});

/// Writes the mean of two sequences of the same patches and frames. Errors: as above.
api::Status write_mean(const std::filesystem::path& one, const std::filesystem::path& other,
                       const std::filesystem::path& mean);

/// max_c |B^ - B| / max(max_c B, half the mean B) of one patch; `floor`: half the mean B, > 0.
double relative_error(const Rgb& value, const Rgb& reference, double floor_w_m2);

struct SequenceError {
  std::vector<double> rmse_w_m2;   ///< [frame]
  double rmse_average_w_m2 = 0;    ///< mean over the frames, as [P] has it
  double mean_radiosity_w_m2 = 0;  ///< of the reference, area-weighted, all frames
  double largest = 0;              ///< relative_error, over all patches and frames
  double share_beyond = 0;         ///< of patches and frames whose relative_error is more than `tolerance`
};

/// radiosity.npy against that of a reference. Errors: of RadiosityFile; invalid_request where the sequences
/// or `weights` differ in size.
api::Result<SequenceError> sequence_error(const PatchWeights& weights, const std::filesystem::path& values,
                                          const std::filesystem::path& reference, double tolerance);

}  // namespace engine
