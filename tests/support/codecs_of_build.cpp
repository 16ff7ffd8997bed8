// Tests lie in other folders than the programs, so they are told where the module of codecs is.
#include "engine/image/load_codecs.h"

namespace {

const bool kTold = [] {
  engine::use_codecs(KEYLUME_CODECS);
  return true;
}();

}  // namespace
