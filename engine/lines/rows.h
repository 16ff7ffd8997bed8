// A sparse matrix as it is gathered: one row of entries per receiving patch.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
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

/// Rows are dealt out in blocks of 2^shift: as many as a cache holds the ends of.
struct RowBlocks {
  std::uint32_t shift = 0, count = 0;

  explicit RowBlocks(std::uint32_t row_count) {
    constexpr std::uint32_t kBlocks = 256, kShiftMax = 16;  // a row within its block has 16 bits
    while (shift < kShiftMax && (row_count >> shift) >= kBlocks) ++shift;
    count = row_count == 0 ? 0 : ((row_count - 1) >> shift) + 1;
  }
};

/// The entries of one chunk, those of one block together and otherwise in the order they came in. Half of
/// what RowEntry takes, since the block says the rest of the row.
template <class Entry>
struct BlockedEntries {
  std::unique_ptr<Entry[]> entries;
  std::unique_ptr<std::uint16_t[]> rows;  ///< within their block
  std::vector<std::uint32_t> begin;       ///< [block], and the end of the last; empty where there are none

  std::uint32_t count_of(std::size_t block) const {
    return begin.empty() ? 0 : begin[block + 1] - begin[block];
  }
  std::span<const std::uint16_t> rows_of(std::size_t block) const {
    return {begin.empty() ? nullptr : rows.get() + begin[block], count_of(block)};
  }
  std::span<const Entry> entries_of(std::size_t block) const {
    return {begin.empty() ? nullptr : entries.get() + begin[block], count_of(block)};
  }
};

template <class Entry>
BlockedEntries<Entry> deal_to_blocks(std::span<const RowEntry<Entry>> entries, const RowBlocks& blocks) {
  BlockedEntries<Entry> dealt;
  if (entries.empty()) return dealt;
  dealt.begin.assign(blocks.count + 1, 0);
  for (const RowEntry<Entry>& e : entries) ++dealt.begin[(e.row >> blocks.shift) + 1];
  for (std::uint32_t b = 0; b < blocks.count; ++b) dealt.begin[b + 1] += dealt.begin[b];
  std::vector<std::uint32_t> next(dealt.begin.begin(), dealt.begin.end() - 1);
  dealt.entries = std::make_unique_for_overwrite<Entry[]>(entries.size());
  dealt.rows = std::make_unique_for_overwrite<std::uint16_t[]>(entries.size());
  const std::uint32_t mask = (1u << blocks.shift) - 1;
  for (const RowEntry<Entry>& e : entries) {
    const std::uint32_t place = next[e.row >> blocks.shift]++;
    dealt.entries[place] = e.entry;
    dealt.rows[place] = static_cast<std::uint16_t>(e.row & mask);
  }
  return dealt;
}

/// [row], how many entries the chunks have.
template <class Entry>
std::vector<std::uint32_t> count_rows(std::uint32_t row_count, const RowBlocks& blocks,
                                      const std::vector<BlockedEntries<Entry>>& chunks) {
  std::vector<std::uint32_t> count(row_count, 0);
  parallel_for(blocks.count, [&](std::size_t b) {
    std::uint32_t* of_block = count.data() + (b << blocks.shift);
    for (const BlockedEntries<Entry>& chunk : chunks)
      for (const std::uint16_t row : chunk.rows_of(b)) ++of_block[row];
  });
  return count;
}

/// Sorts one row and merges what can be merged (Entry::absorb); answers the new end.
template <class Entry>
std::uint64_t sort_and_merge(Entry* entries, std::uint64_t begin, std::uint64_t end) {
  std::sort(entries + begin, entries + end);
  std::uint64_t kept = begin;
  for (std::uint64_t k = begin; k < end; ++k)
    if (kept == begin || !entries[kept - 1].absorb(entries[k])) entries[kept++] = entries[k];
  return kept;
}

/// The entries of all chunks by row, and within a row in the order of the chunks and of the entries in them:
/// the same whatever the number of threads. Entries that only count (Entry::has_sender) are left out. Rows so
/// long that many of their entries must be of one sender are sorted and merged (Entry::is_worth_merging).
/// `met`, if not null: [row], how many entries there were, those that only count too. Frees `chunks`.
template <class Entry>
Rows<Entry> build_rows(std::uint32_t row_count, const RowBlocks& blocks,
                       std::vector<BlockedEntries<Entry>>& chunks, std::vector<std::uint32_t>* met) {
  std::vector<std::uint64_t> block_begin(blocks.count + 1, 0);
  for (const BlockedEntries<Entry>& chunk : chunks)
    for (std::uint32_t b = 0; b < blocks.count; ++b) block_begin[b + 1] += chunk.count_of(b);
  for (std::uint32_t b = 0; b < blocks.count; ++b) block_begin[b + 1] += block_begin[b];

  Rows<Entry> rows;
  rows.entries.resize(block_begin[blocks.count]);
  rows.begin.resize(row_count);
  rows.end.resize(row_count);
  const std::vector<std::uint32_t> count = count_rows(row_count, blocks, chunks);
  parallel_for(blocks.count, [&](std::size_t b) {
    const auto first = static_cast<std::uint32_t>(b << blocks.shift);
    const std::uint32_t last = std::min(first + (1u << blocks.shift), row_count);
    std::uint64_t place = block_begin[b];
    for (std::uint32_t r = first; r < last; ++r) {
      rows.begin[r] = rows.end[r] = place;
      place += count[r];
    }
    std::uint64_t* const end = rows.end.data() + first;
    for (const BlockedEntries<Entry>& chunk : chunks) {
      const auto in_block = chunk.rows_of(b);
      const auto entries = chunk.entries_of(b);
      for (std::size_t k = 0; k < in_block.size(); ++k)
        if (entries[k].has_sender()) rows.entries[end[in_block[k]]++] = entries[k];
    }
    for (std::uint32_t r = first; r < last; ++r)
      if (Entry::is_worth_merging(rows.end[r] - rows.begin[r], row_count))
        rows.end[r] = sort_and_merge(rows.entries.data(), rows.begin[r], rows.end[r]);
  });
  chunks.clear();
  if (met) *met = count;
  return rows;
}

}  // namespace engine
