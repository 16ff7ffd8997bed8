#include <algorithm>
#include <array>

#include "engine/base/durable_file.h"
#include "engine/output/artefacts.h"
#include "engine/output/npy.h"
#include "engine/output/zip_store.h"

namespace engine {
namespace {

constexpr std::size_t kBufferBytes = 1u << 20;
constexpr std::size_t kNameCharactersMax = 256;  // one long name must not widen all the others

/// One array of the archive: rows of `Element`s, written through a small buffer.
/// `fill_row(row, elements)` sets the `row_elements` elements of a row.
template <class Element, class FillRow>
api::Status write_array(ZipStore& zip, std::string_view name, std::string_view dtype,
                        std::span<const std::uint64_t> shape, std::size_t row_elements, FillRow fill_row) {
  const std::string header = npy_header(dtype, shape);
  const std::uint64_t size_bytes = header.size() + shape[0] * row_elements * sizeof(Element);
  if (auto begun = zip.begin(std::string(name) + ".npy", size_bytes); !begun) return begun;
  if (auto written = zip.append(header); !written) return written;

  const std::size_t block = std::max<std::size_t>(1, kBufferBytes / (row_elements * sizeof(Element) + 1));
  std::vector<Element> buffer(row_elements * std::min<std::uint64_t>(block, shape[0]));
  for (std::uint64_t first = 0; first < shape[0]; first += block) {
    const std::uint64_t count = std::min<std::uint64_t>(block, shape[0] - first);
    for (std::uint64_t row = 0; row < count; ++row) fill_row(first + row, &buffer[row * row_elements]);
    const std::string_view bytes(reinterpret_cast<const char*>(buffer.data()),
                                 sizeof(Element) * row_elements * count);
    if (auto written = zip.append(bytes); !written) return written;
  }
  return api::Done{};
}

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

/// `named`: anything with a `name`.
template <class Named>
api::Status write_names(ZipStore& zip, std::string_view array, const std::vector<Named>& named) {
  std::size_t width = 1;
  for (const Named& item : named) width = std::max(width, code_points(item.name).size());
  const std::array<std::uint64_t, 1> shape{named.size()};
  return write_array<char32_t>(zip, array, "<U" + std::to_string(width), shape, width,
                               [&](std::uint64_t row, char32_t* out) {
                                 const std::u32string name = code_points(named[row].name);
                                 std::fill_n(out, width, U'\0');  // NumPy pads with zeros
                                 std::copy(name.begin(), name.end(), out);
                               });
}

void fill_corners(const Patches& patches, PatchId patch, float* out) {
  const Facet& facet = patches.facets[patches.facet_of[patch]];
  const CellCorners corners = cell_corners(facet, patches.cell_of(patch));
  const bool back = patches.is_back(patch);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t turn = std::min(i, corners.count - 1);  // a triangle repeats its last corner
    const std::uint32_t c = back ? corners.count - 1 - turn : turn;
    const Vec3 p = facet.origin + corners.u[c] * facet.edge_u + corners.v[c] * facet.edge_v;
    out[3 * i] = p.x;
    out[3 * i + 1] = p.y;
    out[3 * i + 2] = p.z;
  }
}

api::Status write_patch_arrays(ZipStore& zip, const Patches& patches) {
  const std::uint64_t count = patches.count();
  const auto facet_of = [&](std::uint64_t patch) -> const Facet& {
    return patches.facets[patches.facet_of[patch]];
  };
  const std::array<std::uint64_t, 3> corner_shape{count, 4, 3};
  const std::array<std::uint64_t, 2> normal_shape{count, 3};
  const std::array<std::uint64_t, 1> shape{count};
  if (auto done = write_array<float>(
          zip, "corners", "<f4", corner_shape, 12,
          [&](std::uint64_t p, float* out) { fill_corners(patches, static_cast<PatchId>(p), out); });
      !done)
    return done;
  if (auto done = write_array<float>(zip, "normal", "<f4", normal_shape, 3,
                                     [&](std::uint64_t p, float* out) {
                                       const bool back = patches.is_back(static_cast<PatchId>(p));
                                       const Vec3 n = back ? -facet_of(p).normal : facet_of(p).normal;
                                       out[0] = n.x, out[1] = n.y, out[2] = n.z;
                                     });
      !done)
    return done;
  if (auto done = write_array<float>(zip, "area_m2", "<f4", shape, 1,
                                     [&](std::uint64_t p, float* out) { *out = patches.area_m2[p]; });
      !done)
    return done;
  if (auto done =
          write_array<std::uint32_t>(zip, "object", "<u4", shape, 1,
                                     [&](std::uint64_t p, std::uint32_t* out) { *out = facet_of(p).object; });
      !done)
    return done;
  return write_array<std::uint32_t>(
      zip, "material", "<u4", shape, 1,
      [&](std::uint64_t p, std::uint32_t* out) { *out = facet_of(p).material; });
}

/// The pose of an object in a frame; none where it is not there.
const Pose* pose_at(const ObjectMotion& motion, FrameIndex frame) {
  const auto after = std::upper_bound(motion.spans.begin(), motion.spans.end(), frame,
                                      [](FrameIndex f, const PoseSpan& span) { return f < span.first; });
  if (after == motion.spans.begin() || std::prev(after)->last < frame) return nullptr;
  return &std::prev(after)->pose;
}

api::Status write_motion(ZipStore& zip, const Animation& animation) {
  const std::uint64_t frames = animation.frame_count;
  const std::array<std::uint64_t, 4> pose_shape{animation.objects.size(), frames, 3, 4};
  const std::array<std::uint64_t, 2> visible_shape{animation.objects.size(), frames};
  if (auto done = write_array<double>(zip, "poses", "<f8", pose_shape, frames * 12,
                                      [&](std::uint64_t object, double* out) {
                                        for (FrameIndex f = 0; f < frames; ++f) {
                                          const Pose* pose = pose_at(animation.objects[object], f);
                                          const Pose written = pose ? *pose : Pose{};
                                          for (const auto& row : written.m)
                                            out = std::copy(row.begin(), row.end(), out);
                                        }
                                      });
      !done)
    return done;
  return write_array<std::uint8_t>(zip, "visible", "|u1", visible_shape, frames,
                                   [&](std::uint64_t object, std::uint8_t* out) {
                                     for (FrameIndex f = 0; f < frames; ++f)
                                       out[f] = pose_at(animation.objects[object], f) != nullptr;
                                   });
}

api::Status write_shown_as(ZipStore& zip, const ShownAs& shown_as) {
  const Vec3 up = shown_as.up;
  const std::array<std::uint64_t, 1> three{3}, one{1};
  if (auto done = write_array<double>(zip, "up", "<f8", three, 1,
                                      [&](std::uint64_t k, double* out) {
                                        *out = k == 0 ? up.x : k == 1 ? up.y : up.z;
                                      });
      !done)
    return done;
  return write_array<double>(zip, "auto_exposure", "<f8", one, 1,
                             [&](std::uint64_t, double* out) { *out = shown_as.auto_exposure; });
}

}  // namespace

api::Status write_patches_npz(const std::filesystem::path& path, const Scene& scene, const Patches& patches,
                              const Animation& animation, const ShownAs& shown_as) {
  auto file = DurableFile::create(path);
  if (!file) return file.error();
  ZipStore zip(*file);
  if (auto done = write_patch_arrays(zip, patches); !done) return done;
  if (auto done = write_motion(zip, animation); !done) return done;
  if (auto done = write_names(zip, "object_names", scene.objects); !done) return done;
  if (auto done = write_names(zip, "material_names", scene.materials); !done) return done;
  if (auto done = write_shown_as(zip, shown_as); !done) return done;
  if (auto done = zip.finish(); !done) return done;
  if (auto published = file->publish(); !published) return published;
  return sync_folder(path.parent_path());
}

}  // namespace engine
