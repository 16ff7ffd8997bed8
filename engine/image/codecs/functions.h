// The module's functions. Internal to it.
#pragma once

#include <new>
#include <string_view>

#include "engine/image/codecs/interface.h"

namespace engine {

CodecOutcome encode_exr_by_library(const float* rgb, std::uint32_t width, std::uint32_t height,
                                   StopQuestion stop, ByteTaker file, ByteTaker reason) noexcept;
CodecOutcome read_texture_by_library(const char* file, const char* format, PixelTaker pixels,
                                     ByteTaker reason) noexcept;

inline CodecOutcome told(CodecOutcome outcome, ByteTaker reason, std::string_view why) {
  (void)reason.take(reason.context, why.data(), why.size());
  return outcome;
}

/// No exception leaves the module: the program may be built by another compiler.
template <class Work>
CodecOutcome contained(ByteTaker reason, Work work) noexcept {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return CodecOutcome::no_memory;
  } catch (const std::exception& error) {
    return told(CodecOutcome::failed, reason, error.what());
  } catch (...) {
    return told(CodecOutcome::failed, reason, "unexpected failure");
  }
}

}  // namespace engine
