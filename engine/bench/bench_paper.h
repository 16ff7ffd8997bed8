// `keylume bench paper`: the tables and figures of Besuievsky & Pueyo, and what Keylume makes of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "api/result.h"

namespace engine {

struct BenchOptions {
  std::filesystem::path out_folder = "keylume-bench";  ///< made
  std::filesystem::path examples_folder = {};          ///< with garage, room and office; empty: of the build
  std::string scene = {};  ///< garage, garage_off, room or office; empty: all of them
  std::uint64_t seed = 1;  ///< 0 .. 2^53 - 1
  bool quick = false;      ///< large patches, few lines, each run once: to see that it works, not to quote
};

/// Runs the garage (every frame, Table 1 at .1 and .2, our default), the garage with a light off, the office
/// and the room as jobs of their own, each in a process `program` render FOLDER, so that times and memory are
/// those of a user's job. Leaves in out_folder: report.json, report.md, runs.csv, rmse.csv, probes.csv,
/// key_frames.csv, jobs/NAME with artefacts; prints report.md. They are written after each scene, and runs
/// that are there already from the same program and job are not run again. Errors: not_found without the
/// examples; what a job fails with.
api::Status bench_paper(const BenchOptions& options, const std::filesystem::path& program);

/// The program that is running.
std::filesystem::path this_program();

}  // namespace engine
