#include "engine/base/sobol.h"

#include "engine/base/widest.h"

namespace engine {
namespace {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// A permutation in which each bit is changed by lower bits only; on reversed bits it is an Owen scramble.
constexpr std::uint32_t permute_upward(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  return reverse_bits(permute_upward(reverse_bits(x), seed));
}

using Directions = std::array<std::uint32_t, 32>;

/// Direction numbers of a primitive polynomial of degree `degree`, coefficients `a`, initial values `m`.
constexpr Directions directions(unsigned degree, std::uint32_t a, std::array<std::uint32_t, 3> m) {
  Directions v{};
  for (unsigned i = 0; i < 32; ++i) {
    if (i < degree) {
      v[i] = m[i] << (31 - i);
      continue;
    }
    v[i] = v[i - degree] ^ (v[i - degree] >> degree);
    for (unsigned k = 1; k < degree; ++k)
      if ((a >> (degree - 1 - k)) & 1) v[i] ^= v[i - k];
  }
  return v;
}

constexpr Directions first_dimension() {
  Directions v{};
  for (unsigned i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
  return v;
}

// Joe & Kuo's table: dimension 2 (s=1, a=0, m=1), 3 (s=2, a=1, m=1 3), 4 (s=3, a=1, m=1 3 1).
constexpr std::array<Directions, 4> kDirections{first_dimension(), directions(1, 0, {1, 0, 0}),
                                                directions(2, 1, {1, 3, 0}), directions(3, 1, {1, 3, 1})};

// Byte-wise tables: the exclusive or of the directions that one byte of the index selects.
using ByteTables = std::array<std::array<std::array<std::uint32_t, 256>, 4>, 4>;

constexpr ByteTables byte_tables() {
  ByteTables tables{};
  for (unsigned d = 0; d < 4; ++d)
    for (unsigned byte = 0; byte < 4; ++byte)
      for (unsigned value = 0; value < 256; ++value) {
        std::uint32_t x = 0;
        for (unsigned bit = 0; bit < 8; ++bit)
          if ((value >> bit) & 1) x ^= kDirections[d][8 * byte + bit];
        tables[d][byte][value] = x;
      }
  return tables;
}

constexpr ByteTables kTables = byte_tables();

/// A seed of 32 bits from one of 64 that has been mixed, by dimension. The multiplications are those of
/// MurmurHash3's last step.
inline std::uint32_t dimension_seed(std::uint32_t low, std::uint32_t high, std::uint32_t dimension) {
  std::uint32_t x = low + dimension * 0x9e3779b9u;
  x = (x ^ (x >> 16)) * 0x85ebca6bu;
  x = (x ^ (x >> 13) ^ high) * 0xc2b2ae35u;
  return x ^ (x >> 16);
}

}  // namespace

void SobolBits::set(std::size_t lane, std::uint32_t index) {
  for (unsigned d = 0; d < 4; ++d) {
    const auto& table = kTables[d];
    of[d][lane] = reverse_bits(table[0][index & 255] ^ table[1][(index >> 8) & 255] ^
                               table[2][(index >> 16) & 255] ^ table[3][index >> 24]);
  }
}

KEYLUME_WIDEST
void scramble(const SobolBits* const* bits, const SobolSeeds* seeds, std::size_t count, SobolPoints* points) {
  constexpr std::size_t kLanes = SobolBits::kCount;
  for (std::size_t b = 0; b < count; ++b) {
    std::array<std::uint32_t, kLanes> low, high;
    for (std::size_t k = 0; k < kLanes; ++k) {
      low[k] = static_cast<std::uint32_t>(seeds[b][k]);
      high[k] = static_cast<std::uint32_t>(seeds[b][k] >> 32);
    }
    for (std::uint32_t d = 0; d < 4; ++d)
      for (std::size_t k = 0; k < kLanes; ++k) {
        const std::uint32_t seed = dimension_seed(low[k], high[k], d);
        const std::uint32_t x = reverse_bits(permute_upward(bits[b]->of[d][k], seed));
        points[b].of[d][k] = static_cast<float>(static_cast<std::int32_t>(x >> 8)) * 0x1p-24f;
      }
  }
}

std::array<float, 4> owen_sobol(std::uint32_t index, std::uint64_t seed) {
  const std::uint32_t shuffled =
      reverse_bits(permute_upward(reverse_bits(index), static_cast<std::uint32_t>(seed)));
  std::array<float, 4> point;
  std::uint64_t stream = seed;
  for (unsigned d = 0; d < 4; ++d) {
    const auto& table = kTables[d];
    const std::uint32_t x = table[0][shuffled & 255] ^ table[1][(shuffled >> 8) & 255] ^
                            table[2][(shuffled >> 16) & 255] ^ table[3][shuffled >> 24];
    stream = mix(stream + 0x9e3779b97f4a7c15ull);
    const std::uint32_t scrambled = owen_scramble(x, static_cast<std::uint32_t>(stream >> 32));
    point[d] = static_cast<float>(scrambled >> 8) * 0x1p-24f;  // 24 bits: stays below 1
  }
  return point;
}

}  // namespace engine
