// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/quantised.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <zlib.h>

#include "constants.h"

namespace landfall::html_report {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double value_of(const Quantised& q, std::size_t i) { return q.offset + q.codes[i] * q.step; }

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6U | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(count)));
  }
  return bytes;
}

/// Decodes as the browser does, by zlib.
std::vector<std::uint16_t> unpacked(const std::string& text, std::size_t count) {
  const std::vector<std::uint8_t> packed = bytes_of_base64(text);
  std::vector<std::uint8_t> bytes(2 * count);
  uLongf size = bytes.size();
  EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(size, bytes.size());
  std::vector<std::uint16_t> codes(count);
  int before = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int folded = bytes[i] + 256 * bytes[count + i];
    before = (before + (folded % 2 == 0 ? folded / 2 : -(folded + 1) / 2) + 65536) % 65536;
    codes[i] = static_cast<std::uint16_t>(before);
  }
  return codes;
}

TEST(Quantise, KeepsValuesWithinHalfARoundStep) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-7.3, 4.1);
  std::vector<double> values(5000);
  for (double& value : values) value = uniform(generator);
  for (const int steps : {10, 1000, kMaxSteps}) {
    const Quantised q = quantise(values, steps);
    EXPECT_LE((q.high - q.low) / q.step, steps);
    EXPECT_GT((q.high - q.low) / q.step, steps / 2.6);
    for (std::size_t i = 0; i < values.size(); ++i)
      ASSERT_NEAR(value_of(q, i), values[i], q.step * (0.5 + 1e-9)) << i;
  }
  EXPECT_DOUBLE_EQ(quantise(values, 1000).step, 0.02);
}

TEST(Quantise, KeepsMultiplesOfTheStep) {
  const std::array<double, 4> values = {-0.15, 0, 0.07, 0.13};
  const Quantised q = quantise(values, 1000);
  EXPECT_DOUBLE_EQ(q.step, 0.0005);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(value_of(q, i), values[i], 1e-15);
}

TEST(Quantise, HasACodeForNoValue) {
  const std::array<double, 4> values = {kNan, 1, kInfinite, 2};
  const Quantised q = quantise(values, 100);
  EXPECT_EQ(q.codes[0], kNoValueCode);
  EXPECT_EQ(q.codes[2], kNoValueCode);
  EXPECT_EQ(q.low, 1);
  EXPECT_EQ(q.high, 2);
  const Quantised none = quantise(std::array<double, 1>{kNan}, 100);
  EXPECT_EQ(none.codes[0], kNoValueCode);
  EXPECT_EQ(none.step, 0);
}

TEST(Quantise, KeepsASingleValueExactly) {
  const Quantised q = quantise(std::array<double, 2>{0.1234567, 0.1234567}, 100);
  EXPECT_EQ(value_of(q, 1), 0.1234567);
}

TEST(Quantise, StandsExtremeNumbers) {
  const double maximum = std::numeric_limits<double>::max();
  const Quantised wide = quantise(std::array<double, 3>{-maximum, 0, maximum}, 1000);
  EXPECT_TRUE(std::isfinite(wide.step));
  EXPECT_NEAR(value_of(wide, 1) / maximum, 0, 0.002);
  const Quantised narrow = quantise(std::array<double, 2>{0, 5e-324}, 1000);
  EXPECT_EQ(narrow.step, 0);
  // Steps below the resolution of the numbers themselves.
  const Quantised far = quantise(std::array<double, 2>{1e15, 1e15 + 0.25}, 1000);
  EXPECT_NEAR(value_of(far, 1), 1e15 + 0.25, 0.25);
}

TEST(Packed, ComesBackFromZlib) {
  std::vector<std::uint16_t> codes = {0, 65535, 0, 1, 32768, 65535, 65535, 32767, 100};
  std::mt19937 generator(5);
  for (int i = 0; i < 3000; ++i) codes.push_back(static_cast<std::uint16_t>(generator()));
  EXPECT_EQ(unpacked(packed(codes), codes.size()), codes);
  EXPECT_EQ(unpacked(packed(std::vector<std::uint16_t>(1000, 7)), 1000), std::vector<std::uint16_t>(1000, 7));
}

}  // namespace
}  // namespace landfall::html_report
