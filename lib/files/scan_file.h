// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/landfall_file.h"
#include "hdf5/column_reader.h"
#include "hdf5/table.h"
#include "simulation/scan_pipeline.h"

namespace landfall {

struct ScanFileOptions {
  bool keep_misses = false;       ///< a row per pixel and pulse, not only per return
  bool single_precision = false;  ///< coordinates and ranges as float32
};

/// Writes scan.h5 (SPEC section 8) batch by batch, in bounded memory.
class ScanWriter {
 public:
  /// `crs_wkt` is the site frame, from the terrain.
  ScanWriter(LandfallFileWriter& file, const ScanFileOptions& options, const std::string& crs_wkt);

  /// Before the first append: takes the columns that errors do not change, the truth and where it belongs,
  /// from `source`, the points of a scan with the same rows. True where batches need not hold them any more.
  bool copy_truth(const TableReader& source);
  /// Takes the next pulses; the batch's points are cut to the returns unless misses are kept. What it returns
  /// compresses and writes.
  [[nodiscard]] SinkWork take(PulseBatch& batch);
  /// Writes /detector and the counts, and commits. Throws FormatError for a scan without a single return.
  void commit(const Detector& detector, std::span<const std::int8_t> dead_map);

  /// Points by what became of them, as the attributes of /points have them.
  [[nodiscard]] std::array<std::pair<const char*, std::int64_t>, 5> counts() const;

 private:
  [[nodiscard]] std::int64_t count(PointStatus status) const {
    return counts_.at(static_cast<std::size_t>(status));
  }
  [[noreturn]] void refuse_without_return() const;
  using Chunks = std::vector<TableWriter::ChunkPtr>;
  [[nodiscard]] Chunks take_points(const PointColumns& points);
  [[nodiscard]] Chunks take_pulses(const PulseColumns& pulses);

  LandfallFileWriter& file_;
  ScanFileOptions options_;
  TableWriter points_;
  TableWriter pulses_;
  std::array<std::int64_t, kPointStatusCount> counts_{};
};

/// Rows of a scan that hold a return, as regrid wants them; t is the pulse's time.
struct ScanPoints {
  std::vector<double> x_est, y_est, z_est, x_true, y_true, z_true, t;
  [[nodiscard]] std::size_t size() const { return x_est.size(); }
};

/// Reads a scan.h5 in pieces, on all threads, in bounded memory.
class ScanReader {
 public:
  /// Throws FormatError unless the columns that a DEM needs are there, of one length.
  explicit ScanReader(const std::filesystem::path& path);

  [[nodiscard]] const LandfallFileReader& file() const { return file_; }
  [[nodiscard]] const std::string& crs_wkt() const { return crs_wkt_; }
  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  /// The returns (and false returns) among rows [begin, begin + count). Throws FormatError, naming the row,
  /// for a return with a coordinate that is not finite or a pulse number that /pulses does not have. Fastest
  /// in order and by whole chunks (kTableChunkRows). Uses HDF5: nothing else may meanwhile.
  void read(std::size_t begin, std::size_t count, ScanPoints& points);

 private:
  [[nodiscard]] bool is_valid(const ScanPoints& points, std::size_t i) const;
  [[nodiscard]] bool all_valid(const ScanPoints& points, std::size_t first, std::size_t end) const;
  [[noreturn]] void fail_at_row(const ScanPoints& points, std::size_t i, std::size_t row) const;
  std::size_t keep_returns(ScanPoints& points, std::size_t first, std::size_t end) const;

  LandfallFileReader file_;
  TableReader points_;
  ColumnReader columns_;
  std::vector<double> pulse_times_s_;
  std::string crs_wkt_;
  std::size_t row_count_ = 0;
  std::vector<std::int32_t> pulse_;  ///< of the rows being read
  std::vector<std::int8_t> status_;
};

}  // namespace landfall
