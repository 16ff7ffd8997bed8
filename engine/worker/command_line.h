// What the user typed, checked: `keylume render|check JOB_FOLDER ...`, `keylume bench KIND ...`.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "api/result.h"
#include "engine/bench/bench_options.h"

namespace engine {

inline constexpr unsigned kThreadsMax = 1024;
inline constexpr std::uint64_t kCheckpointSecondsMax = 86'400;
inline constexpr std::uint64_t kCheckMemoryMbMin = 64;
inline constexpr std::uint64_t kCheckMemoryMbMax = 1u << 20;
inline constexpr std::uint64_t kCheckSecondsMax = 86'400;

struct RenderCommand {
  std::filesystem::path job_folder = {};
  unsigned threads = 0;              ///< 0: all cores; 1 .. kThreadsMax
  unsigned checkpoint_seconds = 10;  ///< [s] between checkpoints, at least; 0 .. kCheckpointSecondsMax
  bool again = false;                ///< also where an earlier run has left all there is to make
  bool sandbox = false;              ///< enter_sandbox before anything of the job is read
  std::optional<pid_t> parent = {};  ///< --parent: end when this process ends, or when standard input closes
};

struct CheckCommand {
  std::filesystem::path job_folder = {};
  std::uint64_t memory_mb = 2048;    ///< [MiB] for the job; kCheckMemoryMbMin .. kCheckMemoryMbMax
  std::uint64_t seconds = 60;        ///< [s] of processor time, over all threads; 1 .. kCheckSecondsMax
  unsigned threads = 0;              ///< that the forecast is for; 0: all cores; 1 .. kThreadsMax
  bool preview = false;              ///< write preview/preview.npz, and no forecast
  bool sandbox = false;              ///< enter_sandbox before anything of the job is read
  std::optional<pid_t> parent = {};  ///< --parent: end when this process ends, or when standard input closes
};

struct ViewCommand {
  std::filesystem::path job_folder = {};
  std::string name = {};             ///< 1 .. 64 letters, digits, '_' or '-'
  std::uint64_t memory_mb = 16'384;  ///< [MiB]; kCheckMemoryMbMin .. kCheckMemoryMbMax
  std::uint64_t seconds = 3600;      ///< [s] of processor time, over all threads; 1 .. kCheckSecondsMax
  unsigned threads = 0;              ///< 0: all cores; 1 .. kThreadsMax
  std::optional<pid_t> parent = {};  ///< --parent: end when this process ends, or when standard input closes
  bool sandbox = false;              ///< as of a run
};

/// A program of others', shut in.
struct ConfineCommand {
  std::filesystem::path program = {};
  std::vector<std::string> arguments = {};
  std::filesystem::path reads = {};   ///< a folder or a file, beside the system's libraries
  std::filesystem::path writes = {};  ///< the same; it must be there
  std::optional<pid_t> parent = {};   ///< --parent: end when this process ends
};

struct BenchCommand {
  BenchOptions options;
};

struct HelpCommand {};
struct VersionCommand {};

using Command = std::variant<RenderCommand, CheckCommand, ViewCommand, ConfineCommand, BenchCommand,
                             HelpCommand, VersionCommand>;

/// `words` are argv without the program's name. Options may stand before or after the folder, as
/// `--threads 2` or `--threads=2`; after `--` every word is a folder, or
/// what `confine` is to run. Each option at most once.
/// Errors: invalid_request, the message names the word that is wrong.
api::Result<Command> parse_command_line(std::span<const std::string_view> words);

std::string usage_line();  ///< for standard error, after the message
std::string help_text();   ///< for standard output

}  // namespace engine
