// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/scan_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "base/core/error.h"
#include "constants.h"
#include "refusal.h"
#include "store/hdf5/dataset_list.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;
using testing::EndsWith;

/// Two pulses of three pixels; x_est numbers the rows, and what a status leaves out is NaN.
PulseBatch small_batch(const OptionalColumns& columns) {
  PulseBatch batch;
  batch.resize(2, 3, PointContent::all, columns);
  batch.points.status = {miss, returned, false_return, dropout, returned, dead};
  for (std::size_t row = 0; row < 6; ++row) {
    const bool has_range = is_return(batch.points.status[row]);
    for (const auto member : kCoordinates)
      (batch.points.*member)[row] = has_range ? static_cast<double>(row) : kNan;
    batch.points.pulse[row] = row < 3 ? 0 : 1;
    batch.points.pixel[row] = static_cast<std::int32_t>(row % 3);
  }
  batch.pulses.t = {0.5, 1.5};
  batch.pulses.point_count = {3, 3};
  return batch;
}

struct WrittenScan {
  ScanFileOptions options{};
  std::function<void(PulseBatch&)> change = [](PulseBatch&) {};

  void write(const std::filesystem::path& path) const {
    const Detector detector({1, 3, 1}, std::vector<Direction<LidarFrame>>(3), {});
    LandfallFileWriter file({path}, "scan", {.tool = "scan-sim"});
    ScanWriter writer(file, options, "");
    PulseBatch batch = small_batch(options.columns);
    change(batch);
    const SinkWork work = writer.take(batch);
    if (work.in_parallel) work.in_parallel();
    if (work.in_order) work.in_order();
    writer.commit(detector, std::vector<std::int8_t>(3));
  }
};

ScanPoints read_all(const std::filesystem::path& path) {
  ScanReader reader(path);
  ScanPoints points;
  reader.read(0, reader.row_count(), points);
  return points;
}

ScanPoints read_all(const WrittenScan& scan) {
  const TemporaryFolder folder;
  scan.write(folder / "scan.h5");
  return read_all(folder / "scan.h5");
}

std::string failure(const WrittenScan& scan) {
  return refusal<FormatError>([&] { return read_all(scan); });
}

/// How reading fails after another program has set one value of the file.
std::string failure_with(const std::string& column, hsize_t row, double value) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "scan.h5";
  WrittenScan{.options = {.keep_misses = true}}.write(path);
  h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  h5::Handle dataset = h5::open_dataset(file.get(), column);
  h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  EXPECT_GE(H5Sselect_elements(space.get(), H5S_SELECT_SET, 1, &row), 0);
  const h5::Handle memory(H5Screate(H5S_SCALAR), H5Sclose);
  EXPECT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, memory.get(), space.get(), H5P_DEFAULT, &value), 0);
  space.reset();
  dataset.reset();
  file.reset();
  return refusal<FormatError>([&] { return read_all(path); });
}

TEST(ScanReader, ReadsTheReturnsWithTheirTimes) {
  for (const bool keep_misses : {false, true}) {
    const ScanPoints points = read_all({.options = {.keep_misses = keep_misses}});
    EXPECT_THAT(points.columns.x_est, ElementsAre(1, 2, 4));
    EXPECT_THAT(points.columns.z_true, ElementsAre(1, 2, 4));
    EXPECT_THAT(points.t, ElementsAre(0, 0, 1)) << "since the first pulse";
    EXPECT_EQ(points.view().t.data(), points.t.data());
    EXPECT_EQ(points.view().y_true.data(), points.columns.y_true.data());
  }
}

// 1.4e9 s has a spacing of 2.4e-7 s, so that pulses 1/3 s apart are stored with an error.
TEST(PulseTimes, AreExactForAConstantRateOnAnyClock) {
  for (const double epoch_s : {0.0, 7.3, -1e6 / 3, 1.4e9}) {
    std::vector<double> stored;
    std::vector<double> exact;
    for (int k = 0; k < 1000; ++k) {
      exact.push_back(k / 3e3);
      stored.push_back(epoch_s + exact.back());
    }
    const PulseTimes times = times_since_first(stored, 3e3);
    EXPECT_EQ(times.epoch_s, epoch_s);
    EXPECT_EQ(times.since_s, exact) << epoch_s;
  }
}

TEST(PulseTimes, AreDifferencesOtherwise) {
  EXPECT_THAT(times_since_first({5, 5.25, 5.5}, std::nullopt).since_s, ElementsAre(0, 0.25, 0.5));
  EXPECT_THAT(times_since_first({5, 5.25, 5.75}, 4).since_s, ElementsAre(0, 0.25, 0.75)) << "not at 4 Hz";
  EXPECT_THAT(times_since_first({5, 4}, std::nullopt).since_s, ElementsAre(0, -1));
  EXPECT_THAT(times_since_first({}, 4).since_s, testing::IsEmpty());
}

// Row 4 is the third return: rows are those of the file, also where misses before it are left out.
TEST(ScanReader, NamesTheRowAndColumnOfTheFileThatIsNotFinite) {
  for (const auto member : kCoordinates)
    for (const double value : {kNan, kInfinity, -kInfinity}) {
      const std::string column = "/points/" + std::string(name_of(member));
      EXPECT_THAT(failure_with(column, 4, value), EndsWith(column + "[4] of a return is not finite"));
    }
}

TEST(ScanReader, NamesTheFirstRowThatIsNotFinite) {
  EXPECT_THAT(failure({.options = {.keep_misses = true},
                       .change =
                           [](PulseBatch& b) {
                             b.points.x_est[4] = kNan;
                             b.points.z_true[2] = kNan;
                           }}),
              EndsWith("/points/z_true[2] of a return is not finite"));
}

TEST(ScanReader, NamesThePulseWhoseTimeIsNotFinite) {
  for (const double value : {kNan, kInfinity})
    EXPECT_THAT(failure_with("/pulses/t", 1, value), EndsWith("/pulses/t[1] is not finite"));
}

TEST(ScanWriter, RefusesInfiniteValues) {
  for (const auto member : kCoordinates)
    for (const double value : {kInfinity, -kInfinity})
      EXPECT_EQ(failure(WrittenScan{.change = [&](PulseBatch& b) { (b.points.*member)[4] = value; }}),
                "column " + std::string(name_of(member)) +
                    " would hold infinite values: a value of the configuration or of an input is too large");
}

TEST(ScanReader, NamesTheRowOfAPulseThatIsNotThere) {
  for (const int pulse : {-1, 2})
    EXPECT_THAT(failure({.options = {.keep_misses = true},
                         .change = [&](PulseBatch& b) { b.points.pulse[4] = pulse; }}),
                EndsWith("/points/pulse[4] = " + std::to_string(pulse) + " is not a row of /pulses (2)"));
}

std::vector<DatasetEntry> datasets_of(const std::filesystem::path& path, const char* group) {
  const LandfallFileReader file(path, {"scan"});
  return list_datasets(TableReader(file.root(), group, file.name()).group());
}

template <class Columns>
void expect_as_declared(const std::vector<DatasetEntry>& found, const Columns& columns,
                        const OptionalColumns& optional = {}) {
  auto entry = found.begin();
  for_each_column(columns, [&](const auto& column) {
    if (!optional.has(column.group)) return;
    ASSERT_NE(entry, found.end()) << column.name;
    EXPECT_EQ(entry->name, column.name);
    EXPECT_EQ(entry->units, column.units);
    EXPECT_EQ(entry->long_name, column.long_name);
    ++entry;
  });
  EXPECT_EQ(entry, found.end());
}

TEST(ScanWriter, WritesTheDeclaredColumnsInTheirOrder) {
  const TemporaryFolder folder;
  WrittenScan().write(folder / "scan.h5");
  const std::vector<DatasetEntry> points = datasets_of(folder / "scan.h5", "points");
  expect_as_declared(points, kPointColumns);
  expect_as_declared(datasets_of(folder / "scan.h5", "pulses"), kPulseColumns);
  EXPECT_THAT(points.back().flag_values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(points.back().flag_meanings.at(5), "total_reflection");
}

TEST(ScanWriter, WritesTheColumnsOfAReceiver) {
  const TemporaryFolder folder;
  const OptionalColumns columns{.intensity = true, .return_number = true, .echo = true};
  WrittenScan{.options = {.columns = columns}}.write(folder / "scan.h5");
  expect_as_declared(datasets_of(folder / "scan.h5", "points"), kPointColumns, columns);
}

TEST(ScanWriter, SinglePrecisionIsForTheDoublesOfPoints) {
  const TemporaryFolder folder;
  WrittenScan{.options = {.single_precision = true}}.write(folder / "scan.h5");
  for (const DatasetEntry& entry : datasets_of(folder / "scan.h5", "points"))
    EXPECT_EQ(entry.type, entry.name == "status"                           ? "int8"
                          : entry.name == "pulse" || entry.name == "pixel" ? "int32"
                                                                           : "float32");
  for (const DatasetEntry& entry : datasets_of(folder / "scan.h5", "pulses"))
    EXPECT_EQ(entry.type, entry.name == "point_count"   ? "int32"
                          : entry.name == "point_begin" ? "int64"
                                                        : "float64");
}

TEST(ScanWriter, TellsWhyThereIsNoReturn) {
  EXPECT_THAT(failure({.change =
                           [](PulseBatch& b) {
                             b.points.status = {miss, miss, dropout, dead, blanked, lost_in_optics};
                           }}),
              EndsWith("the scan has no return: 2 misses, 1 dropouts, 1 of dead pixels, 1 of blanked pulses, "
                       "1 lost in the scanner (total reflection); does the lidar point at the terrain?"));
}

}  // namespace
}  // namespace landfall
