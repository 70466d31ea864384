// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/coordinate_steps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using Place = std::array<double, 3>;

PointSample sample_of(const std::vector<Place>& places) {
  constexpr std::size_t kBatch = 1000;
  PointSample sample;
  for (std::size_t begin = 0; begin < places.size(); begin += kBatch) {
    CloudBatch batch;
    for (std::size_t i = begin; i < std::min(places.size(), begin + kBatch); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) batch.columns[axis].push_back(places[i][axis]);
    sample.add(batch);
  }
  return sample;
}

std::string verdict(const std::vector<Place>& places, const std::array<bool, 3>& is_float32 = {}) {
  return coarse_steps(sample_of(places), 1, is_float32);
}

double rounded(double value, double step) { return std::round(value / step) * step; }

/// Points at random on rolling terrain, `spacing` metres apart, after `round` has changed each.
std::vector<Place> ground(std::size_t count, double spacing, const std::function<void(Place&)>& round) {
  std::mt19937_64 random(7);
  const double width = spacing * std::sqrt(static_cast<double>(count));
  std::uniform_real_distribution<double> within(0, width);
  std::vector<Place> places(count);
  for (Place& p : places) {
    const double x = within(random);
    const double y = within(random);
    p = {500000 + x, 5400000 + y, 300 + 3 * std::sin(x / 7) * std::cos(y / 9)};
    round(p);
  }
  return places;
}

TEST(CoordinateSteps, FindsTheStepOfMostValues) {
  std::vector<double> values;
  for (int i = 0; i < 300; ++i) values.push_back(5.4e6 + 0.5 * (i * i % 997));
  EXPECT_DOUBLE_EQ(step_of(values), 0.5);
  for (double& value : values) value += 0.001 * value;  // no step is left that a double shows
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> within(0, 1000);
  for (double& value : values) value = within(random);
  EXPECT_LT(step_of(values), 1e-6);
  std::vector<double> thirds;
  for (int i = 0; i < 200; ++i) thirds.push_back(rounded(i * 0.25, 0.1));  // 0.2 and 0.3 apart
  EXPECT_NEAR(step_of(thirds), 0.1, 1e-9);
  std::vector<double> lines{0, 10, 20};
  EXPECT_EQ(step_of(lines), 0);
  std::vector<double> few_digits{5400000, 5400010, 5400020};
  EXPECT_EQ(step_of(few_digits), 10);
  std::vector<double> level(100, 3.0);
  EXPECT_EQ(step_of(level), 0);
}

TEST(CoordinateSteps, EstimatesTheSpacing) {
  EXPECT_NEAR(spacing_of(sample_of(ground(10000, 2, [](Place&) {}))), 2, 0.1);
  EXPECT_NEAR(spacing_of(sample_of(ground(200000, 0.5, [](Place&) {}))), 0.5, 0.03);
  EXPECT_EQ(spacing_of(sample_of(std::vector<Place>(200, {1, 2, 3}))), 0);
}

TEST(CoordinateSteps, WarnsOfFloat32AndOfFewDigits) {
  for (const std::size_t count : {500U, 5000U, 200000U}) {
    SCOPED_TRACE(count);
    const auto as_float = [](Place& p) {
      for (double& value : p) value = static_cast<double>(static_cast<float>(value));
    };
    EXPECT_THAT(verdict(ground(count, 1, as_float)),
                AllOf(HasSubstr("y moves in steps of 0.5"), Not(HasSubstr("x moves")), HasSubstr("float32")));
    const auto six_digits = [](Place& p) { p = {rounded(p[0], 1), rounded(p[1], 10), p[2]}; };
    EXPECT_THAT(verdict(ground(count, 1, six_digits)),
                AllOf(HasSubstr("x moves in steps of 1"), HasSubstr("y moves in steps of 10")));
    const auto one_decimal = [](Place& p) {
      for (double& value : p) value = rounded(value, 0.1);
    };
    EXPECT_THAT(verdict(ground(count, 0.5, one_decimal)), HasSubstr("z moves in steps of 0.1"));
  }
}

TEST(CoordinateSteps, AcceptCentimetresAndFreeCoordinates) {
  const auto centimetres = [](Place& p) {
    for (double& value : p) value = rounded(value, 0.01);
  };
  for (const std::size_t count : {100U, 5000U, 200000U}) {
    EXPECT_EQ(verdict(ground(count, 0.5, centimetres)), "");
    EXPECT_EQ(verdict(ground(count, 0.5, [](Place&) {})), "");
    const auto local_float = [](Place& p) {
      p = {static_cast<float>(p[0] - 500000), static_cast<float>(p[1] - 5400000), static_cast<float>(p[2])};
    };
    EXPECT_EQ(verdict(ground(count, 0.05, local_float)), "");
  }
  const auto one_metre = [](Place& p) { p = {rounded(p[0], 1), rounded(p[1], 1), rounded(p[2], 1)}; };
  EXPECT_EQ(verdict(ground(60, 1, one_metre)), "");  // too few to tell
}

/// Nodes of a raster; the sample must not repeat its rows, whose length is a power of two.
std::vector<Place> raster(
    std::size_t rows, std::size_t cols, double step_x, double step_y,
    const std::function<bool(std::size_t)>& exists = [](std::size_t) { return true; }) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < rows * cols; ++i) {
    const double x = static_cast<double>(i % cols) * step_x;
    const double y = static_cast<double>(i / cols) * step_y;
    if (exists(i)) places.push_back({500000 + x, 5400000 + y, std::round(x + 2 * y)});
  }
  return places;
}

TEST(CoordinateSteps, AcceptRastersOfPoints) {
  EXPECT_EQ(verdict(raster(20, 20, 1, 1)), "");
  EXPECT_EQ(verdict(raster(512, 1024, 0.5, 0.5)), "");
  EXPECT_EQ(verdict(raster(300, 200, 10, 2)), "");
  EXPECT_EQ(verdict(raster(100, 100, 1, 1, [](std::size_t i) { return (i * 2654435761U >> 7U) % 2 == 0; })),
            "");
  EXPECT_EQ(verdict(raster(100, 100, 1, 1, [](std::size_t i) { return i % 100 < i / 100; })), "");
}

// A raster whose nodes are float32 by chance is told from one that was rounded by the declared type alone.
TEST(CoordinateSteps, WarnOfRastersThatAreDeclaredAsFloat32) {
  const std::vector<Place> nodes = raster(41, 41, 0.5, 0.5);
  EXPECT_THAT(verdict(nodes, {true, true, true}),
              AllOf(HasSubstr("y moves in steps of 0.5"), Not(HasSubstr("z moves"))));
  std::vector<Place> cents = nodes;
  for (Place& p : cents) p[1] += 0.01;
  EXPECT_EQ(verdict(cents, {true, true, true}), "");  // a text that declares float32, but has more digits
  EXPECT_EQ(verdict(raster(41, 41, 50, 50), {true, true, true}), "");
}

TEST(PointSample, KeepsAllPointsOfASmallFileAndOneOfEachBlockOfALargeOne) {
  std::vector<Place> places(PointSample::kMax - 1);
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = {static_cast<double>(i), 0, 0};
  PointSample sample = sample_of(places);
  ASSERT_EQ(sample.size(), places.size());
  EXPECT_EQ(sample[0].back(), static_cast<double>(places.size() - 1));
  places.resize(PointSample::kMax * 33);
  for (std::size_t i = 0; i < places.size(); ++i) places[i][0] = static_cast<double>(i);
  sample = sample_of(places);
  EXPECT_EQ(sample.point_count(), static_cast<std::int64_t>(places.size()));
  EXPECT_GE(sample.size(), PointSample::kMax / 2);
  EXPECT_LT(sample.size(), PointSample::kMax);
  const double stride = 64;
  for (std::size_t i = 0; i < sample.size(); ++i)
    ASSERT_EQ(std::floor(sample[0][i] / stride), static_cast<double>(i));
}

}  // namespace
}  // namespace landfall
