#include "server/artefacts/half_body.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/output/array_file.h"
#include "engine/output/half_floats.h"
#include "engine/output/npy.h"

namespace server {
namespace {

constexpr std::int64_t kHalfBytes = 2;
constexpr std::int64_t kValuesAtOnce = 32'768;  ///< values that are converted at once: they stay in the cache

}  // namespace

api::Result<HalfBody> HalfBody::of(FileHandle radiosity, double scale) {
  const auto place = engine::find_npy(radiosity.get());
  if (!place) return place.error();
  if (place->dtype != "<f4" || place->shape.size() != 3 || place->shape[2] != 3)
    return api::Error{api::Fault::internal, "radiosity is not of shape (frames, patches, 3)"};
  HalfBody body;
  body.file_ = std::move(radiosity);
  body.header_ = engine::npy_header("<f2", place->shape);
  body.bytes_ = static_cast<std::int64_t>(place->bytes / 2);
  body.offset_ = place->offset_bytes;
  body.factor_ = static_cast<float>(1 / scale);
  return body;
}

std::int64_t HalfBody::read(std::int64_t at, char* to, std::int64_t size) {
  const std::int64_t first = at / kHalfBytes, skipped = at % kHalfBytes;
  const std::int64_t left = bytes_ / kHalfBytes - first;
  const std::int64_t count = std::min({kValuesAtOnce, left, (skipped + size + kHalfBytes - 1) / kHalfBytes});
  floats_.resize(static_cast<std::size_t>(count));
  halves_.resize(static_cast<std::size_t>(count));
  const std::uint64_t from = offset_ + sizeof(float) * static_cast<std::uint64_t>(first);
  if (!engine::read_at(file_.get(), from, floats_.data(), sizeof(float) * floats_.size())) return -1;
  engine::to_half_floats(floats_.data(), floats_.size(), factor_, halves_.data());
  const std::int64_t copied = std::min(size, count * kHalfBytes - skipped);
  std::memcpy(to, reinterpret_cast<const char*>(halves_.data()) + skipped, static_cast<std::size_t>(copied));
  return copied;
}

api::Result<double> read_half_scale(const FileHandle& shading_mesh) {
  const auto arrays = engine::find_npz(shading_mesh.get());
  if (!arrays) return arrays.error();
  const auto place = arrays->find("half_scale");
  double scale = 0;
  if (place == arrays->end() || place->second.dtype != "<f8" || place->second.bytes != sizeof scale)
    return api::Error{api::Fault::internal, "shading_mesh.npz has no half_scale"};
  if (auto read = engine::read_at(shading_mesh.get(), place->second.offset_bytes, &scale, sizeof scale);
      !read)
    return read.error();
  if (!(scale >= 0x1p-126 && scale <= 0x1p126))
    return api::Error{api::Fault::internal, "the half_scale of shading_mesh.npz is no scale"};
  return scale;
}

}  // namespace server
