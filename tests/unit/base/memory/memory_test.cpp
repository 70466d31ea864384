// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <vector>

#include "base/core/error.h"
#include "base/memory/available_memory.h"
#include "base/memory/large_memory.h"
#include "base/memory/zeroed_memory.h"
#include "refusal.h"

namespace landfall {
namespace {

std::string refusal_of(std::uint64_t needed, std::optional<std::uint64_t> available,
                       const std::string& advice) {
  return refusal<FormatError>([&] { require_memory(needed, available, "judging 9 x 9 bins", advice); });
}

TEST(RequireMemory, SaysWhatIsNeededAndWhatThereIs) {
  EXPECT_EQ(refusal_of(32'000'000'001, 3'000'000'000, "take less"),
            "judging 9 x 9 bins needs 32.1 GB of memory, and 3 GB are available; take less");
  EXPECT_EQ(refusal_of(500'000'000, 499'999'999, ""),
            "judging 9 x 9 bins needs 0.5 GB of memory, and 0.5 GB are available");
  EXPECT_EQ(refusal_of(500, 500, ""), "accepted");
  EXPECT_EQ(refusal_of(std::uint64_t{1} << 60U, std::nullopt, ""), "accepted");
}

TEST(AvailableMemory, ALimitOnTheProcessCounts) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  rlimit less = before;
  less.rlim_cur = 1;  // less than is in use
  ASSERT_EQ(setrlimit(RLIMIT_AS, &less), 0);
  rlimit is_set{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &is_set), 0);
  if (is_set.rlim_cur != less.rlim_cur) GTEST_SKIP() << "the emulator ignores this limit";
  const std::optional<std::uint64_t> available = available_memory();
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
  EXPECT_EQ(available.value(), 0U);
}

constexpr std::size_t kBlock = 5U << 20U;

TEST(LargeMemory, IsAlignedAndUsableToTheLastByte) {
  auto* const block = static_cast<char*>(take_large_block(kBlock));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % (1U << 21U), 0U);
  block[0] = 1;
  block[kBlock - 1] = 2;
  EXPECT_EQ(block[0] + block[kBlock - 1], 3);
  give_large_block_back(block, kBlock);
}

TEST(ZeroedMemory, IsZeroFromTheHeapAndFromTheSystem) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, kLargeBlock - 1, kLargeBlock, kBlock})
    for (int turn = 0; turn < 2; ++turn) {
      ZeroedArray<unsigned char> bytes(size);
      EXPECT_TRUE(std::ranges::all_of(bytes.values(), [](unsigned char byte) { return byte == 0; })) << size;
      std::ranges::fill(bytes.values(), 1);
    }
}

TEST(LargeMemory, ABlockIsGivenToOneAtATimeAndUsedAgain) {
  void* const first = take_large_block(kBlock);
  void* const second = take_large_block(kBlock);
  EXPECT_NE(first, second);
  give_large_block_back(first, kBlock);
  void* const other_size = take_large_block(2 * kBlock);
  EXPECT_NE(other_size, first);
  EXPECT_EQ(take_large_block(kBlock), first);
  give_large_block_back(first, kBlock);
  give_large_block_back(second, kBlock);
  give_large_block_back(other_size, 2 * kBlock);
}

bool is_mapped(void* block) {
  unsigned char resident = 0;
  return mincore(block, static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)), &resident) == 0;
}

TEST(LargeMemory, MoreThanIsKeptGoesBackToTheSystem) {
  constexpr std::size_t kSize = std::size_t{50} << 20U;  // two fit into the 128 MiB that are kept
  std::vector<void*> blocks;
  for (int i = 0; i < 3; ++i) blocks.push_back(take_large_block(kSize));
  EXPECT_EQ(std::ranges::count_if(blocks, is_mapped), 3);
  for (void* const block : blocks) give_large_block_back(block, kSize);
  EXPECT_EQ(std::ranges::count_if(blocks, is_mapped), 2);
}

TEST(LargeMemory, RefusesWhatNoMachineHas) {
  EXPECT_THROW(static_cast<void>(take_large_block(std::numeric_limits<std::size_t>::max())), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(take_large_block(std::size_t{1} << 62U)), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(LargeAllocator<double>().allocate(std::numeric_limits<std::size_t>::max())),
               std::bad_array_new_length);
}

TEST(LargeAllocator, AValueIsSetInAUsedBlockToo) {
  using Values = std::vector<double, LargeAllocator<double>>;
  constexpr std::size_t kCount = kLargeBlock / sizeof(double) + 3;
  Values(kCount, 7.0);
  const Values zeros(kCount, 0.0);
  for (const double value : zeros) ASSERT_EQ(value, 0.0);
  const Values copy = zeros;
  EXPECT_EQ(copy, zeros);
  EXPECT_NE(copy.data(), zeros.data());
}

}  // namespace
}  // namespace landfall
