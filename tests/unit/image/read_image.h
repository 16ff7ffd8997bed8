// Images read back, by the library that others read them with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tests {

/// Row by row, all channels of a pixel together. Empty when the file cannot be read.
std::vector<float> read_floats(const std::filesystem::path& path);
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path);

}  // namespace tests
