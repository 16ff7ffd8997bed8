// Half floats that are made up as they are read: any bytes of them are those of the whole.
#include "server/artefacts/half_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "engine/output/npy.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/server/read_body.h"

namespace server {
namespace {

/// Larger than the block that is converted at once.
constexpr std::uint64_t kFrames = 3, kPatches = 5000;

class HalfBodies : public testing::Test {
 protected:
  HalfBodies() {
    const std::array<std::uint64_t, 3> shape{kFrames, kPatches, 3};
    std::string bytes = engine::npy_header("<f4", shape);
    for (std::uint64_t k = 0; k < 3 * kFrames * kPatches; ++k) {
      const float value = static_cast<float>(k % 1999);  // times 1/4: exact as half floats
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    write("radiosity.npy", bytes);
  }

  void write(std::string_view name, std::string_view bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << bytes;
  }
  FileHandle open(std::string_view name) const {
    auto file = open_below(folder_.path(), name);
    EXPECT_TRUE(file);
    return std::move(*file);
  }
  HalfBody body() const {
    auto made = HalfBody::of(open("radiosity.npy"), 4);
    EXPECT_TRUE(made);
    return std::move(*made);
  }

  tests::TemporaryFolder folder_;
};

TEST_F(HalfBodies, HoldEveryValueOverTheScale) {
  HalfBody made = body();
  EXPECT_NE(made.header().find("'<f2'"), std::string::npos) << made.header();
  EXPECT_NE(made.header().find("(3, 5000, 3, )"), std::string::npos) << made.header();
  ASSERT_EQ(made.bytes(), std::int64_t{2 * 3 * kFrames * kPatches});
  const std::string bytes = read_from(made, 0, made.bytes(), 1 << 20);
  ASSERT_EQ(static_cast<std::int64_t>(bytes.size()), made.bytes());
  for (std::size_t k = 0; k < bytes.size() / 2; ++k) {
    std::uint16_t half = 0;
    std::memcpy(&half, bytes.data() + 2 * k, sizeof half);
    const int exponent = half >> 10, fraction = half & 1023;
    const double value =
        exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
    ASSERT_EQ(4 * value, static_cast<double>(k % 1999)) << k;
  }
}

TEST_F(HalfBodies, AnyPartIsThatOfTheWhole) {
  HalfBody made = body();
  const std::string whole = read_from(made, 0, made.bytes(), 1 << 16);
  for (std::int64_t at = 0; at < made.bytes(); at += 1013)
    for (const std::int64_t size : {1, 2, 3, 700}) {
      const auto expected = whole.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
      for (const std::int64_t piece : {1, 7, 1000})
        ASSERT_EQ(read_from(made, at, static_cast<std::int64_t>(expected.size()), piece), expected) << at;
    }
}

TEST_F(HalfBodies, OtherArraysAreRefused) {
  const std::array<std::uint64_t, 2> shape{2, 3};
  write("flat.npy", engine::npy_header("<f4", shape) + std::string(24, '\0'));
  EXPECT_FALSE(HalfBody::of(open("flat.npy"), 1));
  write("text.npy", "no array");
  EXPECT_FALSE(HalfBody::of(open("text.npy"), 1));
  EXPECT_FALSE(read_half_scale(open("text.npy")));
}

TEST_F(HalfBodies, AFileThatIsCutShortIsNotReadBeyondItsEnd) {
  HalfBody made = body();
  std::filesystem::resize_file(folder_.path() / "radiosity.npy", 4096);
  char byte = 0;
  EXPECT_EQ(made.read(made.bytes() - 1, &byte, 1), -1);
}

}  // namespace
}  // namespace server
