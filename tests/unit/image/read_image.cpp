#include "tests/unit/image/read_image.h"

#include <OpenImageIO/imageio.h>

namespace tests {
namespace {

template <class Sample>
std::vector<Sample> read(const std::filesystem::path& path, OIIO::TypeDesc type) {
  auto input = OIIO::ImageInput::open(path.string());
  if (!input) return {};
  const OIIO::ImageSpec& spec = input->spec();
  std::vector<Sample> samples(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  if (!input->read_image(0, 0, 0, spec.nchannels, type, samples.data())) return {};
  return samples;
}

}  // namespace

std::vector<float> read_floats(const std::filesystem::path& path) {
  return read<float>(path, OIIO::TypeFloat);
}
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path) {
  return read<std::uint8_t>(path, OIIO::TypeUInt8);
}

}  // namespace tests
