#include "engine/image/jpeg_bytes.h"

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

namespace engine {
namespace {

constexpr int kQuality = 90;

/// The library calls `error_exit` and does not expect it to return. Exceptions must not cross its frames.
struct ErrorExit {
  jpeg_error_mgr library;
  std::jmp_buf back;
  char message[JMSG_LENGTH_MAX];
};

void leave(j_common_ptr info) {
  auto* exit = reinterpret_cast<ErrorExit*>(info->err);
  info->err->format_message(info, exit->message);
  std::longjmp(exit->back, 1);
}

void be_silent(j_common_ptr) {}

void set_up(jpeg_compress_struct& info, const ScreenImage& image) {
  info.image_width = image.width;
  info.image_height = image.height;
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, kQuality, TRUE);
  info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = 1;
}

/// False: `exit.message` says why. Nothing in here has a destructor, since it is left by longjmp.
bool encode(const ScreenImage& image, ErrorExit& exit, unsigned char*& bytes, unsigned long& size) {
  jpeg_compress_struct info;
  info.err = jpeg_std_error(&exit.library);
  exit.library.error_exit = leave;
  exit.library.output_message = be_silent;
  if (setjmp(exit.back) != 0) {
    jpeg_destroy_compress(&info);
    return false;
  }
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &bytes, &size);
  set_up(info, image);
  jpeg_start_compress(&info, TRUE);
  const std::size_t row_bytes = std::size_t{3} * image.width;
  while (info.next_scanline < info.image_height) {
    // The library takes rows that it does not change as pointers to what may be changed.
    auto* row = const_cast<JSAMPLE*>(image.samples.data() + info.next_scanline * row_bytes);
    (void)jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  return true;
}

}  // namespace

api::Result<std::string> jpeg_bytes(const ScreenImage& image) {
  ErrorExit exit{};
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const bool done = encode(image, exit, bytes, size);
  std::string file;
  if (done) file.assign(reinterpret_cast<const char*>(bytes), size);
  std::free(bytes);
  if (!done) return api::Error{api::Fault::internal, std::string("cannot encode jpg: ") + exit.message};
  return file;
}

}  // namespace engine
