#include "engine/output/half_floats.h"

#include <algorithm>
#include <bit>

#include "engine/base/widest.h"

namespace engine {
namespace {

constexpr std::uint32_t kSignBit = 0x80000000u;
constexpr std::uint32_t kDroppedBits = 13;                 // of the fraction: 23 - 10
constexpr std::uint32_t kExponentBias = (127 - 15) << 23;  // between those of both formats
constexpr std::uint32_t kLeastNormal = std::bit_cast<std::uint32_t>(0x1p-14f);
/// Its last place is the least half float, 2^-24: a sum with it is rounded as a subnormal half float is.
constexpr float kSubnormalStep = 0.5f;

}  // namespace

// No branches. Floats that are not negative are compared as the integers of their bits.
KEYLUME_WIDEST void to_half_floats(const float* __restrict values, std::size_t count, float factor,
                                   std::uint16_t* __restrict out) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(values[k] * factor);
    const auto magnitude = static_cast<std::uint32_t>(
        std::min(static_cast<std::int32_t>(bits & ~kSignBit), std::bit_cast<std::int32_t>(kHalfMax)));
    // Half of what is dropped, less one where the last place that stays is even.
    const std::uint32_t rounding = (1u << (kDroppedBits - 1)) - 1 + ((magnitude >> kDroppedBits) & 1);
    const std::uint32_t normal = (magnitude - kExponentBias + rounding) >> kDroppedBits;
    const std::uint32_t subnormal =
        std::bit_cast<std::uint32_t>(std::bit_cast<float>(magnitude) + kSubnormalStep) -
        std::bit_cast<std::uint32_t>(kSubnormalStep);
    const std::uint32_t is_normal = -static_cast<std::uint32_t>(magnitude >= kLeastNormal);
    out[k] =
        static_cast<std::uint16_t>((is_normal & normal) | (~is_normal & subnormal) | (bits & kSignBit) >> 16);
  }
}

}  // namespace engine
