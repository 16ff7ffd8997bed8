#include "server/settings.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <system_error>

#include "server/text.h"

namespace server {
namespace {

constexpr std::string_view kConfig = "--config";
constexpr std::size_t kLinesMax = 1000;
constexpr std::size_t kFileBytesMax = 64 << 10;

using Settings = std::map<std::string, std::string, std::less<>>;  // "--data" -> its value

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t begin = text.find_first_not_of(kBlanks);
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

const OptionName* option_named(std::span<const OptionName> known, std::string_view name) {
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const OptionName& option) { return option.name == name; });
  return found == known.end() ? nullptr : &*found;
}

api::Result<std::string> contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return api::Error{api::Fault::not_found, "--config: " + path + " cannot be read"};
  std::string text(kFileBytesMax + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) return api::Error{api::Fault::not_found, "--config: " + path + " cannot be read"};
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kFileBytesMax) return wrong_use("--config: " + path + " is longer than 64 KiB");
  return text;
}

/// `where`: "FILE:LINE", for the message.
api::Status take_line(std::string_view line, const std::string& where, std::span<const OptionName> known,
                      Settings& settings) {
  line = without_blanks(line);
  if (line.empty() || line.starts_with('#')) return api::Done{};
  const std::size_t equals = line.find('=');
  if (equals == line.npos) return wrong_use(where + ": not 'name = value'");
  const std::string name = "--" + std::string(without_blanks(line.substr(0, equals)));
  const OptionName* option = option_named(known, name);
  if (!option) return wrong_use(where + ": '" + name.substr(2) + "' is not an option");
  const std::string value(without_blanks(line.substr(equals + 1)));
  std::string& kept = settings[name];
  if (option->kind == OptionKind::list)
    kept += (kept.empty() ? "" : " ") + value;
  else if (kept.empty())
    kept = value;
  else
    return wrong_use(where + ": '" + name.substr(2) + "' is there twice");
  return api::Done{};
}

api::Status take_file(const std::string& path, std::span<const OptionName> known, Settings& settings) {
  const auto text = contents(path);
  if (!text) return text.error();
  std::string_view rest = *text;
  for (std::size_t line = 1; !rest.empty() && line <= kLinesMax; ++line) {
    const std::size_t end = rest.find('\n');
    const api::Status taken =
        take_line(rest.substr(0, end), path + ":" + std::to_string(line), known, settings);
    if (!taken) return taken;
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
  }
  return rest.empty() ? api::Status(api::Done{})
                      : wrong_use("--config: " + path + " has more than 1000 lines");
}

Settings settings_of(std::span<const std::string_view> environment, std::span<const OptionName> known) {
  Settings found;
  for (const OptionName& option : known) {
    const std::string begin = variable_of(option.name) + "=";
    for (const std::string_view each : environment)
      if (each.starts_with(begin) && each.size() > begin.size())
        found[std::string(option.name)] = each.substr(begin.size());
  }
  return found;
}

/// The value that `argv` gives --config; the words are taken out.
api::Result<std::optional<std::string>> take_config(std::vector<std::string_view>& argv) {
  std::optional<std::string> path;
  for (std::size_t i = 0; i < argv.size();) {
    const std::string_view word = argv[i];
    if (word != kConfig && !word.starts_with(std::string(kConfig) + "=")) {
      ++i;
      continue;
    }
    const bool apart = word == kConfig;
    if (apart && i + 1 == argv.size()) return wrong_use("--config: a value is missing");
    path = std::string(apart ? argv[i + 1] : word.substr(kConfig.size() + 1));
    const auto at = argv.begin() + static_cast<std::ptrdiff_t>(i);
    argv.erase(at, at + (apart ? 2 : 1));
  }
  return path;
}

bool has(std::span<const std::string_view> argv, const OptionName& option) {
  const std::string opposite = option.kind == OptionKind::flag ? opposite_of(option.name) : std::string();
  return std::any_of(argv.begin(), argv.end(), [&](std::string_view word) {
    return word.substr(0, word.find('=')) == option.name || (!opposite.empty() && word == opposite);
  });
}

/// As words of a command line. `where`: what to name in messages.
api::Status add_words(const OptionName& option, std::string_view value, const std::string& where,
                      std::vector<std::string>& words) {
  const std::string name(option.name);
  if (option.kind == OptionKind::value) words.push_back(name + "=" + std::string(value));
  if (option.kind == OptionKind::flag) {
    const auto truth = truth_of(value);
    if (!truth) return wrong_use(where + ": must be true or false");
    if (*truth) words.push_back(name);
  }
  if (option.kind != OptionKind::list) return api::Done{};
  constexpr std::string_view kBetween = ", \t";
  while (!value.empty()) {
    const std::size_t end = value.find_first_of(kBetween);
    if (end != 0) words.push_back(name + "=" + std::string(value.substr(0, end)));
    value = end == value.npos ? std::string_view() : value.substr(end + 1);
  }
  return api::Done{};
}

}  // namespace

std::optional<bool> truth_of(std::string_view text) {
  if (text == "true" || text == "1" || text == "yes") return true;
  if (text == "false" || text == "0" || text == "no") return false;
  return std::nullopt;
}

std::string opposite_of(std::string_view flag) {
  return "--no-" + std::string(flag.substr(2));
}

std::string variable_of(std::string_view option) {
  std::string name = "KEYLUME_";
  for (const char c : option.substr(2))
    name += c == '-' ? '_' : static_cast<char>(c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c);
  return name;
}

std::vector<std::string_view> own_environment() {
  std::vector<std::string_view> all;
  for (char** each = ::environ; each && *each; ++each) all.emplace_back(*each);
  return all;
}

api::Result<std::vector<std::string>> with_settings(std::span<const std::string_view> argv,
                                                    std::span<const std::string_view> environment,
                                                    std::span<const OptionName> known) {
  std::vector<std::string_view> given(argv.begin(), argv.end());
  auto path = take_config(given);
  if (!path) return path.error();
  constexpr std::array kOnlyConfig{OptionName{kConfig}};
  if (!*path)
    if (const Settings named = settings_of(environment, kOnlyConfig); !named.empty())
      *path = named.begin()->second;
  Settings of_file;
  if (*path)
    if (const api::Status taken = take_file(**path, known, of_file); !taken) return taken.error();
  const Settings of_environment = settings_of(environment, known);
  std::vector<std::string> words;
  for (const OptionName& option : known) {
    if (has(given, option)) continue;
    const auto variable = of_environment.find(option.name);
    const auto line = of_file.find(option.name);
    api::Status added = api::Done{};
    if (variable != of_environment.end())
      added = add_words(option, variable->second, variable_of(option.name), words);
    else if (line != of_file.end() && !line->second.empty())
      added = add_words(option, line->second, **path + ": " + std::string(option.name.substr(2)), words);
    if (!added) return added.error();
  }
  words.insert(words.end(), given.begin(), given.end());
  return words;
}

}  // namespace server
