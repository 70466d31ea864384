// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/points/cloud_fields.h"

namespace landfall {

/// The keys of a GeoTIFF, by which LAS files describe their CRS.
struct CloudGeoKeys {
  std::vector<std::uint16_t> directory;
  std::vector<double> numbers;
  std::string texts;
};

/// Coordinates that are stored as integers: X = (x - offset)/scale.
struct CloudSteps {
  std::array<double, 3> scale;
  std::array<double, 3> offset;
};

/// The extent of the points that a file declares, on its axes.
struct CloudBox {
  std::array<double, 3> low;
  std::array<double, 3> high;
};

/// The statements of a file before its points are read.
struct CloudInfo {
  std::string format;                         ///< "LAS 1.4, point format 6"
  CloudColumns columns;                       ///< which fields its points have
  CloudUnits units{};                         ///< of these fields
  std::optional<std::int64_t> point_count{};  ///< as declared; text declares none
  std::string crs_wkt{};                      ///< empty: none
  std::optional<CloudGeoKeys> geo_keys{};     ///< only without a crs_wkt
  std::optional<CloudSteps> steps{};
  std::optional<CloudBox> box{};
  std::array<bool, 3> is_float32{};  ///< coordinates that the file declares as float32
  std::string clock{};               ///< the clock of t, if the file states it; its unit is then the second
  /// Added to t: the first of times that are integers beyond 2^53, which a double cannot hold.
  std::int64_t time_base = 0;
  std::vector<std::string> notes{};  ///< ignored or assumed statements; sentences without the file's name

  [[nodiscard]] bool has(CloudField field) const {
    return columns[static_cast<std::size_t>(field)].has_value();
  }
};

/// A file with these columns and no other statements.
[[nodiscard]] inline CloudInfo info_of(std::string format, CloudTable table) {
  CloudInfo info{.format = std::move(format), .columns = table.columns, .units = std::move(table.units)};
  info.notes = std::move(table.notes);
  return info;
}

/// Consecutive points. A column that the file lacks is empty; the others have one length.
struct CloudBatch {
  std::array<std::vector<double>, kCloudFieldCount> columns;

  [[nodiscard]] std::vector<double>& operator[](CloudField field) {
    return columns[static_cast<std::size_t>(field)];
  }
  [[nodiscard]] const std::vector<double>& operator[](CloudField field) const {
    return columns[static_cast<std::size_t>(field)];
  }
  [[nodiscard]] std::size_t size() const { return columns[0].size(); }
  [[nodiscard]] bool has_position(std::size_t i) const {
    return std::isfinite(columns[0][i]) && std::isfinite(columns[1][i]) && std::isfinite(columns[2][i]);
  }
  /// Keeps the points for which keep(i) holds, in their order; keep() sees each point once, not yet moved.
  template <class Keep>
  void keep_if(const Keep& keep) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (!keep(i)) continue;
      if (kept != i)
        for (auto& column : columns)
          if (!column.empty()) column[kept] = column[i];
      ++kept;
    }
    for (auto& column : columns)
      if (!column.empty()) column.resize(kept);
  }
};

/// The classification of points that LAS marks as withheld: they are deleted but still in the file.
inline constexpr double kWithheld = -1;

/// Whether a classification says that a point is noise (classes 7 and 18 of LAS) or withheld.
[[nodiscard]] constexpr bool is_noise(double classification) {
  return classification == 7 || classification == 18 || classification == kWithheld;
}

/// Reads the points of a file batch by batch, in bounded memory; the values of a batch are decoded on all
/// threads and do not depend on them.
class CloudReader {
 public:
  virtual ~CloudReader() = default;
  CloudReader(const CloudReader&) = delete;
  CloudReader& operator=(const CloudReader&) = delete;

  [[nodiscard]] const CloudInfo& info() const { return info_; }
  /// Reads the next points; false after the last one. Throws FormatError, naming the file and the line or the
  /// point, for one that cannot be read.
  virtual bool next(CloudBatch& batch) = 0;
  /// Begins again with the first point.
  virtual void rewind() = 0;
  /// The part of the file that next() has read.
  [[nodiscard]] virtual double progress() const = 0;

 protected:
  CloudReader() = default;
  CloudInfo info_;
};

/// True for a file that is read as points. Its content decides: LAS, PLY, PCD, E57 and QFIT by their first
/// bytes, text with rows of at least three numbers, unless it begins as grids of Esri, Surfer or GRASS do. A
/// file that is missing, or whose content is none of these, is points by the extension (.csv, .txt, .xyz,
/// .pts, .ptx, .dat, .qi, .las, .laz, .ply, .pcd, .e57), unless it is text of a grid or begins as binary.
[[nodiscard]] bool is_cloud_file(const std::filesystem::path& path);

/// Opens LAS 1.0 to 1.4 (point formats 0 to 10), PLY, PCD (ascii, binary, binary_compressed), PTX, QFIT of
/// ATM and text: comma, semicolon, tab or blanks, with or without a header, and HELIOS++ xyz (11 columns
/// without a header). Rows of PTX and QFIT that are not points have the position NaN.
///
/// Throws FormatError, naming the file and what to do: LAZ and E57, other formats, a file that is shorter
/// than its header says, counts and offsets that do not fit, points without x, y or z, no points; UsageError
/// for a `choice` that does not fit.
[[nodiscard]] std::unique_ptr<CloudReader> open_cloud(const std::filesystem::path& path,
                                                      const ColumnChoice& choice = {});

}  // namespace landfall
