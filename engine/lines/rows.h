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
  std::vector<std::uint64_t> begin, end;  ///< [row]; gaps between rows are left over from merging
  std::vector<Entry> entries;

  std::span<const Entry> row(PatchId patch) const {
    return {entries.data() + begin[patch], entries.data() + end[patch]};
  }
  std::uint64_t entry_count() const {
    std::uint64_t count = 0;
    for (std::size_t row = 0; row < begin.size(); ++row) count += end[row] - begin[row];
    return count;
  }
};

template <class Entry>
struct RowEntry {
  PatchId row = 0;
  Entry entry;
};

/// Sorts one row and merges what can be merged (Entry::absorb); answers the new end.
template <class Entry>
std::uint64_t sort_and_merge(std::vector<Entry>& entries, std::uint64_t begin, std::uint64_t end) {
  std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begin),
            entries.begin() + static_cast<std::ptrdiff_t>(end));
  std::uint64_t kept = begin;
  for (std::uint64_t k = begin; k < end; ++k)
    if (kept == begin || !entries[kept - 1].absorb(entries[k])) entries[kept++] = entries[k];
  return kept;
}

/// Sorts the entries of all chunks by row, and within a row by value, and merges equal ones, so that neither
/// the thread count nor the order of the chunks can be told from the result. Frees `entries` of the chunks.
template <class Chunk, class Entry>
Rows<Entry> build_rows(std::uint32_t row_count, std::vector<Chunk>& chunks,
                       std::vector<RowEntry<Entry>> Chunk::*entries) {
  std::vector<std::uint64_t> next(row_count + 1, 0);
  parallel_for(chunks.size(), [&](std::size_t c) {
    for (const auto& e : chunks[c].*entries)
      std::atomic_ref(next[e.row + 1]).fetch_add(1, std::memory_order_relaxed);
  });
  for (std::uint32_t r = 0; r < row_count; ++r) next[r + 1] += next[r];

  Rows<Entry> rows;
  rows.entries.resize(next[row_count]);
  rows.begin.assign(next.begin(), next.end() - 1);
  parallel_for(chunks.size(), [&](std::size_t c) {
    for (const auto& e : chunks[c].*entries)
      rows.entries[std::atomic_ref(next[e.row]).fetch_add(1, std::memory_order_relaxed)] = e.entry;
    chunks[c].*entries = {};
  });
  rows.end.resize(row_count);
  constexpr std::uint32_t kRowsPerTask = 16;
  parallel_for((row_count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    const std::uint32_t first = static_cast<std::uint32_t>(task) * kRowsPerTask;
    for (std::uint32_t r = first; r < std::min(first + kRowsPerTask, row_count); ++r)
      rows.end[r] = sort_and_merge(rows.entries, rows.begin[r], next[r]);
  });
  return rows;
}

}  // namespace engine
