#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

#include "engine/image/codecs/functions.h"

namespace engine {
namespace {

CodecOutcome read(const char* file, const char* format, PixelTaker pixels, ByteTaker reason) {
  const std::unique_ptr<OIIO::ImageInput> image = OIIO::ImageInput::create(format);
  if (!image) return told(CodecOutcome::failed, reason, OIIO::geterror());
  const auto damaged = [&] { return told(CodecOutcome::damaged, reason, image->geterror()); };

  OIIO::ImageSpec spec, wish;
  wish.attribute("oiio:UnassociatedAlpha",
                 1);  // else colours come multiplied by an alpha that means nothing here
  if (!image->open(file, spec, wish)) return damaged();
  unsigned char* const to = pixels.room_for(pixels.context, spec.width, spec.height, spec.nchannels);
  if (to == nullptr) return CodecOutcome::declined;
  const int channels = spec.nchannels >= 3 ? 3 : 1;  // two: grey and alpha
  constexpr OIIO::stride_t kPixelBytes = 3;
  if (!image->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, to, kPixelBytes)) return damaged();
  return CodecOutcome::done;
}

}  // namespace

CodecOutcome read_texture_by_library(const char* file, const char* format, PixelTaker pixels,
                                     ByteTaker reason) noexcept {
  return contained(reason, [&] { return read(file, format, pixels, reason); });
}

}  // namespace engine
