#include "engine/output/npy.h"

#include <bit>

namespace engine {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

std::string npy_header(std::string_view dtype, std::span<const std::uint64_t> shape) {
  std::string text = "{'descr': '" + std::string(dtype) + "', 'fortran_order': False, 'shape': (";
  for (const std::uint64_t extent : shape) text += std::to_string(extent) + ", ";
  text += "), }";
  constexpr std::size_t kMagicBytes = 10, kAlignment = 64;
  const std::size_t unpadded = kMagicBytes + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

}  // namespace engine
