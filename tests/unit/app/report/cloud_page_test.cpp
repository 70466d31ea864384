// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/cloud_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

namespace landfall::html_report {
namespace {

using testing::ElementsAre;

TEST(WideCodes, WholeNumbersAreExact) {
  const WideCodes codes = wide_codes(std::array{70000.0, 12.0, std::numeric_limits<double>::quiet_NaN()}, 10);
  EXPECT_EQ(codes.step, 1);
  EXPECT_EQ(codes.offset, 12);
  EXPECT_THAT(codes.codes, ElementsAre(69988, 0, kNoWideCode));
}

TEST(WideCodes, OutliersDoNotCoarsenTheOthers) {
  std::vector<double> values(1000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.001 * static_cast<double>(i);
  const double step = wide_codes(values, 500).step;
  values.front() = -1e6;
  EXPECT_EQ(wide_codes(values, 500).step, step);
}

// docs/user/landfall-export.md: 25 MB. Noise in all columns is more than any scan has, whose pulses are in
// order.
TEST(CloudData, AMillionPointsOfAllColumnsFitTheLimitOfThePage) {
  constexpr std::size_t kPoints = 1'000'000;
  std::mt19937 random(1);
  const auto noise = [&](double low, double high) {
    std::vector<double> values(kPoints);
    for (double& value : values) value = low + (high - low) * static_cast<double>(random()) / 4294967295.0;
    return values;
  };
  CloudContent content;
  for (const char* const name :
       {"x_est", "y_est", "z_est", "x_true", "y_true", "z_true", "range_measured", "range_true"})
    content.columns[name] = noise(0, 100);
  content.columns["intensity"] = noise(0, 4000);
  content.columns["return_number"] = std::vector<double>(kPoints, 1);
  content.columns["status"] = std::vector<double>(kPoints, 0);
  for (const char* const name : {"t", "pulse", "pixel"}) content.columns[name].resize(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double pulse = static_cast<double>(13 * i + random() % 13);
    content.columns["pulse"][i] = pulse;
    content.columns["t"][i] = pulse / 1e6;
    content.columns["pixel"][i] = static_cast<double>(random() % 65536);
    if (random() % 3 == 0) content.columns["return_number"][i] = static_cast<double>(1 + random() % 4);
  }
  std::size_t bytes = 0;
  for (const auto& [name, packed] : cloud_data(content).packed) bytes += packed.size();
  EXPECT_LT(bytes, 25'000'000U - 300'000U);  // the page itself has 0.3 MB at most
  EXPECT_GT(bytes, 10'000'000U);
}

}  // namespace
}  // namespace landfall::html_report
