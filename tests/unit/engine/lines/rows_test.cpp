#include "engine/lines/rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "engine/lines/trace_lines.h"

namespace engine {
namespace {

template <class Entry>
using Entries = std::vector<RowEntry<Entry>>;

/// Of chunks of `per_chunk` entries.
template <class Entry>
Rows<Entry> rows_of(std::uint32_t row_count, const Entries<Entry>& entries, std::size_t per_chunk,
                    std::vector<std::uint32_t>* met = nullptr) {
  const RowBlocks blocks(row_count);
  std::vector<BlockedEntries<Entry>> chunks;
  for (std::size_t first = 0; first < entries.size(); first += per_chunk)
    chunks.push_back(deal_to_blocks(
        std::span(entries).subspan(first, std::min(per_chunk, entries.size() - first)), blocks));
  return build_rows(row_count, blocks, chunks, met);
}

TEST(Exchange, IsOneLineFromItsSender) {
  const Exchange exchange(19'999'999);
  EXPECT_EQ(exchange.sender(), 19'999'999u);
  EXPECT_EQ(exchange.count(), 1u);
}

TEST(Exchange, AbsorbsItsOwnSenderUpTo128Lines) {
  Exchange exchange(7);
  EXPECT_FALSE(exchange.absorb(Exchange(8)));
  for (std::uint32_t count = 1; count < 128; ++count) {
    ASSERT_EQ(exchange.count(), count);
    ASSERT_TRUE(exchange.absorb(Exchange(7)));
  }
  EXPECT_EQ(exchange.count(), 128u);
  EXPECT_FALSE(exchange.absorb(Exchange(7)));
  EXPECT_EQ(exchange.count(), 128u);
  EXPECT_EQ(exchange.sender(), 7u);
}

TEST(SlotExchange, AbsorbsItsOwnSenderAndSlotsOnly) {
  SlotExchange exchange{3, 9, 1, 5};
  EXPECT_FALSE(exchange.absorb({3, 8, 1, 5}));
  EXPECT_FALSE(exchange.absorb({2, 9, 1, 5}));
  EXPECT_FALSE(exchange.absorb({3, 9, 1, 6}));
  EXPECT_TRUE(exchange.absorb({3, 9, 1, 5}));
  EXPECT_EQ(exchange.weight, 2);
  EXPECT_TRUE(exchange.absorb({3, 9, -1, 5}));
  EXPECT_TRUE(exchange.absorb({3, 9, -1, 5}));
  EXPECT_TRUE(exchange.absorb({3, 9, -1, 5}));
  EXPECT_EQ(exchange.weight, -1);
}

TEST(SlotExchange, KeepsApartWhatItsWeightCannotHold) {
  SlotExchange full{0, 0, 32'767, 1}, empty{0, 0, -32'767, 1};
  EXPECT_FALSE(full.absorb({0, 0, 1, 1}));
  EXPECT_FALSE(empty.absorb({0, 0, -1, 1}));
  EXPECT_TRUE(full.absorb({0, 0, -1, 1}));
}

TEST(BuildRows, MoreThan128LinesOfAPairAreSeveralEntriesOfTheRightSum) {
  for (const std::size_t count : {1u, 127u, 128u, 129u, 256u, 1000u}) {
    const auto rows = rows_of(3, Entries<Exchange>(count, {1, Exchange(4)}), count);
    EXPECT_EQ(rows.entry_count(), (count + 127) / 128);
    EXPECT_TRUE(rows.row(0).empty());
    EXPECT_TRUE(rows.row(2).empty());
    std::size_t sum = 0;
    for (const Exchange& exchange : rows.row(1)) {
      EXPECT_EQ(exchange.sender(), 4u);
      sum += exchange.count();
    }
    EXPECT_EQ(sum, count);
  }
}

TEST(BuildRows, WithoutEntriesEveryRowIsEmpty) {
  const auto rows = rows_of(5, Entries<Exchange>{}, 1);
  EXPECT_EQ(rows.entry_count(), 0u);
  for (PatchId row = 0; row < 5; ++row) EXPECT_TRUE(rows.row(row).empty());
}

TEST(BuildRows, WithoutRowsNothingIsBuilt) {
  EXPECT_EQ(rows_of(0, Entries<Exchange>{}, 1).entry_count(), 0u);
}

TEST(BuildRows, EntriesWithoutASenderAreCountedOnly) {
  const Entries<Exchange> entries{{1, Exchange(2)}, {1, Exchange()}, {3, Exchange()}, {1, Exchange(0)}};
  for (const std::uint32_t row_count : {4u, 1000u}) {  // rows long enough to be merged, and too short
    std::vector<std::uint32_t> met;
    const auto rows = rows_of(row_count, entries, 3, &met);
    EXPECT_EQ(rows.entry_count(), 2u);
    EXPECT_EQ(rows.row(1).size(), 2u);
    EXPECT_EQ(met[0], 0u);
    EXPECT_EQ(met[1], 3u);
    EXPECT_EQ(met[3], 1u);
  }
}

/// Entries for 40 rows, some with many lines of one sender.
Entries<Exchange> random_entries(std::size_t count) {
  std::mt19937 random(3);
  Entries<Exchange> entries;
  for (std::size_t k = 0; k < count; ++k) {
    const auto row = static_cast<PatchId>(random() % 40);
    entries.push_back({row, Exchange(static_cast<PatchId>(random() % (row % 4 == 0 ? 2 : 300)))});
  }
  return entries;
}

TEST(BuildRows, CountsEveryEntryOfEveryChunk) {
  const auto entries = random_entries(30'000);
  std::map<std::pair<PatchId, PatchId>, std::uint32_t> expected, found;
  for (const auto& e : entries) ++expected[{e.row, e.entry.sender()}];
  const auto rows = rows_of(40, entries, 2'345);
  for (PatchId row = 0; row < 40; ++row)
    for (const Exchange& exchange : rows.row(row)) found[{row, exchange.sender()}] += exchange.count();
  EXPECT_EQ(found, expected);
}

/// Many rows, so that they come in several blocks and none of them is merged.
TEST(BuildRows, ARowIsInTheOrderOfItsEntriesHoweverTheyWereCutIntoChunks) {
  constexpr std::uint32_t kRows = 70'000;
  std::mt19937 random(8);
  Entries<Exchange> entries;
  std::map<PatchId, std::vector<PatchId>> expected;
  for (int k = 0; k < 20'000; ++k) {
    const PatchId row = static_cast<PatchId>(random() % 100) * 700,
                  sender = static_cast<PatchId>(random() % kRows);
    entries.push_back({row, Exchange(sender)});
    expected[row].push_back(sender);
  }
  for (const std::size_t per_chunk : {1u, 64u, 4'096u, 100'000u}) {
    const auto rows = rows_of(kRows, entries, per_chunk);
    for (PatchId row = 0; row < kRows; ++row) {
      std::vector<PatchId> senders;
      for (const Exchange& exchange : rows.row(row)) senders.push_back(exchange.sender());
      ASSERT_EQ(senders, expected.count(row) > 0 ? expected[row] : std::vector<PatchId>{}) << row;
    }
  }
}

template <class Entry>
bool same(const Rows<Entry>& a, const Rows<Entry>& b, std::uint32_t row_count) {
  for (PatchId row = 0; row < row_count; ++row) {
    const auto in_a = a.row(row), in_b = b.row(row);
    const auto equal = [](const Entry& x, const Entry& y) { return !(x < y) && !(y < x); };
    if (!std::equal(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(), equal)) return false;
  }
  return true;
}

TEST(BuildRows, ChangesOfBothSignsMergeToTheirSum) {
  Entries<SlotExchange> entries;
  std::map<std::tuple<PatchId, PatchId, int, int>, int> expected;
  std::mt19937 random(5);
  for (int k = 0; k < 20'000; ++k) {
    const auto row = static_cast<PatchId>(random() % 5), sender = static_cast<PatchId>(random() % 7);
    const auto first = static_cast<std::uint8_t>(random() % 3),
               last = static_cast<std::uint8_t>(3 + random() % 2);
    const auto sign = static_cast<std::int16_t>(random() % 3 == 0 ? -1 : 1);
    entries.push_back({row, {first, last, sign, sender}});
    expected[{row, sender, first, last}] += sign;
  }
  const auto rows = rows_of(5, entries, 20'000);
  std::map<std::tuple<PatchId, PatchId, int, int>, int> found;
  for (PatchId row = 0; row < 5; ++row)
    for (const SlotExchange& e : rows.row(row)) found[{row, e.sender, e.first_slot, e.last_slot}] += e.weight;
  EXPECT_EQ(found, expected);
  EXPECT_EQ(rows.entry_count(), expected.size());
  EXPECT_TRUE(same(rows, rows_of(5, entries, 333), 5));
}

}  // namespace
}  // namespace engine
