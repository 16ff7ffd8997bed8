// What the kernels make of fixed inputs.
#pragma once

#include <string>
#include <utility>
#include <vector>

using KernelBytes = std::string;
using NamedBytes = std::pair<std::string, KernelBytes>;

// The kernels as compiled for any x86-64, for AVX2 and for AVX-512.
namespace engine_baseline {
std::vector<NamedBytes> run_kernels();
}
namespace engine_avx2 {
std::vector<NamedBytes> run_kernels();
}
namespace engine_avx512 {
std::vector<NamedBytes> run_kernels();
}
