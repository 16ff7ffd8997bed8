#include "server/commands.h"

#include <array>
#include <cstdlib>
#include <iostream>

#include "server/text.h"

namespace server {
namespace {

struct Command {
  std::string_view name;
  int (*run)(std::span<const std::string_view> words);
};

constexpr std::array kCommands{
    Command{"token", run_token_command},     Command{"backup", run_backup_command},
    Command{"restore", run_restore_command}, Command{"check", run_check_command},
    Command{"gc", run_gc_command},           Command{"migrate", run_migrate_command},
};

}  // namespace

std::optional<std::string> CommandWords::option(std::string_view name) const {
  const auto found = options.find(name);
  return found == options.end() ? std::nullopt : std::optional(found->second);
}

api::Result<CommandWords> take_apart(std::span<const std::string_view> words,
                                     const std::set<std::string_view>& with_value,
                                     const std::set<std::string_view>& flags) {
  CommandWords found;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word(words[i]);
    if (!word.starts_with("--")) {
      found.plain.push_back(word);
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (flags.contains(name) && equals == word.npos) {
      found.options[name] = "";
      continue;
    }
    if (name != "--data" && !with_value.contains(name))
      return wrong_use("'" + word + "' is not an option here");
    if (equals == word.npos && i + 1 == words.size()) return wrong_use(name + ": a value is missing");
    found.options[name] = equals == word.npos ? std::string(words[++i]) : word.substr(equals + 1);
  }
  const char* const data = std::getenv("KEYLUME_DATA");
  if (!found.has("--data") && data && *data) found.options["--data"] = data;
  if (!found.has("--data")) return wrong_use("--data DIR is missing: the data folder of the service");
  return found;
}

std::optional<int> run_command(std::span<const std::string_view> words) {
  if (words.empty()) return std::nullopt;
  for (const Command& command : kCommands)
    if (words[0] == command.name) return command.run(words.subspan(1));
  return std::nullopt;
}

int refuse_command(const api::Error& error, int exit_code) {
  std::cerr << "keylume-server: " << error.message << "\n";
  return exit_code;
}

}  // namespace server
