// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "chain/lidar/receiver/echo.h"
#include "chain/lidar/simulation/scan_pipeline.h"
#include "chain/lidar/simulation/simulation.h"
#include "store/files/landfall_file.h"
#include "store/files/terrain_file.h"
#include "store/hdf5/column_reader.h"
#include "store/hdf5/table.h"

namespace landfall {

/// Reads the echoes behind the first ones of a scan, the table kEchoGroup, in the order of the pulses and in
/// bounded memory.
class LaterEchoReader {
 public:
  /// `scan` has the table and must outlive this object.
  explicit LaterEchoReader(const LandfallFileReader& scan);

  /// The later echoes of these pulses; fastest if read in order. Throws FormatError, naming the row, for one
  /// out of order or of no pixel of the detector.
  [[nodiscard]] std::vector<LaterEcho> read(PulseSpan pulses, std::size_t pixel_count);

 private:
  void read_rows(std::size_t pixel_count);
  [[nodiscard]] bool is_next(const PulsePixel& where, std::size_t pixel_count) const;

  const LandfallFileReader& scan_;
  TableReader table_;
  std::size_t row_count_;
  std::size_t next_row_ = 0;
  std::optional<PulsePixel> last_;  ///< of the rows read so far
  std::vector<LaterEcho> held_;     ///< the last rows that were read
  std::ptrdiff_t given_ = 0;        ///< of the held ones that have been given out
  std::int64_t given_pulses_ = 0;   ///< those of the pulses before have been given out
};

/// The true ranges of an earlier scan, for a run that only draws new errors (--ranges-from).
class RangeFile {
 public:
  /// Throws FormatError unless it is a complete scan.
  explicit RangeFile(const std::filesystem::path& path);

  [[nodiscard]] const TableReader& points() const { return points_; }
  [[nodiscard]] const LandfallFileReader& file() const { return file_; }
  [[nodiscard]] std::size_t pulse_count() const { return pulse_count_; }

  /// The terrain that was scanned.
  [[nodiscard]] TerrainIdentity terrain() const;

  /// True if the scan was made with --keep-echoes.
  [[nodiscard]] bool keeps_echoes() const { return echoes_.has_value(); }
  /// True if it keeps also those behind the first ones.
  [[nodiscard]] bool keeps_later_echoes() const { return later_echoes_.has_value(); }
  /// True if it has a row for every pixel and pulse (--keep-misses).
  [[nodiscard]] bool keeps_misses() const;
  /// True if a pixel has a row for each return (/receiver/returns all).
  [[nodiscard]] bool has_several_returns() const;
  /// False if its ranges are in single precision (--float32).
  [[nodiscard]] bool has_exact_ranges() const;
  /// The true ranges, one per pixel and pulse, NaN for a miss, and the echoes if the scan keeps them; fastest
  /// if read in order. Throws FormatError if the file's rows are inconsistent, or a range is infinite or
  /// negative.
  [[nodiscard]] RecordedRanges read(PulseSpan pulses, std::size_t pixel_count);

 private:
  /// The rows of some pulses.
  struct PulseRows {
    std::vector<std::int64_t> begin;  ///< first row of each pulse in /points
    std::vector<std::int32_t> count;  ///< number of rows
    std::int64_t total = 0;

    /// True if every pulse has all its pixels, in their order, so that rows need no sorting.
    [[nodiscard]] bool hold_every_pixel(std::span<const std::int32_t> pixel, std::size_t pixel_count) const;
  };

  [[nodiscard]] PulseRows rows_of(PulseSpan pulses, std::int64_t max_rows);
  /// Sorts from row order to pixel order.
  [[nodiscard]] RecordedRanges by_pixel(const PulseRows& rows, const RecordedRanges& found,
                                        std::span<const std::int32_t> pixel, std::size_t pixel_count) const;
  [[nodiscard]] std::vector<Echo> read_echoes(std::size_t first_row, std::size_t count);

  LandfallFileReader file_;
  TableReader points_;
  TableReader pulses_;
  ColumnReader range_and_pixel_;
  ColumnReader begin_and_count_;
  std::optional<ColumnReader> echoes_;
  std::optional<LaterEchoReader> later_echoes_;
  std::size_t pulse_count_;
};

}  // namespace landfall
