#include "engine/worker/command_line.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>
#include <vector>

namespace engine {
namespace {

/// An option's name and value, or a plain word (name empty).
struct Word {
  std::string_view name;
  std::string_view value;
};

api::Error usage_error(std::string message) {
  return {api::Fault::invalid_request, std::move(message)};
}

/// Digits only, so that "+5", "5s", "0x5", " 5" and "5.0" are refused instead of half read.
api::Result<std::uint64_t> parse_number(const Word& word, std::uint64_t min, std::uint64_t max) {
  std::uint64_t number = 0;
  const char* const end = word.value.data() + word.value.size();
  const auto [stop, fault] = std::from_chars(word.value.data(), end, number);
  if (fault != std::errc() || stop != end || number < min || number > max)
    return usage_error(std::string(word.name) + " takes a whole number from " + std::to_string(min) + " to " +
                       std::to_string(max) + ", not '" + std::string(word.value) + "'");
  return number;
}

/// Takes the option `name`, which has no value, out of `words`.
api::Result<bool> take_switch(std::string_view name, std::vector<std::string_view>& words) {
  const auto end = std::find(words.begin(), words.end(), "--");
  const auto first = std::find(words.begin(), end, name);
  if (first == end) return false;
  if (std::find(first + 1, end, name) != end) return usage_error(std::string(name) + " is given twice");
  words.erase(first);
  return true;
}

/// Of options that take a value.
api::Result<std::vector<Word>> split_words(std::span<const std::string_view> words) {
  std::vector<Word> split;
  std::set<std::string_view> seen;
  bool options_ended = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (!options_ended && word == "--") {
      options_ended = true;
    } else if (options_ended || !word.starts_with('-') || word == "-") {
      split.push_back({{}, word});
    } else {
      const std::size_t equals = word.find('=');
      const std::string_view name = word.substr(0, equals);
      if (!seen.insert(name).second) return usage_error(std::string(name) + " is given twice");
      if (equals == std::string_view::npos && i + 1 == words.size())
        return usage_error(std::string(name) + " is unknown or lacks its value");
      split.push_back({name, equals == std::string_view::npos ? words[++i] : word.substr(equals + 1)});
    }
  }
  return split;
}

/// Hands every option to `take_option` and checks that exactly one folder is named.
template <class TakeOption>
api::Result<std::filesystem::path> parse_words(std::span<const std::string_view> words,
                                               const TakeOption& take_option) {
  const auto split = split_words(words);
  if (!split) return split.error();
  std::filesystem::path folder;
  for (const Word& word : *split) {
    if (!word.name.empty()) {
      if (const api::Status taken = take_option(word); !taken) return taken.error();
    } else if (word.value.empty() || !folder.empty()) {
      return usage_error("exactly one JOB_FOLDER is needed");
    } else {
      folder = word.value;
    }
  }
  if (folder.empty()) return usage_error("JOB_FOLDER is missing");
  return folder;
}

template <class Number>
api::Status take_number(const Word& word, std::uint64_t min, std::uint64_t max, Number& into) {
  const auto number = parse_number(word, min, max);
  if (!number) return number.error();
  into = static_cast<Number>(*number);
  return api::Done{};
}

api::Status take_process(const Word& word, std::optional<pid_t>& into) {
  return take_number(word, 1, std::numeric_limits<pid_t>::max(), into);
}

api::Result<Command> parse_render(std::span<const std::string_view> words) {
  RenderCommand command;
  std::vector<std::string_view> others(words.begin(), words.end());
  const auto again = take_switch("--again", others);
  if (!again) return again.error();
  command.again = *again;
  const auto sandbox = take_switch("--sandbox", others);
  if (!sandbox) return sandbox.error();
  command.sandbox = *sandbox;
  const auto folder = parse_words(others, [&](const Word& word) -> api::Status {
    if (word.name == "--threads") return take_number(word, 1, kThreadsMax, command.threads);
    if (word.name == "--checkpoint-seconds")
      return take_number(word, 0, kCheckpointSecondsMax, command.checkpoint_seconds);
    if (word.name == "--parent") return take_process(word, command.parent);
    return usage_error("unknown option " + std::string(word.name));
  });
  if (!folder) return folder.error();
  command.job_folder = *folder;
  return Command{command};
}

/// What bounds a command that a server waits for; no other option.
template <class BoundedCommand>
api::Status take_limit(const Word& word, BoundedCommand& command) {
  if (word.name == "--memory-mb")
    return take_number(word, kCheckMemoryMbMin, kCheckMemoryMbMax, command.memory_mb);
  if (word.name == "--seconds") return take_number(word, 1, kCheckSecondsMax, command.seconds);
  if (word.name == "--threads") return take_number(word, 1, kThreadsMax, command.threads);
  if (word.name == "--parent") return take_process(word, command.parent);
  return usage_error("unknown option " + std::string(word.name));
}

api::Result<Command> parse_check(std::span<const std::string_view> words) {
  CheckCommand command;
  std::vector<std::string_view> others(words.begin(), words.end());
  const auto sandbox = take_switch("--sandbox", others);
  if (!sandbox) return sandbox.error();
  command.sandbox = *sandbox;
  const auto preview = take_switch("--preview", others);
  if (!preview) return preview.error();
  command.preview = *preview;
  const auto folder =
      parse_words(others, [&](const Word& word) -> api::Status { return take_limit(word, command); });
  if (!folder) return folder.error();
  command.job_folder = *folder;
  return Command{command};
}

/// It becomes the name of a folder.
bool is_view_name(std::string_view name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
  });
}

api::Result<Command> parse_view(std::span<const std::string_view> words) {
  ViewCommand command;
  std::vector<std::string_view> others(words.begin(), words.end());
  const auto sandbox = take_switch("--sandbox", others);
  if (!sandbox) return sandbox.error();
  command.sandbox = *sandbox;
  const auto folder = parse_words(others, [&](const Word& word) -> api::Status {
    if (word.name != "--name") return take_limit(word, command);
    if (!is_view_name(word.value))
      return usage_error("--name takes 1 to 64 letters, digits, '_' or '-', not '" + std::string(word.value) +
                         "'");
    command.name = word.value;
    return api::Done{};
  });
  if (!folder) return folder.error();
  if (command.name.empty()) return usage_error("--name is missing: which view");
  command.job_folder = *folder;
  return Command{command};
}

api::Result<Command> parse_confine(std::span<const std::string_view> words) {
  ConfineCommand command;
  const auto end = std::find(words.begin(), words.end(), "--");
  if (end == words.end() || end + 1 == words.end()) return usage_error("after -- a PROGRAM is needed");
  command.program = *(end + 1);
  command.arguments.assign(end + 2, words.end());
  const auto split = split_words({words.begin(), end});
  if (!split) return split.error();
  for (const Word& word : *split) {
    if (word.name == "--reads")
      command.reads = word.value;
    else if (word.name == "--writes")
      command.writes = word.value;
    else if (word.name != "--parent")
      return usage_error("confine takes no '" + std::string(word.name.empty() ? word.value : word.name) +
                         "'");
    else if (const api::Status taken = take_process(word, command.parent); !taken)
      return taken.error();
  }
  if (command.reads.empty() || command.writes.empty()) return usage_error("--reads and --writes are needed");
  if (!command.program.is_absolute()) return usage_error("PROGRAM must begin with /");
  return Command{command};
}

/// 2^53 - 1: what JSON carries without rounding.
constexpr std::uint64_t kSeedMax = (std::uint64_t{1} << 53) - 1;

struct BenchName {
  std::string_view name;
  BenchKind kind;
};
constexpr BenchName kBenches[] = {{"paper", BenchKind::paper},
                                  {"limit", BenchKind::limit},
                                  {"scaling", BenchKind::scaling},
                                  {"peers", BenchKind::peers}};

/// An option of `bench NAME`; scenes are those of `paper`, parts and repetitions of what has them.
api::Status take_bench_option(const BenchName& bench, const Word& word, BenchOptions& options) {
  const bool has_parts = !bench_parts(bench.kind).empty();
  const bool repeats = bench.kind != BenchKind::paper;
  if (word.name == "--seed") return take_number(word, 0, kSeedMax, options.seed);
  if (word.name == "--repetitions" && repeats)
    return take_number(word, 1, kBenchRepetitionsMax, options.repetitions);
  if (word.name == "--part" && has_parts) {
    const auto parts = bench_parts(bench.kind);
    if (std::find(parts.begin(), parts.end(), word.value) == parts.end())
      return usage_error("bench " + std::string(bench.name) + " has no part '" + std::string(word.value) +
                         "'");
    options.part = word.value;
  } else if (word.name == "--scene" && bench.kind == BenchKind::paper && !word.value.empty()) {
    options.scene = word.value;
  } else if (word.name == "--out" && !word.value.empty()) {
    options.out_folder = word.value;
  } else if (word.name == "--examples" && !word.value.empty()) {
    options.examples_folder = word.value;
  } else {
    return usage_error("bench " + std::string(bench.name) + " takes no '" +
                       std::string(word.name.empty() ? word.value : word.name) + "'");
  }
  return api::Done{};
}

/// `bench NAME`.
api::Result<Command> parse_bench(std::span<const std::string_view> words) {
  const auto bench = std::find_if(std::begin(kBenches), std::end(kBenches), [&](const BenchName& known) {
    return !words.empty() && known.name == words[0];
  });
  if (bench == std::end(kBenches)) return usage_error("bench knows 'paper', 'limit', 'scaling' and 'peers'");
  BenchCommand command;
  command.options.kind = bench->kind;
  if (bench->kind != BenchKind::paper) command.options.out_folder /= bench->name;
  std::vector<std::string_view> others(words.begin() + 1, words.end());
  const auto quick = take_switch("--quick", others);
  if (!quick) return quick.error();
  command.options.quick = *quick;
  const auto split = split_words(others);
  if (!split) return split.error();
  for (const Word& word : *split)
    if (const auto s = take_bench_option(*bench, word, command.options); !s) return s.error();
  return Command{command};
}

}  // namespace

api::Result<Command> parse_command_line(std::span<const std::string_view> words) {
  for (const std::string_view word : words) {
    if (word == "--") break;
    if (word == "--help" || word == "-h") return Command{HelpCommand{}};
    if (word == "--version") return Command{VersionCommand{}};
  }
  if (words.empty()) return usage_error("say what to do");
  if (words[0] == "render") return parse_render(words.subspan(1));
  if (words[0] == "check") return parse_check(words.subspan(1));
  if (words[0] == "view") return parse_view(words.subspan(1));
  if (words[0] == "confine") return parse_confine(words.subspan(1));
  if (words[0] == "bench") return parse_bench(words.subspan(1));
  return usage_error("unknown command '" + std::string(words[0]) + "'");
}

std::string usage_line() {
  return "usage: keylume render JOB_FOLDER [--again] [--threads N] [--checkpoint-seconds N] [--parent PID]\n"
         "                      [--sandbox]\n"
         "       keylume check JOB_FOLDER [--preview] [--threads N] [--memory-mb N] [--seconds N] [--parent "
         "PID] "
         "[--sandbox]\n"
         "       keylume view JOB_FOLDER --name NAME [--threads N] [--memory-mb N] [--seconds N] [--parent "
         "PID] "
         "[--sandbox]\n"
         "       keylume confine --reads PATH --writes PATH [--parent PID] -- PROGRAM [ARGUMENT...]\n"
         "       keylume bench paper [--scene NAME] [--out FOLDER] [--seed N] [--quick] [--examples FOLDER]\n"
         "       keylume bench limit|scaling|peers [--part NAME] [--repetitions N] [--out FOLDER] [--seed N] "
         "[--quick]\n"
         "                           [--examples FOLDER]\n"
         "       keylume --help | --version\n";
}

std::string help_text() {
  return usage_line() + R"(
render   Solves the job in JOB_FOLDER/input (animation.json, scene.obj and what they name) and leaves
         JOB_FOLDER/artefacts, with manifest.json written last: where it stands, every artefact is whole.
         Appends one line of JSON per step to progress.ndjson and writes report.json, also on failure.
         Where an earlier run was stopped or killed, it goes on from what that left in JOB_FOLDER/checkpoint.
         Where the same job is rendered already, by the same program, and its artefacts are whole, it says so
         and does nothing.
  --again         render it all the same
  --threads N     use N threads instead of all cores; the results are the same bytes
  --checkpoint-seconds N
                  save what a killed run can go on from at least N seconds apart (10)
  --parent PID    for supervisors: end when process PID ends, or when standard input closes
  --sandbox       before the job is read, give up what a run does not need: other files than those of the job
                  folder and the system's libraries, sockets, other processes; report.json says what the
                  kernel could enforce

check    Reads the job, counts its patches and forecasts what a run takes. Says so, and in check.json; touches
         nothing else, so that a run in the same folder goes on and its report.json stays.
  --preview       instead of the forecast leave JOB_FOLDER/preview/preview.npz: the shapes, their motion, cameras
                  and lights, to show the scene before it is lit
  --threads N     forecast for a run with N threads instead of all cores
  --memory-mb N   at most N MiB of memory for the job (2048)
  --seconds N     at most N seconds of processor time (60)
  --parent PID    as for render
  --sandbox       as for render

view     Pictures of a job that is rendered already, without solving it again: JOB_FOLDER/views/NAME.json says
         which camera ({"camera": "front"}, or position, target and vertical_fov_degrees), frames, width, height,
         formats, exposure_stops, tone_map; they are left in JOB_FOLDER/views/NAME, which appears when all are
         whole. Writes NAME.report.json beside it, also on failure.
  --name NAME     letters, digits, '_' and '-'
  --memory-mb N   at most N MiB of memory for the view (16384)
  --seconds N     at most N seconds of processor time (3600)
  --threads N, --parent PID, --sandbox
                  as for render

confine  Runs PROGRAM (a path from / on, no script) in the sandbox of a run, for supervisors: it reads what is
         below one PATH and the system's libraries, writes what is below the other, which is there already, and
         opens no sockets and starts no processes, as far as the kernel can enforce that.
  --reads PATH, --writes PATH
                  a folder or a file
  --parent PID    as for render, without the standard input

bench    Runs jobs as users run them and times them; prints a report and leaves report.md, report.json and
         tables for plots. Takes many minutes; what was run already by the same program is not run again.
         paper    the scenes of the paper that the method follows, its tables beside what comes out
         limit    time and memory to an error in the garage, kernels against raw Embree, images, loading
         scaling  the garage with more patches, frames, moving polygons, threads, lights
         peers    the garage beside Blender Cycles, where `blender` is installed
  --out FOLDER       where (keylume-bench; keylume-bench/limit, ...)
  --scene NAME       paper: one of garage, garage_off, room, office; all of them when not given
  --part NAME        limit: one of load, lines, channels, solve, images; scaling: one of patches, frames,
                     moving, threads, lights; all of them when not given
  --repetitions N    of what is compared by time; not of paper (5)
  --seed N           of all runs (1)
  --quick            large patches and few lines: shows that it works, not how fast
  --examples FOLDER  with garage, room and office (those of the checkout it was built from)

Exit status
   0   render: every artefact is published; check: the job is sound
   1   a bug or an I/O failure, or another worker has the folder; worth another attempt
   2   the job itself is wrong: report.json (of check: check.json) lists the violations
   3   the job asks for more than the limits allow
   4   stopped by SIGTERM or SIGINT, within a second
   6   the disk is full; try again when there is room
  64   wrong command line
)";
}

}  // namespace engine
