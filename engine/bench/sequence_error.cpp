#include "engine/bench/sequence_error.h"

#include <algorithm>
#include <cmath>

#include "engine/bench/radiosity_file.h"

namespace engine {
namespace {

struct Pair {
  RadiosityFile values, reference;
};

api::Result<Pair> open_pair(const PatchWeights& weights, const std::filesystem::path& values,
                            const std::filesystem::path& reference) {
  auto a = RadiosityFile::open(values);
  if (!a) return a.error();
  auto b = RadiosityFile::open(reference);
  if (!b) return b.error();
  if (a->patch_count() != b->patch_count() || a->frame_count() != b->frame_count() ||
      a->patch_count() != weights.size())
    return api::Error{api::Fault::invalid_request,
                      values.string() + " does not belong to " + reference.string()};
  return Pair{std::move(*a), std::move(*b)};
}

/// Calls back with the values and the reference of every frame in turn.
template <class Visit>
api::Status for_each_frame(Pair& pair, const Visit& visit) {
  for (std::uint32_t frame = 0; frame < pair.values.frame_count(); ++frame) {
    const auto values = pair.values.read(frame);
    if (!values) return values.error();
    const auto reference = pair.reference.read(frame);
    if (!reference) return reference.error();
    visit(*values, *reference);
  }
  return api::Done{};
}

}  // namespace

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) {
  weight += other.weight;
  squares += other.squares;
  radiosity += other.radiosity;
  return *this;
}

double ErrorSums::rmse_w_m2() const {
  return weight > 0 ? std::sqrt(squares / weight) : 0;
}
double ErrorSums::mean_w_m2() const {
  return weight > 0 ? radiosity / weight : 0;
}

ErrorSums compare(const PatchWeights& weights, std::span<const Rgb> values, std::span<const Rgb> reference) {
  ErrorSums sums;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double r = values[i].r - reference[i].r, g = values[i].g - reference[i].g,
                 b = values[i].b - reference[i].b;
    sums.weight += weights[i];
    sums.squares += weights[i] * (r * r + g * g + b * b) / 3;
    sums.radiosity += weights[i] * (reference[i].r + reference[i].g + reference[i].b) / 3;
  }
  return sums;
}

double relative_error(const Rgb& value, const Rgb& reference, double floor_w_m2) {
  const double off = std::max(
      {std::abs(value.r - reference.r), std::abs(value.g - reference.g), std::abs(value.b - reference.b)});
  return off / std::max<double>(max_channel(reference), floor_w_m2);
}

api::Result<SequenceError> sequence_error(const PatchWeights& weights, const std::filesystem::path& values,
                                          const std::filesystem::path& reference, double tolerance) {
  auto pair = open_pair(weights, values, reference);
  if (!pair) return pair.error();
  SequenceError error;
  ErrorSums all;
  const auto sum_up = [&](std::span<const Rgb> a, std::span<const Rgb> b) {
    const ErrorSums sums = compare(weights, a, b);
    error.rmse_w_m2.push_back(sums.rmse_w_m2());
    error.rmse_average_w_m2 += sums.rmse_w_m2() / pair->values.frame_count();
    all += sums;
  };
  if (const auto s = for_each_frame(*pair, sum_up); !s) return s.error();
  error.mean_radiosity_w_m2 = all.mean_w_m2();

  // Relative to the mean of the whole sequence, so a second pass.
  std::uint64_t counted = 0, beyond = 0;
  const auto find_largest = [&](std::span<const Rgb> a, std::span<const Rgb> b) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] == 0) continue;
      const double off = relative_error(a[i], b[i], error.mean_radiosity_w_m2 / 2);
      error.largest = std::max(error.largest, off);
      beyond += off > tolerance;
      ++counted;
    }
  };
  if (const auto s = for_each_frame(*pair, find_largest); !s) return s.error();
  error.share_beyond = counted > 0 ? static_cast<double>(beyond) / static_cast<double>(counted) : 0;
  return error;
}

}  // namespace engine
