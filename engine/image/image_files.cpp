#include "engine/image/image_files.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <vector>

namespace engine {
namespace {

/// Between two questions whether to stop; a multiple of EXR's ZIP blocks of 16 rows.
constexpr std::uint32_t kBandRows = 64;

/// Our own loops use the cores; OpenImageIO's and OpenEXR's pools would only get in their way.
void use_one_thread() {
  static const bool once = [] {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    return true;
  }();
  (void)once;
}

api::Error encoder_error(const char* format, const std::string& reason) {
  return {api::Fault::internal, "cannot encode " + std::string(format) + ": " + reason};
}

/// Fill(y0, y1) answers the samples of those rows, of the type that `spec` names.
template <class Fill>
api::Result<std::string> encode(const char* format, const OIIO::ImageSpec& spec, OIIO::TypeDesc given,
                                const std::function<bool()>& stop_requested, Fill fill) {
  use_one_thread();
  auto output = OIIO::ImageOutput::create(format);
  if (!output) return encoder_error(format, OIIO::geterror());
  OIIO::Filesystem::IOVecOutput memory;
  if (!output->set_ioproxy(&memory) || !output->open(std::string("image.") + format, spec))
    return encoder_error(format, output->geterror());
  const auto height = static_cast<std::uint32_t>(spec.height);
  for (std::uint32_t y = 0; y < height; y += kBandRows) {
    if (stop_requested()) return api::Error{api::Fault::stopped, "stopped while writing images"};
    const std::uint32_t end = std::min(y + kBandRows, height);
    if (!output->write_scanlines(static_cast<int>(y), static_cast<int>(end), 0, given, fill(y, end)))
      return encoder_error(format, output->geterror());
  }
  if (!output->close()) return encoder_error(format, output->geterror());
  return std::string(memory.buffer().begin(), memory.buffer().end());
}

}  // namespace

api::Result<std::string> encode_exr(const Image& image, const std::function<bool()>& stop_requested) {
  OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeHalf);
  spec.attribute("oiio:ColorSpace", "lin_srgb");
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // not given, it would be the present time
  static constexpr float kLargestHalf = 65504;
  std::vector<Rgb> band(std::size_t{image.width} * kBandRows);
  return encode("exr", spec, OIIO::TypeFloat, stop_requested, [&](std::uint32_t y, std::uint32_t end) {
    std::transform(
        image.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * image.width),
        image.pixels.begin() + static_cast<std::ptrdiff_t>(std::size_t{end} * image.width), band.begin(),
        [](Rgb p) {
          return Rgb{std::min(p.r, kLargestHalf), std::min(p.g, kLargestHalf), std::min(p.b, kLargestHalf)};
        });
    return static_cast<const void*>(band.data());
  });
}

}  // namespace engine
