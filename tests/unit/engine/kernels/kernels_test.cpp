#include <gtest/gtest.h>

#include "tests/unit/engine/kernels/run_kernels.h"

namespace {

// All of them do the same additions in the same order, so that a job's results do not depend on the machine.
void expect_same(const std::vector<NamedBytes>& found) {
  const auto expected = engine_baseline::run_kernels();
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_GT(expected[k].second.size(), 100u) << expected[k].first;
    EXPECT_TRUE(found[k].second == expected[k].second) << expected[k].first;
  }
}

TEST(Kernels, GiveTheSameBytesWithAvx2) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this machine has no AVX2";
  expect_same(engine_avx2::run_kernels());
}

TEST(Kernels, GiveTheSameBytesWithAvx512) {
  if (!__builtin_cpu_supports("avx512f")) GTEST_SKIP() << "this machine has no AVX-512";
  expect_same(engine_avx512::run_kernels());
}

}  // namespace
