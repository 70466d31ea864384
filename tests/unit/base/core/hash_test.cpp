// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/hash.h"

#include <gtest/gtest.h>

namespace landfall {
namespace {

// XXH3 128-bit of no input, from the xxHash specification.
TEST(Hash, EmptyInput) { EXPECT_EQ(Hash().hex(), "99aa06d3014798d86001c324468d497f"); }

TEST(Hash, WordsAreTheDigitsOfHex) {
  EXPECT_EQ(Hash().words(), (std::array<std::uint64_t, 2>{0x99aa06d3014798d8, 0x6001c324468d497f}));
}

TEST(Hash, PieceBoundariesOfTextCount) {
  Hash a;
  Hash b;
  a.update("ab").update("c");
  b.update("a").update("bc");
  EXPECT_NE(a.hex(), b.hex());
}

}  // namespace
}  // namespace landfall
