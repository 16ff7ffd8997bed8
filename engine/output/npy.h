// The NumPy array format, version 1.0 (numpy.lib.format): a header, then the elements, C order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace engine {

/// `dtype`: "<f4", "<u4", "|u1", "<U12", ... Its length is a multiple of 64 bytes, as NumPy writes it.
std::string npy_header(std::string_view dtype, std::span<const std::uint64_t> shape);

}  // namespace engine
