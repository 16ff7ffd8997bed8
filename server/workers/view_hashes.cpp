#include "server/workers/view_hashes.h"

#include <cstdint>
#include <string>
#include <utility>

#include "server/artefacts/files.h"
#include "server/text.h"

namespace server {
namespace {

constexpr std::int64_t kBytesMax = 16 << 20;
constexpr std::string_view kFirstLine = "keylume view 1\n";
constexpr std::size_t kHashBytes = 64;

/// Up to `end`, which goes too; none: there is no `end`.
std::optional<std::string_view> take_until(std::string_view& rest, char end) {
  const std::size_t at = rest.find(end);
  if (at == rest.npos) return std::nullopt;
  const std::string_view taken = rest.substr(0, at);
  rest.remove_prefix(at + 1);
  return taken;
}

std::optional<std::int64_t> bytes_of(std::string_view digits) {
  const auto bytes = whole_number(digits);
  return bytes && *bytes >= 0 ? bytes : std::nullopt;
}

}  // namespace

// A line for each: hash, bytes, media type, path. The last may have spaces, none has a line's end.
api::Status write_view_hashes(const std::filesystem::path& file, const std::vector<ArtefactFile>& files) {
  std::string text(kFirstLine);
  for (const ArtefactFile& each : files)
    text +=
        each.sha256 + "\t" + std::to_string(each.bytes) + "\t" + each.media_type + "\t" + each.path + "\n";
  return write_durably(file, text);
}

std::optional<std::vector<ArtefactFile>> read_view_hashes(const std::filesystem::path& file) {
  const auto text = read_below(file.parent_path(), file.filename().string(), kBytesMax);
  if (!text || !text->starts_with(kFirstLine)) return std::nullopt;
  std::string_view rest = std::string_view(*text).substr(kFirstLine.size());
  std::vector<ArtefactFile> files;
  while (!rest.empty()) {
    const auto sha256 = take_until(rest, '\t'), digits = take_until(rest, '\t'),
               media = take_until(rest, '\t'), path = take_until(rest, '\n');
    if (!path || sha256->size() != kHashBytes || !is_plain_relative_path(*path)) return std::nullopt;
    const auto bytes = bytes_of(*digits);
    if (!bytes) return std::nullopt;
    files.push_back({std::string(*path), std::string(*media), *bytes, std::string(*sha256)});
  }
  return files;
}

}  // namespace server
