#include "engine/image/image_files.h"

#include <new>

#include "engine/image/load_codecs.h"

namespace engine {
namespace {

bool append(void* text, const char* bytes, std::size_t count) noexcept {
  try {
    static_cast<std::string*>(text)->append(bytes, count);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

}  // namespace

api::Result<std::string> encode_exr(const Image& image, const std::function<bool()>& stop_requested) {
  static_assert(sizeof(Rgb) == 3 * sizeof(float));
  const auto codecs = image_codecs();
  if (!codecs) return codecs.error();
  const StopQuestion stop{&stop_requested, [](const void* asked) noexcept {
                            return (*static_cast<const std::function<bool()>*>(asked))();
                          }};
  std::string file, reason;
  const CodecOutcome outcome = (*codecs)->encode_exr(&image.pixels.data()->r, image.width, image.height, stop,
                                                     {&file, append}, {&reason, append});
  switch (outcome) {
    case CodecOutcome::done:
      return file;
    case CodecOutcome::stopped:
      return api::Error{api::Fault::stopped, "stopped while writing images"};
    case CodecOutcome::declined:
    case CodecOutcome::no_memory:
      throw std::bad_alloc();
    case CodecOutcome::damaged:
    case CodecOutcome::failed:
      break;
  }
  return api::Error{api::Fault::internal, "cannot encode exr: " + reason};
}

}  // namespace engine
