// What the chunks of lines found, dealt to blocks of rows. Internal to engine/lines.
#pragma once

#include <vector>

#include "engine/lines/line_tracer.h"
#include "engine/lines/rows.h"

namespace engine {

struct LineChunks {
  RowBlocks blocks;
  std::vector<BlockedEntries<Exchange>> pairs;  ///< [chunk]
  std::vector<BlockedEntries<SlotExchange>> changes;

  explicit LineChunks(std::uint32_t patch_count) : blocks(patch_count) {}

  void resize(std::size_t chunks) {
    pairs.resize(chunks);
    changes.resize(chunks);
  }
  void keep(std::size_t chunk, const ChunkExchanges& found) {
    pairs[chunk] = deal_to_blocks(std::span(found.pairs), blocks);
    changes[chunk] = deal_to_blocks(std::span(found.changes), blocks);
  }
};

}  // namespace engine
