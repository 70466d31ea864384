// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/numerics/elementary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "targets.h"

namespace landfall {
namespace {

TEST(Elementary, ExponentialKeepsFourteenDigits) {
  for (int i = -700000; i <= 709000; i += 37) {
    const double x = i / 1000.0;
    const auto exact = static_cast<double>(std::exp(static_cast<long double>(x)));
    EXPECT_NEAR(exponential(x) / exact, 1, 1e-14) << x;
  }
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(exponential(-701), 0);
  EXPECT_EQ(exponential(-std::numeric_limits<double>::infinity()), 0);
}

TEST(Elementary, LogarithmIsWithinAnUlp) {
  for (int i = 1; i <= 200000; ++i) {
    const double x = 1e-7 * i * static_cast<double>(i);
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(natural_log(x), exact, std::abs(exact) * 2.3e-16) << x;
  }
}

TEST(Elementary, EveryInstructionSetGivesTheSameBits) {
  const auto values = [] {
    std::vector<double> all;
    for (int i = 1; i < 5000; ++i) {
      all.push_back(exponential(-i * 0.0371));
      all.push_back(natural_log(i * 0.173));
    }
    return all;
  };
  const std::vector<double> expected = values();
  on_every_target([&] { EXPECT_EQ(values(), expected); });
}

}  // namespace
}  // namespace landfall
