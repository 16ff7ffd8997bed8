// Modules that are not the one looked for.
#include "engine/image/codecs/interface.h"

#ifdef KEYLUME_WITHOUT_SYMBOL
extern "C" int keylume_something_else() {
  return 0;
}
#else
extern "C" const engine::Codecs* keylume_image_codecs() {
  static constexpr engine::Codecs kOld{.version = 0};
  return &kOld;
}
#endif
