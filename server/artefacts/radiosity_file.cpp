#include "server/artefacts/radiosity_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "engine/output/array_file.h"

namespace server {

api::Result<RadiosityFile> RadiosityFile::open(const std::filesystem::path& folder, std::string_view name) {
  auto file = open_below(folder, name);
  if (!file) return file.error();
  const auto place = engine::find_npy(file->get());
  if (!place) return place.error();
  if (place->dtype != "<f4" || place->shape.size() != 3 || place->shape[2] != 3)
    return api::Error{api::Fault::internal, std::string(name) + " is not of shape (frames, patches, 3)"};
  RadiosityFile radiosity;
  radiosity.file_ = std::move(*file);
  radiosity.frames_ = place->shape[0];
  radiosity.patches_ = place->shape[1];
  radiosity.offset_ = place->offset_bytes;
  return radiosity;
}

bool RadiosityFile::read(std::uint64_t frame, std::uint64_t first, std::span<float> values) const {
  const std::uint64_t at = offset_ + 3 * sizeof(float) * (frame * patches_ + first);
  return bool(engine::read_at(file_.get(), at, values.data(), values.size_bytes()));
}

void append_number(std::string& text, float value) {
  if (!std::isfinite(value)) {
    text += "null";
    return;
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end.ptr);
}

void append_triple(std::string& text, std::span<const float> rgb) {
  text += '[';
  for (std::size_t c = 0; c < 3; ++c) {
    if (c > 0) text += ',';
    append_number(text, rgb[c]);
  }
  text += ']';
}

}  // namespace server
