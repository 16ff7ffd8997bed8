// Low-discrepancy points with random scrambling, addressed by index.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace engine {

/// Mixes 64 bits; every input bit reaches every output bit. Source: Steele et al., SplitMix64, OOPSLA 2014.
constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A seed for the stream `stream` of `seed`: streams are independent of each other.
constexpr std::uint64_t stream_seed(std::uint64_t seed, std::uint64_t stream) {
  return mix(mix(seed + 0x9e3779b97f4a7c15ull) + (stream + 1) * 0x9e3779b97f4a7c15ull);
}

/// Point `index` of the first four dimensions of Sobol's sequence, Owen-scrambled by `seed`, in [0, 1)^4.
/// Each point alone is uniform over all seeds; any 2^m consecutive points from a multiple of 2^m on are
/// stratified. The order of the points is shuffled too (a nested scramble of the index), so that different
/// seeds pair differently.
/// Sources: Joe & Kuo, direction numbers, 2008; Owen, 1995; hashing as in Burley, "Practical Hash-based Owen
/// Scrambling", JCGT 9(4), 2020, with the permutation of Vegdahl, 2021.
std::array<float, 4> owen_sobol(std::uint32_t index, std::uint64_t seed);

/// Sixteen points side by side, before they are scrambled: [dimension][lane], the first digit in the lowest
/// bit.
struct SobolBits {
  static constexpr std::size_t kCount = 16;
  std::array<std::array<std::uint32_t, kCount>, 4> of{};

  /// Point `index` of the sequence.
  void set(std::size_t lane, std::uint32_t index);
};

/// Sixteen points in [0, 1)^4: [dimension][lane].
struct SobolPoints {
  std::array<std::array<float, SobolBits::kCount>, 4> of;
};

/// A seed for each lane.
using SobolSeeds = std::array<std::uint64_t, SobolBits::kCount>;

/// Owen-scrambles lane k of points[b] by seeds[b][k], as above but for the order of the points: it is that of
/// the sequence, so points 0 .. 2^m - 1 of one seed are stratified. Some 100 operations per lane, sixteen at
/// once.
void scramble(const SobolBits* const* bits, const SobolSeeds* seeds, std::size_t count, SobolPoints* points);

}  // namespace engine
