#include "engine/lines/rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "engine/lines/trace_lines.h"

namespace engine {
namespace {

template <class Entry>
struct Chunk {
  std::vector<RowEntry<Entry>> entries;
};
using Chunks = std::vector<Chunk<Exchange>>;

template <class Entry>
Rows<Entry> rows_of(std::uint32_t row_count, std::vector<Chunk<Entry>>& chunks) {
  return build_rows(row_count, chunks, &Chunk<Entry>::entries);
}

Chunks copies_of(PatchId row, PatchId sender, std::size_t count) {
  return {{std::vector<RowEntry<Exchange>>(count, {row, Exchange(sender)})}};
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
    Chunks chunks = copies_of(1, 4, count);
    const auto rows = rows_of(3, chunks);
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
  Chunks none;
  const auto rows = rows_of(5, none);
  EXPECT_EQ(rows.entry_count(), 0u);
  for (PatchId row = 0; row < 5; ++row) EXPECT_TRUE(rows.row(row).empty());
}

/// Entries for 40 rows, some with many lines of one sender.
std::vector<RowEntry<Exchange>> random_entries(std::size_t count) {
  std::mt19937 random(3);
  std::vector<RowEntry<Exchange>> entries;
  for (std::size_t k = 0; k < count; ++k) {
    const auto row = static_cast<PatchId>(random() % 40);
    entries.push_back({row, Exchange(static_cast<PatchId>(random() % (row % 4 == 0 ? 2 : 300)))});
  }
  return entries;
}

Chunks dealt(const std::vector<RowEntry<Exchange>>& entries, std::size_t chunk_count) {
  Chunks chunks(chunk_count);
  for (std::size_t k = 0; k < entries.size(); ++k) chunks[k % chunk_count].entries.push_back(entries[k]);
  return chunks;
}

TEST(BuildRows, CountsEveryEntryOfEveryChunk) {
  const auto entries = random_entries(30'000);
  std::map<std::pair<PatchId, PatchId>, std::uint32_t> expected, found;
  for (const auto& e : entries) ++expected[{e.row, e.entry.sender()}];
  Chunks chunks = dealt(entries, 13);
  const auto rows = rows_of(40, chunks);
  for (PatchId row = 0; row < 40; ++row)
    for (const Exchange& exchange : rows.row(row)) found[{row, exchange.sender()}] += exchange.count();
  EXPECT_EQ(found, expected);
  for (const auto& chunk : chunks) EXPECT_TRUE(chunk.entries.empty());
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

TEST(BuildRows, NeitherTheOrderOfTheEntriesNorTheChunksCanBeTold) {
  auto entries = random_entries(20'000);
  Chunks chunks = dealt(entries, 1);
  const auto rows = rows_of(40, chunks);
  std::mt19937 random(4);
  for (const std::size_t chunk_count : {1u, 2u, 7u, 500u}) {
    std::shuffle(entries.begin(), entries.end(), random);
    Chunks other = dealt(entries, chunk_count);
    EXPECT_TRUE(same(rows, rows_of(40, other), 40)) << chunk_count;
  }
}

TEST(BuildRows, ChangesOfBothSignsMergeToTheirSumWhateverTheOrder) {
  std::vector<RowEntry<SlotExchange>> entries;
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
  std::vector<Chunk<SlotExchange>> chunks{{entries}}, shuffled(9);
  std::shuffle(entries.begin(), entries.end(), random);
  for (std::size_t k = 0; k < entries.size(); ++k) shuffled[k % 9].entries.push_back(entries[k]);
  const auto rows = rows_of(5, chunks);
  std::map<std::tuple<PatchId, PatchId, int, int>, int> found;
  for (PatchId row = 0; row < 5; ++row)
    for (const SlotExchange& e : rows.row(row)) found[{row, e.sender, e.first_slot, e.last_slot}] += e.weight;
  EXPECT_EQ(found, expected);
  EXPECT_EQ(rows.entry_count(), expected.size());
  EXPECT_TRUE(same(rows, rows_of(5, shuffled), 5));
}

}  // namespace
}  // namespace engine
