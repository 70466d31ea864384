// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory/available_memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "base/core/error.h"
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

}  // namespace
}  // namespace landfall
