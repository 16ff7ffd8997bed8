#include "engine/image/codecs/functions.h"

extern "C" __attribute__((visibility("default"))) const engine::Codecs* keylume_image_codecs() {
  static constexpr engine::Codecs kCodecs{
      .encode_exr = engine::encode_exr_by_library,
      .read_texture = engine::read_texture_by_library,
  };
  return &kCodecs;
}
