#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include "engine/base/durable_file.h"
#include "engine/worker/commands.h"
#include "engine/worker/outcome.h"
#include "engine/worker/sandbox.h"
#include "engine/worker/supervision.h"

namespace engine {

api::ExitCode confine(const ConfineCommand& command) {
  if (command.parent) {
    if (const api::Status bound = bind_to_parent(*command.parent); !bound) return give_up(bound.error());
  }
  std::vector<std::string> words = command.arguments;
  std::vector<char*> argv{const_cast<char*>(command.program.c_str())};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto sandbox =
      enter_sandbox_of(command.program, {.read = {command.reads}, .write = {command.writes}});
  if (!sandbox) return give_up(sandbox.error());
  ::execve(command.program.c_str(), argv.data(), environ);
  return give_up(file_error("run", command.program, errno));
}

}  // namespace engine
