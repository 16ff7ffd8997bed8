#include "engine/output/npz_arrays.h"

namespace engine {
namespace {

constexpr std::size_t kNameCharactersMax = 256;  // one long name must not widen all the others

/// How many bytes follow the first one of a UTF-8 sequence (RFC 3629, section 4); -1 where none can begin.
int following_bytes(unsigned char lead) {
  if (lead < 0x80) return 0;
  if (lead < 0xc2) return -1;
  if (lead < 0xe0) return 1;
  if (lead < 0xf0) return 2;
  return lead < 0xf5 ? 3 : -1;
}

/// UTF-8 -> code points, at most kNameCharactersMax; what is no UTF-8 becomes U+FFFD.
std::u32string code_points(std::string_view utf8) {
  std::u32string out;
  for (std::size_t i = 0; i < utf8.size() && out.size() < kNameCharactersMax;) {
    const auto lead = static_cast<unsigned char>(utf8[i++]);
    const int following = following_bytes(lead);
    if (following < 0) {
      out += U'\ufffd';
      continue;
    }
    char32_t point = following == 0 ? lead : lead & (0x3fu >> following);
    int seen = 0;
    while (seen < following && i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xc0) == 0x80) {
      point = point << 6 | (static_cast<unsigned char>(utf8[i++]) & 0x3f);
      ++seen;
    }
    const bool valid = seen == following && point <= 0x10ffff && (point < 0xd800 || point > 0xdfff);
    out += valid ? point : U'\ufffd';
  }
  return out;
}

/// The pose of an object in a frame; none where it is not there.
const Pose* pose_at(const ObjectMotion& motion, FrameIndex frame) {
  const auto after = std::upper_bound(motion.spans.begin(), motion.spans.end(), frame,
                                      [](FrameIndex f, const PoseSpan& span) { return f < span.first; });
  if (after == motion.spans.begin() || std::prev(after)->last < frame) return nullptr;
  return &std::prev(after)->pose;
}

}  // namespace

api::Status write_names(ZipStore& zip, std::string_view array, std::span<const std::string_view> names) {
  std::size_t width = 1;
  for (const std::string_view name : names) width = std::max(width, code_points(name).size());
  const std::array<std::uint64_t, 1> shape{names.size()};
  return write_array<char32_t>(zip, array, "<U" + std::to_string(width), shape, width,
                               [&](std::uint64_t row, char32_t* out) {
                                 const std::u32string name = code_points(names[row]);
                                 std::fill_n(out, width, U'\0');  // NumPy pads with zeros
                                 std::copy(name.begin(), name.end(), out);
                               });
}

void ArrayWriter::add_names(std::string_view name, std::span<const std::string_view> names) {
  then([&](ZipStore& zip) { return write_names(zip, name, names); });
}

template <class Number>
void add_motion(ArrayWriter& arrays, const Animation& animation) {
  const FrameIndex frames = animation.frame_count;
  arrays.add<Number>("poses", {animation.objects.size(), frames, 3, 4},
                     [&](std::uint64_t object, Number* out) {
                       for (FrameIndex f = 0; f < frames; ++f) {
                         const Pose* pose = pose_at(animation.objects[object], f);
                         const Pose written = pose ? *pose : Pose{};
                         for (const auto& row : written.m)
                           for (const double value : row) *out++ = static_cast<Number>(value);
                       }
                     });
  arrays.add<std::uint8_t>("visible", {animation.objects.size(), frames},
                           [&](std::uint64_t object, std::uint8_t* out) {
                             for (FrameIndex f = 0; f < frames; ++f)
                               out[f] = pose_at(animation.objects[object], f) != nullptr;
                           });
}

template void add_motion<float>(ArrayWriter&, const Animation&);
template void add_motion<double>(ArrayWriter&, const Animation&);

}  // namespace engine
