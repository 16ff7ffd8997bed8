// What keylume-server does besides serving: keylume-server COMMAND ... --data DIR.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/result.h"

namespace server {

// As in sysexits.h.
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 64;
inline constexpr int kExitUnavailable = 69;
inline constexpr int kExitInUse = 75;

/// The words of a command, taken apart.
struct CommandWords {
  std::vector<std::string> plain;
  std::map<std::string, std::string, std::less<>> options;  ///< "--data" -> its value; flags have ""

  std::optional<std::string> option(std::string_view name) const;
  bool has(std::string_view name) const { return options.contains(name); }
};

/// `with_value`, `flags`: the options that the command knows, with their dashes. --data DIR is always known,
/// and must be given, if not by KEYLUME_DATA. Errors: invalid_request naming the word.
api::Result<CommandWords> take_apart(std::span<const std::string_view> words,
                                     const std::set<std::string_view>& with_value,
                                     const std::set<std::string_view>& flags);

/// Runs the command that `words` begin with, argv without the program's name. -> exit code; none: they begin
/// with no command.
std::optional<int> run_command(std::span<const std::string_view> words);

/// Says the error, in the way of this program. -> `exit_code`
int refuse_command(const api::Error& error, int exit_code);

/// The commands, each with the words that follow its name. -> exit code
int run_token_command(std::span<const std::string_view> words);
int run_backup_command(std::span<const std::string_view> words);
int run_restore_command(std::span<const std::string_view> words);
int run_check_command(std::span<const std::string_view> words);
int run_gc_command(std::span<const std::string_view> words);
int run_migrate_command(std::span<const std::string_view> words);
/// `words` have been through with_settings.
int run_health_command(std::span<const std::string_view> words);

}  // namespace server
