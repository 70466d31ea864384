// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/scan_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "base/error.h"
#include "hdf5/dataset_list.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using enum PointStatus;
using testing::ElementsAre;
using testing::EndsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Two pulses of three pixels; x_est numbers the rows, and what a status leaves out is NaN.
PulseBatch small_batch() {
  PulseBatch batch;
  batch.resize(2, 3);
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

struct SmallScan {
  ScanFileOptions options{};
  std::function<void(PulseBatch&)> change = [](PulseBatch&) {};

  void write(const std::filesystem::path& path) const {
    const Detector detector({1, 3, 1}, std::vector<Direction<LidarFrame>>(3), {});
    LandfallFileWriter file({path}, "scan", {.tool = "scan-sim"});
    ScanWriter writer(file, options, "");
    PulseBatch batch = small_batch();
    change(batch);
    const SinkWork work = writer.take(batch);
    if (work.in_parallel) work.in_parallel();
    if (work.in_order) work.in_order();
    writer.commit(detector, std::vector<std::int8_t>(3));
  }
};

ScanPoints read_all(const SmallScan& scan) {
  const TemporaryFolder folder;
  scan.write(folder / "scan.h5");
  ScanReader reader(folder / "scan.h5");
  ScanPoints points;
  reader.read(0, reader.row_count(), points);
  return points;
}

std::string failure(const SmallScan& scan) {
  try {
    static_cast<void>(read_all(scan));
  } catch (const FormatError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ScanReader, ReadsTheReturnsWithTheirTimes) {
  for (const bool keep_misses : {false, true}) {
    const ScanPoints points = read_all({.options = {.keep_misses = keep_misses}});
    EXPECT_THAT(points.columns.x_est, ElementsAre(1, 2, 4));
    EXPECT_THAT(points.columns.z_true, ElementsAre(1, 2, 4));
    EXPECT_THAT(points.t, ElementsAre(0.5, 0.5, 1.5));
    EXPECT_EQ(points.view().t.data(), points.t.data());
    EXPECT_EQ(points.view().y_true.data(), points.columns.y_true.data());
  }
}

// Row 4 is the third return: rows are those of the file, also where misses before it are left out.
TEST(ScanReader, NamesTheRowAndColumnOfTheFileThatIsNotFinite) {
  for (const auto member : kCoordinates)
    for (const double value : {kNan, kInfinity, -kInfinity})
      EXPECT_THAT(failure({.options = {.keep_misses = true},
                           .change = [&](PulseBatch& b) { (b.points.*member)[4] = value; }}),
                  EndsWith("/points/" + std::string(name_of(member)) + "[4] of a return is not finite"));
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
    EXPECT_THAT(
        failure({.options = {.keep_misses = true}, .change = [&](PulseBatch& b) { b.pulses.t[1] = value; }}),
        EndsWith("/pulses/t[1] is not finite"));
}

TEST(ScanReader, NamesTheRowOfAPulseThatIsNotThere) {
  for (const int pulse : {-1, 2})
    EXPECT_THAT(failure({.options = {.keep_misses = true},
                         .change = [&](PulseBatch& b) { b.points.pulse[4] = pulse; }}),
                EndsWith("/points/pulse[4] = " + std::to_string(pulse) + " is no row of /pulses (2)"));
}

std::vector<DatasetEntry> datasets_of(const std::filesystem::path& path, const char* group) {
  const LandfallFileReader file(path, {"scan"});
  return list_datasets(TableReader(file.root(), group, file.name()).group());
}

template <class Columns>
void expect_as_declared(const std::vector<DatasetEntry>& found, const Columns& columns) {
  ASSERT_EQ(found.size(), std::tuple_size_v<Columns>);
  auto entry = found.begin();
  for_each_column(columns, [&](const auto& column) {
    EXPECT_EQ(entry->name, column.name);
    EXPECT_EQ(entry->units, column.units);
    EXPECT_EQ(entry->long_name, column.long_name);
    ++entry;
  });
}

TEST(ScanWriter, WritesTheDeclaredColumnsInTheirOrder) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  const std::vector<DatasetEntry> points = datasets_of(folder / "scan.h5", "points");
  expect_as_declared(points, kPointColumns);
  expect_as_declared(datasets_of(folder / "scan.h5", "pulses"), kPulseColumns);
  EXPECT_THAT(points.back().flag_values, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_EQ(points.back().flag_meanings.at(5), "total_reflection");
}

TEST(ScanWriter, SinglePrecisionIsForTheDoublesOfPoints) {
  const TemporaryFolder folder;
  SmallScan{.options = {.single_precision = true}}.write(folder / "scan.h5");
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
                       "1 lost in the scanner (total reflection); does it look at the terrain?"));
}

}  // namespace
}  // namespace landfall
