#include <optional>
#include <vector>

#include "api/fault_point.h"
#include "engine/base/parallel.h"
#include "engine/base/sha256.h"
#include "engine/output/artefacts.h"

namespace engine {
namespace {

/// A JSON string (RFC 8259, section 7). `text` is UTF-8.
std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      out += "\\u00";
      out += "0123456789abcdef"[byte >> 4];
      out += "0123456789abcdef"[byte & 15];
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace

api::Status write_manifest(const std::filesystem::path& folder, std::span<const Artefact> artefacts) {
  std::vector<std::optional<api::Result<FileDigest>>> digests(artefacts.size());
  parallel_for(artefacts.size(),
               [&](std::size_t k) { digests[k] = digest_file(folder / artefacts[k].path); });
  std::string json = "{\"artefacts\":[";
  const char* separator = "\n";
  for (std::size_t k = 0; k < artefacts.size(); ++k) {
    const Artefact& artefact = artefacts[k];
    const api::Result<FileDigest>& digest = *digests[k];
    if (!digest) return digest.error();
    json += separator;
    json += "{\"path\":" + json_string(artefact.path) +
            ",\"media_type\":" + json_string(artefact.media_type) +
            ",\"bytes\":" + std::to_string(digest->bytes) + ",\"sha256\":\"" + digest->sha256 + "\"}";
    separator = ",\n";
  }
  api::fault_point("manifest_due");
  return write_file(folder / "manifest.json", json + "\n]}\n");
}

}  // namespace engine
