// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/core/progress.h"
#include "base/output/byte_sink.h"
#include "formats/gdal/map_frame.h"
#include "store/files/contents.h"
#include "store/files/scan_file.h"

namespace landfall {

/// Selects rows of a scan's /points.
struct PointSelection {
  /// Returns and false returns, which are all rows of a file without the column status; else every row.
  bool only_returns = true;
  std::size_t every = 1;  ///< of those rows, the first and every N-th after it; >= 1
};

/// The rows of one column in a batch. Floating-point columns are read as double.
using ColumnValues = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::int32_t>,
                                  std::vector<std::int8_t>>;

/// A piece of /points: consecutive rows of the file, and which of them are selected.
struct PointBatch {
  std::size_t first_row = 0;            ///< in the file
  std::vector<ColumnValues> columns;    ///< in the requested order, all rows of the piece
  std::vector<std::uint32_t> selected;  ///< ascending positions in `columns`

  /// The values of a floating-point column.
  [[nodiscard]] const std::vector<double>& real(std::size_t column) const {
    return std::get<std::vector<double>>(columns[column]);
  }
  /// A value of any column as a double; an int64 beyond 2^53 is rounded.
  [[nodiscard]] double number(std::size_t column, std::size_t row) const;
};

/// The points of a scan.h5, read batch by batch in bounded memory, in any number of passes.
class PointReader {
 public:
  /// Throws FormatError unless the file is a scan with the columns that a point cloud needs: the estimated
  /// positions. Imported scans have neither true positions nor /pulses, and not every other column.
  explicit PointReader(const std::filesystem::path& path);

  [[nodiscard]] const LandfallFileReader& file() const { return file_; }
  /// The file's columns, and `t`, the time of the point's pulse, if the file has the pulse times.
  [[nodiscard]] const std::vector<ContentInfo>& columns() const { return columns_; }
  [[nodiscard]] bool has(const std::string& name) const;
  /// From now on positions are read in the coordinates of a map.
  void place_on(MapFrame map);
  [[nodiscard]] const std::optional<MapFrame>& map() const { return map_; }
  /// Throws UsageError, listing the existing columns, for an unknown column.
  [[nodiscard]] const ContentInfo& column(const std::string& name) const;
  /// A column as it is read: on a map x_est is "easting" or "longitude" in the map's unit, and so on.
  [[nodiscard]] ContentInfo read_column(const std::string& name) const;
  /// The columns of these names, in their order; without names: those of the file. Throws UsageError for an
  /// unknown name or one that is given twice.
  [[nodiscard]] std::vector<std::string> choose(const std::vector<std::string>& names) const;
  [[nodiscard]] std::size_t row_count() const { return row_count_; }
  /// Points that landfall did not make: no truth, and times of their own or none.
  [[nodiscard]] bool is_imported() const { return is_imported_; }
  /// The times of the pulses; empty if the file has none.
  [[nodiscard]] const PulseTimes& pulse_times() const { return pulse_times_; }
  /// The number of selected rows. Reads the column `status`, once for each selection.
  [[nodiscard]] std::size_t count(const PointSelection& selection) const;

  /// Defines what one pass reads.
  struct Pass {
    std::vector<std::string> columns;
    PointSelection selection;
    /// In these columns (the first ones of `columns`) every selected value must be finite.
    std::size_t finite_columns = 0;
    /// The column `t` counts so that the first pulse has this time, without the rounding of large times;
    /// nothing: as stored.
    std::optional<double> first_time_s = {};
  };
  /// Calls use(batch) for all rows in order; later batches are read meanwhile. Throws FormatError, naming
  /// file, column and row, for a value that must be finite and is not, for a position without coordinates on
  /// the map, and for a pulse number that does not exist in /pulses; UsageError where the map needs x and y
  /// and the pass has one of them.
  void read(const Pass& pass, const std::function<void(const PointBatch& batch)>& use,
            const ProgressCallback& progress = {}) const;

 private:
  class BatchSource;
  void require_positions() const;

  LandfallFileReader file_;
  TableReader points_;
  std::vector<ContentInfo> columns_;
  bool is_imported_;
  std::vector<double> stored_times_s_;
  PulseTimes pulse_times_;
  std::size_t row_count_ = 0;
  std::optional<MapFrame> map_;
};

/// The names of the columns x, y and z of the estimated (`position` "est") or true ("true") positions.
[[nodiscard]] std::vector<std::string> position_columns(const std::string& position);

/// Appends the bytes of the rows at these positions of a batch to `out`.
using EncodeRows =
    std::function<void(const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out)>;

/// Reads a pass and writes the bytes that `encode` appends for the selected rows, in order. Rows are encoded
/// on all threads, in pieces that do not depend on the number of threads.
void write_points(const PointReader& points, const PointReader::Pass& pass, const EncodeRows& encode,
                  ByteSink& sink, const ProgressCallback& progress = {});

}  // namespace landfall
