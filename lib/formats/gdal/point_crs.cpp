// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D406
// LAS describes its CRS by the keys of a GeoTIFF. GDAL reads these from a raster only, so they are put in one
// of a single pixel, in memory.
#include "formats/gdal/point_crs.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <array>
#include <cmath>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/known_crs.h"
#include "formats/gdal/open_raster.h"
#include "formats/gdal/registry.h"
#include "formats/gdal/site_relation.h"

namespace landfall {
namespace {

constexpr std::uint16_t kShort = 3;
constexpr std::uint16_t kLong = 4;
constexpr std::uint16_t kDouble = 12;
constexpr std::uint16_t kAscii = 2;

/// A TIFF of one pixel with the keys.
class KeyTiff {
 public:
  explicit KeyTiff(const PointCrs& points) {
    add_number(256, kLong, 1);
    add_number(257, kLong, 1);
    add_number(258, kShort, 8);
    add_number(259, kShort, 1);
    add_number(262, kShort, 1);
    add_number(273, kLong, 8);  // the pixel lies behind the header
    add_number(277, kShort, 1);
    add_number(278, kLong, 1);
    add_number(279, kLong, 1);
    add(34735, kShort, points.key_directory.size(), raw(points.key_directory));
    if (!points.key_numbers.empty()) add(34736, kDouble, points.key_numbers.size(), raw(points.key_numbers));
    if (!points.key_texts.empty()) add(34737, kAscii, points.key_texts.size() + 1, points.key_texts + '\0');
  }

  [[nodiscard]] std::string bytes() const {
    constexpr std::size_t kDirectory = 12;
    std::string directory;
    std::string values;
    const std::size_t values_at = kDirectory + 2 + 12 * tags_.size() + 4;
    append_raw(directory, static_cast<std::uint16_t>(tags_.size()));
    for (const Tag& tag : tags_) {
      append_raw(directory, tag.id);
      append_raw(directory, tag.type);
      append_raw(directory, static_cast<std::uint32_t>(tag.count));
      if (tag.values.size() <= 4) {
        directory += tag.values + std::string(4 - tag.values.size(), '\0');
        continue;
      }
      append_raw(directory, static_cast<std::uint32_t>(values_at + values.size()));
      values += tag.values;
      if (values.size() % 2 != 0) values += '\0';
    }
    append_raw(directory, std::uint32_t{0});
    std::string file = "II*";
    file += '\0';
    append_raw(file, static_cast<std::uint32_t>(kDirectory));
    append_raw(file, std::uint32_t{0});
    return file + directory + values;
  }

 private:
  struct Tag {
    std::uint16_t id, type;
    std::size_t count;
    std::string values;
  };

  template <class T>
  static std::string raw(const std::vector<T>& numbers) {
    std::string bytes;
    for (const T number : numbers) append_raw(bytes, number);
    return bytes;
  }
  void add(std::uint16_t id, std::uint16_t type, std::size_t count, std::string values) {
    tags_.push_back({id, type, count, std::move(values)});
  }
  /// A short number has the same first bytes.
  void add_number(std::uint16_t id, std::uint16_t type, std::uint32_t number) {
    add(id, type, 1, raw(std::vector{number}));
  }

  std::vector<Tag> tags_;
};

OGRSpatialReference crs_of_keys(const PointCrs& points, const std::string& name) {
  constexpr const char* kPath = "/vsimem/landfall_point_keys.tif";
  std::string bytes = KeyTiff(points).bytes();
  VSIFCloseL(VSIFileFromMemBuffer(kPath, reinterpret_cast<GByte*>(bytes.data()), bytes.size(), FALSE));
  const GdalErrors errors;
  OGRSpatialReference crs;
  {
    const StrictReading with_vertical_crs;
    constexpr std::array<const char*, 2> kDrivers = {"GTiff", nullptr};
    const GDALDatasetUniquePtr dataset(
        GDALDataset::Open(kPath, GDAL_OF_RASTER | GDAL_OF_INTERNAL, kDrivers.data()));
    if (dataset != nullptr && dataset->GetSpatialRef() != nullptr) crs = *dataset->GetSpatialRef();
  }
  VSIUnlink(kPath);
  require_known_crs(&crs, name, errors, "give the CRS");
  if (crs.IsEmpty() != 0)
    throw FormatError(name + ": the GeoTIFF keys of its CRS cannot be read: give the CRS with --crs");
  return crs;
}

/// The unit of heights, key 4099.
std::optional<double> height_unit_of_keys(const std::vector<std::uint16_t>& directory) {
  constexpr std::uint16_t kVerticalUnits = 4099;
  for (std::size_t i = 4; i + 3 < directory.size(); i += 4) {
    if (directory[i] != kVerticalUnits || directory[i + 1] != 0) continue;
    if (directory[i + 3] == 9001) return 1;
    if (directory[i + 3] == 9002) return 0.3048;
    if (directory[i + 3] == 9003) return 1200.0 / 3937.0;
  }
  return std::nullopt;
}

std::optional<double> height_unit_of(const OGRSpatialReference& crs) {
  double metres = 0;
  if (crs.IsCompound() != 0) metres = crs.GetTargetLinearUnits("VERT_CS");
  OGRAxisOrientation orientation = OAO_Up;
  if (crs.IsCompound() == 0 && crs.GetAxesCount() == 3) crs.GetAxis(nullptr, 2, &orientation, &metres);
  if (!(std::isfinite(metres) && metres > 0)) return std::nullopt;
  return metres;
}

OGRSpatialReference crs_of_wkt(const std::string& wkt, const std::string& name) {
  const GdalErrors errors;
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE)
    throw FormatError(name + ": its CRS is not WKT that can be read: give the CRS with --crs");
  require_known_crs(&crs, name, errors, "give the CRS");
  return crs;
}

/// The name of the file's CRS, if it has one that can be read and that is not this one.
std::string other_crs_of_file(PointCrs file, const OGRSpatialReference& crs, const std::string& name) {
  file.option.clear();
  if (!file.is_given()) return "";
  try {
    const ReadCrs own = read_point_crs(file, name);
    if (own.crs.IsSame(&crs) != 0) return "";
    return own.crs.GetName() != nullptr ? own.crs.GetName() : "unnamed";
  } catch (const FormatError&) {
    return "";  // the option replaces a CRS that cannot be read
  }
}

}  // namespace

OGRSpatialReference crs_of_text(const std::string& text, const std::string& name) {
  require_crs_database(name);
  const GdalErrors errors;
  OGRSpatialReference crs;
  const char* const options[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};
  if (crs.SetFromUserInput(text.c_str(), options) != OGRERR_NONE)
    throw UsageError(
        name + ": '" + shown_word(text) +
        "' is not a CRS: give EPSG:NUMBER, a PROJ text or WKT, such as gdalsrsinfo -o wkt1 FILE prints" +
        (errors.any() ? " (" + errors.reason() + ")" : ""));
  if (is_vertical_only(crs))
    throw UsageError(name + ": '" + shown_word(text) + "' is a CRS of heights alone: give that of x and y");
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

ReadCrs read_point_crs(const PointCrs& points, const std::string& name) {
  prepare_gdal_to_read(name, Unguarded::withheld);
  const GdalErrors errors;
  require_crs_database(name);
  ReadCrs read;
  if (!points.option.empty())
    read.crs = crs_of_text(points.option, "--crs");
  else if (!points.wkt.empty())
    read.crs = crs_of_wkt(points.wkt, name);
  else
    read.crs = crs_of_keys(points, name);
  read.metres_per_height = height_unit_of(read.crs);
  if (points.option.empty() && points.wkt.empty())
    if (const auto unit = height_unit_of_keys(points.key_directory)) read.metres_per_height = unit;
  read.vertical = vertical_datum_of(read.crs);
  read.crs.StripVertical();
  read.crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (!points.option.empty()) read.replaced = other_crs_of_file(points, read.crs, name);
  return read;
}

}  // namespace landfall
