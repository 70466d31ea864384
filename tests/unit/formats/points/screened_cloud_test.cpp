// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/screened_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>

#include "base/core/error.h"
#include "constants.h"
#include "test_seed.h"

namespace landfall {
namespace {

using Points = std::vector<std::array<double, 3>>;

/// Points in batches of a size.
class Batches final : public CloudReader {
 public:
  Batches(Points points, std::size_t size, std::vector<double> classes = {})
      : points_(std::move(points)), size_(size), classes_(std::move(classes)) {}
  bool next(CloudBatch& batch) override {
    if (next_ == points_.size()) return false;
    const std::size_t end = std::min(next_ + size_, points_.size());
    for (auto& column : batch.columns) column.clear();
    for (; next_ < end; ++next_) {
      for (std::size_t axis = 0; axis < 3; ++axis) batch.columns[axis].push_back(points_[next_][axis]);
      if (!classes_.empty()) batch[CloudField::classification].push_back(classes_[next_]);
    }
    return true;
  }
  void rewind() override { next_ = 0; }
  [[nodiscard]] double progress() const override { return 1; }

 private:
  Points points_;
  std::size_t size_;
  std::vector<double> classes_;
  std::size_t next_ = 0;
};

Points scattered(std::size_t count) {
  std::mt19937_64 random(test_seed());
  std::normal_distribution<double> normal;
  Points points;
  for (std::size_t i = 0; i < count; ++i) points.push_back({normal(random), normal(random), normal(random)});
  return points;
}

/// The message of the first pass; the number of points otherwise.
std::string screened(Points points, const CloudNodata& nodata = {}, std::size_t batch_size = 1000,
                     std::vector<double> classes = {}) {
  ScreenedCloud cloud(std::make_unique<Batches>(std::move(points), batch_size, std::move(classes)), "a.csv",
                      nodata);
  std::size_t count = 0;
  try {
    for (CloudBatch batch; cloud.next(batch);) count += batch.size();
  } catch (const FormatError& error) {
    return error.what();
  }
  return std::to_string(count);
}

/// `shared` points at one position among others, at the end or spread.
Points with_shared(std::size_t others, std::size_t shared, bool is_spread) {
  Points points = scattered(others);
  points.resize(others + shared);
  if (is_spread)
    for (std::size_t i = 0; i < shared; ++i) std::swap(points[others + i], points[i * others / shared]);
  return points;
}

TEST(ScreenedCloud, RefusesAPositionOfAtLeastTenPointsAndMoreThanOnePercent) {
  for (const bool is_spread : {false, true})
    for (const std::size_t batch_size : {7U, 100000U}) {
      EXPECT_NE(screened(with_shared(985, 15, is_spread), {}, batch_size)
                    .find("a.csv: 15 of 1,000 points share the position 0, 0, 0, which"),
                std::string::npos);
      EXPECT_EQ(screened(with_shared(990, 10, is_spread), {}, batch_size), "1000");
      EXPECT_EQ(screened(with_shared(40, 9, is_spread), {}, batch_size), "49");
      EXPECT_NE(screened(with_shared(40, 10, is_spread), {}, batch_size).find("share"), std::string::npos);
    }
}

TEST(ScreenedCloud, FindsASharedPositionInAnyPartOfALongStream) {
  for (const bool is_spread : {false, true}) {
    EXPECT_NE(screened(with_shared(300'000, 3'100, is_spread)).find("3,100 of 303,100 points"),
              std::string::npos);
    EXPECT_EQ(screened(with_shared(300'000, 3'000, is_spread)), "303000");
  }
  EXPECT_NE(screened(with_shared((1U << 18U) - 3, 3'000, false)).find("3,000 of 265,141 points"),
            std::string::npos);
}

/// The shared positions by the three passes.
std::map<std::array<double, 3>, std::int64_t> shared_of(const Points& points) {
  SharedPositionSearch search;
  for (const auto& position : points) search.add(position);
  EXPECT_EQ(search.total(), static_cast<std::int64_t>(points.size()));
  if (!search.needs_further_passes()) return {};
  for (const auto& position : points) search.propose(position);
  search.begin_count();
  for (const auto& position : points) search.count(position);
  return search.shared();
}

/// The same by counting every position.
std::map<std::array<double, 3>, std::int64_t> counted_shared_of(const Points& points) {
  std::map<std::array<double, 3>, std::int64_t> counts;
  for (const auto& position : points) ++counts[position];
  std::erase_if(counts, [&](const auto& entry) {
    return entry.second < 10 || 100 * entry.second <= static_cast<std::int64_t>(points.size());
  });
  return counts;
}

TEST(SharedPositionSearch, FindsAllPositionsOfMoreThanOnePercentInAnyOrder) {
  std::mt19937_64 random(test_seed());
  for (const auto& [positions, others, shared] :
       {std::array<std::size_t, 3>{1, 90, 1}, {7, 90, 7}, {60, 20'000, 30}, {90, 30'000, 0}, {98, 0, 49}}) {
    Points points = scattered(others);
    for (std::size_t i = 0; i < 200 * positions; ++i) {
      const auto place = static_cast<double>(i % positions);
      points.push_back({place, -place, 0});
      if (i % positions < positions / 2) points.push_back({place, -place, -0.0});
    }
    const auto expected = counted_shared_of(points);
    EXPECT_EQ(expected.size(), shared);
    EXPECT_EQ(shared_of(points), expected) << positions;
    std::ranges::sort(points);
    EXPECT_EQ(shared_of(points), expected) << positions << ", sorted";
    std::ranges::shuffle(points, random);
    EXPECT_EQ(shared_of(points), expected) << positions << ", shuffled";
  }
}

TEST(ScreenedCloud, RefusesFillsOfZ) {
  Points points = scattered(1000);
  points[500][2] = points[900][2] = -12345;
  EXPECT_NE(screened(points).find(
                "a.csv: 2 of 1,000 points have z -12345, which looks like an undeclared fill value"),
            std::string::npos);
  EXPECT_NE(screened(points).find("give --nodata -12345 to leave them out, or --nodata none"),
            std::string::npos);
  points[7][2] = -9999;
  EXPECT_NE(screened(points).find("3 of 1,000 points have z -12345 or -9999"), std::string::npos);
  EXPECT_EQ(screened(points, {.z = {-12345, -9999}}), "997");
  EXPECT_EQ(screened(points, {.keeps_undeclared_fills = true}), "1000");
}

TEST(ScreenedCloud, SearchesOnlyPointsThatCount) {
  Points points = scattered(1000);
  std::vector<double> classes(points.size(), 2);
  for (std::size_t i = 0; i < 90; ++i) {
    points[10 * i] = {0, 0, -9999};
    classes[10 * i] = std::array{kWithheld, 7.0, 18.0}[i % 3];
  }
  points[999][2] = kNan;
  EXPECT_EQ(screened(points, {}, 1000, classes), "1000");
}

TEST(ScreenedCloud, CountsTheLeftOutPointsOfEachPass) {
  Points points = with_shared(300, 20, true);
  for (std::size_t i = 0; i < 5; ++i) points.push_back({1, 2, -1});
  ScreenedCloud cloud(std::make_unique<Batches>(points, 64), "a.csv", {.z = {0}});
  for (int pass = 0; pass < 3; ++pass) {
    std::size_t count = 0;
    for (CloudBatch batch; cloud.next(batch);) count += batch.size();
    EXPECT_EQ(count, 305U);
    EXPECT_EQ(cloud.left_out(), 20);
    cloud.rewind();
  }
}

}  // namespace
}  // namespace landfall
