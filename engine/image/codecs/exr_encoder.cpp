#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <vector>

#include "engine/image/codecs/functions.h"

namespace engine {
namespace {

/// Between two questions whether to stop; a multiple of EXR's ZIP blocks of 16 rows.
constexpr std::uint32_t kBandRows = 64;
constexpr float kLargestHalf = 65504;

/// Our own loops use the cores; OpenImageIO's and OpenEXR's pools would only get in their way.
void use_one_thread() {
  static const bool once = [] {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    return true;
  }();
  (void)once;
}

OIIO::ImageSpec exr_spec(std::uint32_t width, std::uint32_t height) {
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeHalf);
  spec.attribute("oiio:ColorSpace", "lin_srgb");
  spec.attribute("compression", "zip");
  spec.attribute("DateTime", "");  // not given, it would be the present time
  return spec;
}

CodecOutcome encode(const float* rgb, const OIIO::ImageSpec& spec, StopQuestion stop, ByteTaker file,
                    ByteTaker reason) {
  use_one_thread();
  const auto output = OIIO::ImageOutput::create("exr");
  if (!output) return told(CodecOutcome::failed, reason, OIIO::geterror());
  const auto failed = [&] { return told(CodecOutcome::failed, reason, output->geterror()); };
  OIIO::Filesystem::IOVecOutput memory;
  if (!output->set_ioproxy(&memory) || !output->open("image.exr", spec)) return failed();
  const auto height = static_cast<std::uint32_t>(spec.height);
  const std::size_t row = std::size_t{3} * static_cast<std::size_t>(spec.width);
  std::vector<float> band(row * kBandRows);
  for (std::uint32_t y = 0; y < height; y += kBandRows) {
    if (stop.stop_requested(stop.context)) return CodecOutcome::stopped;
    const std::uint32_t end = std::min(y + kBandRows, height);
    std::transform(rgb + y * row, rgb + end * row, band.begin(),
                   [](float value) { return std::min(value, kLargestHalf); });
    if (!output->write_scanlines(static_cast<int>(y), static_cast<int>(end), 0, OIIO::TypeFloat, band.data()))
      return failed();
  }
  if (!output->close()) return failed();
  const auto& bytes = memory.buffer();
  const bool taken = file.take(file.context, reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return taken ? CodecOutcome::done : CodecOutcome::declined;
}

}  // namespace

CodecOutcome encode_exr_by_library(const float* rgb, std::uint32_t width, std::uint32_t height,
                                   StopQuestion stop, ByteTaker file, ByteTaker reason) noexcept {
  return contained(reason, [&] { return encode(rgb, exr_spec(width, height), stop, file, reason); });
}

}  // namespace engine
