// What `keylume bench` was asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace engine {

enum class BenchKind {
  paper,    ///< the tables and figures of Besuievsky & Pueyo
  limit,    ///< time and memory to an error, and the kernels against raw Embree
  scaling,  ///< curves over patches, frames, moving polygons, threads, lights
  peers,    ///< against Blender Cycles
};

/// What --part may name, in the order they run; empty: the kind has no parts.
inline constexpr const char* kLimitParts[] = {"load", "lines", "channels", "solve", "images"};
inline constexpr const char* kScalingParts[] = {"patches", "frames", "moving", "threads", "lights"};
constexpr std::span<const char* const> bench_parts(BenchKind kind) {
  if (kind == BenchKind::limit) return kLimitParts;
  if (kind == BenchKind::scaling) return kScalingParts;
  return {};
}

struct BenchOptions {
  BenchKind kind = BenchKind::paper;
  std::filesystem::path out_folder = "keylume-bench";  ///< made
  std::filesystem::path examples_folder = {};          ///< with garage, room and office; empty: of the build
  std::string scene = {};  ///< paper: garage, garage_off, room or office; empty: all of them
  std::string part = {};   ///< limit, scaling: one of bench_parts(kind); empty: all of them
  std::uint64_t seed = 1;  ///< 0 .. 2^53 - 1
  int repetitions = 5;     ///< limit, scaling: of what is compared by time; 1 .. kBenchRepetitionsMax
  bool quick = false;      ///< large patches, few lines, each run once: to see that it works, not to quote
};

inline constexpr int kBenchRepetitionsMax = 99;

}  // namespace engine
