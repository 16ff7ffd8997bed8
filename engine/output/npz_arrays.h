// Arrays of an .npz archive, written row by row, and what several archives hold alike. Internal to
// engine/output.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/animation/animation.h"
#include "engine/output/npy.h"
#include "engine/output/zip_store.h"

namespace engine {

inline constexpr std::size_t kArrayBufferBytes = 1u << 20;

/// One array of the archive: rows of `Element`s, written through a small buffer.
/// `fill_row(row, elements)` sets the `row_elements` elements of a row; rows come in order.
template <class Element, class FillRow>
api::Status write_array(ZipStore& zip, std::string_view name, std::string_view dtype,
                        std::span<const std::uint64_t> shape, std::size_t row_elements, FillRow fill_row) {
  const std::string header = npy_header(dtype, shape);
  const std::uint64_t size_bytes = header.size() + shape[0] * row_elements * sizeof(Element);
  if (auto begun = zip.begin(std::string(name) + ".npy", size_bytes); !begun) return begun;
  if (auto written = zip.append(header); !written) return written;

  const std::size_t block =
      std::max<std::size_t>(1, kArrayBufferBytes / (row_elements * sizeof(Element) + 1));
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

/// The same, one array after the other, until one of them fails.
class ArrayWriter {
 public:
  explicit ArrayWriter(ZipStore& zip) : zip_(zip) {}

  const api::Status& status() const { return status_; }

  /// Of shape (rows, columns...), as write_array().
  template <class Element, class FillRow>
  void add(std::string_view name, std::vector<std::uint64_t> shape, FillRow fill_row) {
    std::size_t row_elements = 1;
    for (std::size_t k = 1; k < shape.size(); ++k) row_elements *= shape[k];
    if (status_)
      status_ = write_array<Element>(zip_, name, dtype_of(Element{}), shape, row_elements, fill_row);
  }
  void add_names(std::string_view name, std::span<const std::string_view> names);
  /// Whatever else writes into the archive.
  template <class Write>
  void then(Write write) {
    if (status_) status_ = write(zip_);
  }

  static constexpr std::string_view dtype_of(float) { return "<f4"; }
  static constexpr std::string_view dtype_of(double) { return "<f8"; }
  static constexpr std::string_view dtype_of(std::uint32_t) { return "<u4"; }
  static constexpr std::string_view dtype_of(std::uint8_t) { return "|u1"; }

 private:
  ZipStore& zip_;
  api::Status status_ = api::Done{};
};

/// Fixed-width unicode; UTF-8 that is none becomes U+FFFD, and names are cut after 256 characters.
api::Status write_names(ZipStore& zip, std::string_view array, std::span<const std::string_view> names);

/// `named`: things with a `name`.
template <class Named>
std::vector<std::string_view> names_of(const std::vector<Named>& named) {
  std::vector<std::string_view> names;
  for (const Named& item : named) names.emplace_back(item.name);
  return names;
}

/// poses (objects, frames, 3, 4) object -> world, the identity where a frame does not see the object, and
/// visible (objects, frames) uint8.
template <class Number>
void add_motion(ArrayWriter& arrays, const Animation& animation);
extern template void add_motion<float>(ArrayWriter&, const Animation&);
extern template void add_motion<double>(ArrayWriter&, const Animation&);

}  // namespace engine
