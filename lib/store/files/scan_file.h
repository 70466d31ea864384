// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/returns/columns.h"
#include "chain/gridding/grid_points.h"
#include "chain/lidar/simulation/scan_pipeline.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/column_reader.h"
#include "store/hdf5/table.h"

namespace landfall {

struct ScanFileOptions {
  bool keep_misses = false;       ///< a row per pixel and pulse, not only per return
  bool single_precision = false;  ///< coordinates and ranges as float32
  OptionalColumns columns{};      ///< those of the batches
};

/// Writes scan.h5 (docs/user/files/scan.md) batch by batch, in bounded memory.
class ScanWriter {
 public:
  /// `crs_wkt` is the site frame, from the terrain.
  ScanWriter(LandfallFileWriter& file, const ScanFileOptions& options, const std::string& crs_wkt);

  /// Before the first append: copies the columns that errors do not change, the truth and its indices, from
  /// `source`, the points of a scan with the same rows. True if batches no longer need to hold them.
  bool copy_truth(const TableReader& source);
  /// Takes the next pulses; the batch's points are reduced to the returns unless misses are kept. The
  /// returned work compresses and writes them.
  [[nodiscard]] SinkWork take(PulseBatch& batch);
  /// Writes /detector and the counts, and commits. Throws FormatError for a scan without any return.
  void commit(const Detector& detector, std::span<const std::int8_t> dead_map);

  [[nodiscard]] std::int64_t count(PointStatus status) const {
    return counts_.at(static_cast<std::size_t>(status));
  }

 private:
  [[noreturn]] void refuse_without_return() const;
  /// The chunks that a batch filled in a table.
  struct Taken {
    TableWriter* table;
    std::vector<TableWriter::ChunkPtr> chunks;
  };

  LandfallFileWriter& file_;
  ScanFileOptions options_;
  TableWriter points_;
  TableWriter pulses_;
  std::optional<TableWriter> later_echoes_;
  std::array<std::int64_t, kPointStatusCount> counts_{};
};

/// The rows of a scan that hold a return, with the columns that a DEM needs: only kCoordinates.
struct ScanPoints {
  PointColumns columns;
  std::vector<double> t;  ///< the time of the pulse since the reader's epoch

  [[nodiscard]] GridPoints view() const { return GridPoints::of(columns, t); }
};

/// The times of all pulses on the clock of the trajectory, as stored. Throws FormatError, naming the row, for
/// a time that is not finite.
[[nodiscard]] std::vector<double> read_pulse_times(const LandfallFileReader& scan);

/// The times of a scan's pulses, without the rounding of large times on a clock.
struct PulseTimes {
  double epoch_s = 0;             ///< what the clock shows at the first pulse; 0 without pulses
  std::vector<double> since_s{};  ///< since the first pulse
};

/// The times of read_pulse_times() as differences from the first one. If the stored times are those of pulses
/// at a constant rate f on the clock, rounded, they are k/f instead, which is exact for any epoch. `rate_hz`:
/// f, if it is known.
[[nodiscard]] PulseTimes times_since_first(std::vector<double> times_s, std::optional<double> rate_hz);
/// times_since_first() with the rate in the scan's configuration.
[[nodiscard]] PulseTimes read_pulse_times_since_first(const LandfallFileReader& scan);

/// Reads a scan.h5 in pieces, on all threads, in bounded memory.
class ScanReader {
 public:
  /// Throws FormatError unless the columns that a DEM needs exist and have one length, and all pulses have a
  /// time. Imported points need no truth, no pulses and no times.
  explicit ScanReader(const std::filesystem::path& path);

  [[nodiscard]] const LandfallFileReader& file() const { return file_; }
  [[nodiscard]] const std::string& crs_wkt() const { return crs_wkt_; }
  /// The time of the trajectory's clock at which times are 0: at first that of the scan's first pulse.
  [[nodiscard]] double epoch_s() const { return pulse_times_.epoch_s; }
  /// Counts the times from another epoch on the same clock from now on.
  void count_from(double epoch_s);
  /// The times of all pulses since the epoch.
  [[nodiscard]] const std::vector<double>& pulse_times_s() const { return pulse_times_.since_s; }
  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  /// False for imported points (imported_scan.h): read() gives their estimates as their truth.
  [[nodiscard]] bool has_truth() const { return !is_imported_; }
  /// False for imported points without times: read() gives the epoch.
  [[nodiscard]] bool has_times() const { return has_times_; }
  /// Reads the returns (and false returns) among rows [begin, begin + count). Throws FormatError, naming the
  /// row, for a return with a coordinate that is not finite or a pulse number that does not exist in /pulses.
  /// Fastest in order and by whole chunks (kTableChunkRows). Uses HDF5: no other thread may use it meanwhile.
  void read(std::size_t begin, std::size_t count, ScanPoints& points);

 private:
  [[nodiscard]] bool has_pulse(std::size_t i) const {
    return is_imported_ ||
           (pulse_[i] >= 0 && static_cast<std::size_t>(pulse_[i]) < pulse_times_.since_s.size());
  }
  /// The times of pulses are finite; those of imported points are their own.
  [[nodiscard]] bool has_valid_time(const ScanPoints& points, std::size_t i) const {
    return !is_imported_ || std::isfinite(points.t[i]);
  }
  [[nodiscard]] bool is_valid(const ScanPoints& points, std::size_t i) const;
  [[nodiscard]] bool all_valid(const ScanPoints& points, std::size_t first, std::size_t end) const;
  [[noreturn]] void fail_at_row(const ScanPoints& points, std::size_t i, std::size_t row) const;
  std::size_t keep_returns(ScanPoints& points, std::size_t first, std::size_t end) const;

  void read_columns(std::size_t begin, std::size_t count, ScanPoints& points);
  [[nodiscard]] const char* row_column() const;

  LandfallFileReader file_;
  TableReader points_;
  bool is_imported_;
  bool has_times_;
  ColumnReader columns_;
  PulseTimes pulse_times_;
  std::string crs_wkt_;
  std::size_t row_count_ = 0;
  std::vector<std::int32_t> pulse_;  ///< values of the rows being read
  std::vector<std::int8_t> status_;
};

}  // namespace landfall
