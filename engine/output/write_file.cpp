#include "engine/base/durable_file.h"
#include "engine/output/artefacts.h"

namespace engine {

api::Status write_file(const std::filesystem::path& path, std::string_view bytes) {
  auto file = DurableFile::create(path);
  if (!file) return file.error();
  if (auto written = file->append(bytes); !written) return written;
  if (auto published = file->publish(); !published) return published;
  return sync_folder(path.parent_path());
}

}  // namespace engine
