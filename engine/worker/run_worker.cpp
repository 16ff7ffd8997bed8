#include <cstdio>
#include <string>
#include <variant>

#include "engine/worker/commands.h"
#include "engine/worker/outcome.h"
#include "engine/worker/supervision.h"

namespace engine {
namespace {

api::ExitCode print(const std::string& text) {
  const bool printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  return printed ? api::ExitCode::ok : api::ExitCode::internal;
}

api::ExitCode run_bench(const BenchOptions& options, const Bench& bench) {
  const api::Status status = without_exceptions([&] { return bench(options); });
  if (!status) tell(status.error().message);
  return exit_code_of(status);
}

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

api::ExitCode run_worker(std::span<const std::string_view> words, const Pipeline& pipeline,
                         const Checker& checker, const Bench& bench, const EngineParts& parts) {
  const auto command = parse_command_line(words);
  if (!command) {
    tell(command.error().message);
    std::fputs(usage_line().c_str(), stderr);
    return api::ExitCode::usage;
  }
  settle_in();
  return std::visit(Overloaded{
                        [&](const RenderCommand& given) { return render(given, pipeline, parts); },
                        [&](const CheckCommand& given) { return check(given, checker, parts); },
                        [&](const ViewCommand& given) { return view(given, parts.view); },
                        [](const ConfineCommand& given) { return confine(given); },
                        [&](const BenchCommand& given) { return run_bench(given.options, bench); },
                        [](const HelpCommand&) { return print(help_text()); },
                        [](const VersionCommand&) { return print("keylume " KEYLUME_VERSION "\n"); },
                    },
                    *command);
}

}  // namespace engine
