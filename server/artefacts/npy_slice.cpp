#include "server/artefacts/npy_slice.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "server/text.h"

namespace server {
namespace {

constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);
constexpr std::size_t kPrefixBytes = 10;  // magic and the length of the header text
constexpr std::size_t kAlignment = 64;
constexpr std::int64_t kComponents = 3;
constexpr std::int64_t kFloatBytes = 4;

struct Shape {
  std::int64_t frames = 0;
  std::int64_t patches = 0;
  std::int64_t data_offset = 0;
};

api::Error not_radiosity(std::string_view why) {
  return {api::Fault::internal, "radiosity.npy: " + std::string(why)};
}

/// The number at the front of `text`, which is advanced past it and past the ", " behind it; -1: none.
std::int64_t take_number(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  const std::int64_t value = whole_number(text.substr(0, end)).value_or(-1);
  text.remove_prefix(end);
  while (text.starts_with(',') || text.starts_with(' ')) text.remove_prefix(1);
  return value;
}

api::Result<std::string> read_header(const FileHandle& file) {
  std::array<unsigned char, kPrefixBytes> prefix{};
  if (::pread(file.get(), prefix.data(), prefix.size(), 0) != static_cast<ssize_t>(prefix.size()) ||
      std::string_view(reinterpret_cast<const char*>(prefix.data()), kMagic.size()) != kMagic)
    return not_radiosity("not a .npy file of version 1.0");
  std::string text(static_cast<std::size_t>(prefix[8] | (prefix[9] << 8)), '\0');
  if (::pread(file.get(), text.data(), text.size(), kPrefixBytes) != static_cast<ssize_t>(text.size()))
    return not_radiosity("its header is cut short");
  return text;
}

api::Result<Shape> read_shape(const FileHandle& file) {
  const auto header = read_header(file);
  if (!header) return header.error();
  const std::string_view text = *header;
  constexpr std::string_view kShape = "'shape': (";
  const std::size_t at = text.find(kShape);
  if (text.find("'descr': '<f4'") == text.npos || text.find("'fortran_order': False") == text.npos ||
      at == text.npos)
    return not_radiosity("not an array of float32 in C order");
  std::string_view numbers = text.substr(at + kShape.size());
  Shape shape;
  shape.frames = take_number(numbers);
  shape.patches = take_number(numbers);
  shape.data_offset = static_cast<std::int64_t>(kPrefixBytes + text.size());
  if (shape.frames < 0 || shape.patches < 0 || take_number(numbers) != kComponents ||
      !numbers.starts_with(')'))
    return not_radiosity("not of shape (frames, patches, 3)");
  return shape;
}

std::string header_of(std::int64_t patches) {
  std::string text =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(patches) + ", 3), }";
  const std::size_t unpadded = kPrefixBytes + text.size() + 1;
  text.append((kAlignment - unpadded % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string header(kMagic);
  header += static_cast<char>(text.size() & 0xff);
  header += static_cast<char>(text.size() >> 8);
  return header + text;
}

}  // namespace

api::Result<NpySlice> frame_slice(const FileHandle& file, std::uint32_t frame) {
  const auto shape = read_shape(file);
  if (!shape) return shape.error();
  if (frame >= shape->frames)
    return api::Error{api::Fault::not_found, "there is no frame " + std::to_string(frame)};
  const auto size = size_of(file);
  if (!size) return size.error();
  const std::int64_t data_bytes = *size - shape->data_offset;
  // Divided rather than multiplied: a lying header must not overflow.
  const std::int64_t frame_bytes = data_bytes / shape->frames;
  if (data_bytes % shape->frames != 0 || frame_bytes % (kComponents * kFloatBytes) != 0 ||
      frame_bytes / (kComponents * kFloatBytes) != shape->patches)
    return not_radiosity("its size does not fit its shape");
  return NpySlice{header_of(shape->patches), shape->data_offset + frame_bytes * frame, frame_bytes};
}

}  // namespace server
