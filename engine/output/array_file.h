// Finds the NumPy arrays in a .npy or stored .npz file without reading them: readers take the parts they
// want.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "api/result.h"

namespace engine {

/// Where the elements of an array lie, in C order.
struct ArrayPlace {
  std::string dtype;                 ///< "<f4", "<u4", "|u1", "<f8", ...
  std::vector<std::uint64_t> shape;  ///< of at most 8 dimensions
  std::uint64_t offset_bytes = 0;    ///< of the first element in the file
  std::uint64_t bytes = 0;           ///< of all elements; what the file holds, and what `shape` says
};

/// The array of an open .npy file (format version 1.0). Whoever wrote it is believed nothing: its size fits
/// its shape. Errors: internal, saying what is wrong.
api::Result<ArrayPlace> find_npy(int file);

/// Every array of an open .npz file that is stored, not compressed, as ours are; by name, without ".npy".
/// Errors as above.
api::Result<std::map<std::string, ArrayPlace, std::less<>>> find_npz(int file);

/// Reads exactly `bytes` bytes. Error: internal.
api::Status read_at(int file, std::uint64_t offset_bytes, void* to, std::uint64_t bytes);

}  // namespace engine
