// A sparse matrix as it is gathered: one row of entries per receiving patch.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/patches/patches.h"

namespace engine {

template <class Entry>
struct Rows {
  std::vector<std::uint64_t> begin;  ///< [row]; one more at the end
  std::vector<Entry> entries;

  std::span<const Entry> row(PatchId patch) const {
    return {entries.data() + begin[patch], entries.data() + begin[patch + 1]};
  }
};

template <class Entry>
struct RowEntry {
  PatchId row = 0;
  Entry entry;
};

/// Sorts the entries of all chunks by row, and within a row by value, so that neither the thread count nor
/// the order of the chunks can be told from the result. Frees the chunks.
template <class Entry>
Rows<Entry> build_rows(std::uint32_t row_count, std::vector<std::vector<RowEntry<Entry>>>& chunks) {
  Rows<Entry> rows;
  rows.begin.assign(row_count + 1, 0);
  parallel_for(chunks.size(), [&](std::size_t c) {
    for (const auto& e : chunks[c])
      std::atomic_ref(rows.begin[e.row + 1]).fetch_add(1, std::memory_order_relaxed);
  });
  for (std::uint32_t r = 0; r < row_count; ++r) rows.begin[r + 1] += rows.begin[r];

  rows.entries.resize(rows.begin[row_count]);
  std::vector<std::uint64_t> next(rows.begin.begin(), rows.begin.end() - 1);
  parallel_for(chunks.size(), [&](std::size_t c) {
    for (const auto& e : chunks[c])
      rows.entries[std::atomic_ref(next[e.row]).fetch_add(1, std::memory_order_relaxed)] = e.entry;
    chunks[c] = {};
  });
  constexpr std::uint32_t kRowsPerTask = 1024;
  parallel_for((row_count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    const std::uint32_t first = static_cast<std::uint32_t>(task) * kRowsPerTask;
    for (std::uint32_t r = first; r < std::min(first + kRowsPerTask, row_count); ++r)
      std::sort(rows.entries.begin() + static_cast<std::ptrdiff_t>(rows.begin[r]),
                rows.entries.begin() + static_cast<std::ptrdiff_t>(rows.begin[r + 1]));
  });
  return rows;
}

}  // namespace engine
