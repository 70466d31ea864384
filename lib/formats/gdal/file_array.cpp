// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/gdal/file_array.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"
#include "base/text/characters.h"
#include "base/text/number_text.h"
#include "formats/gdal/raster_files.h"

namespace landfall {
namespace {

using Array = std::shared_ptr<GDALMDArray>;
using Group = std::shared_ptr<GDALGroup>;

bool is_one_of(const std::string& text, std::initializer_list<const char*> words) {
  return std::ranges::any_of(words, [&](const char* word) { return text == word; });
}

std::string text_attribute(const GDALMDArray& array, const char* name) {
  const auto attribute = array.GetAttribute(name);
  if (!attribute || attribute->GetDataType().GetClass() != GEDTC_STRING) return "";
  const char* const text = attribute->ReadAsString();
  return text != nullptr ? text : "";
}

struct Numbers {
  std::vector<double> values;
  GDALDataType type = GDT_Unknown;
};

Numbers number_attribute(const GDALMDArray& array, const char* name) {
  const auto attribute = array.GetAttribute(name);
  if (!attribute || attribute->GetDataType().GetClass() != GEDTC_NUMERIC) return {};
  return {attribute->ReadAsDoubleArray(), attribute->GetDataType().GetNumericDataType()};
}

/// "z" of NETCDF:"f.nc":z and of HDF5:"f.h5"://z; empty where the name of the raster names no array.
std::string named_array(const std::string& path) {
  const bool is_netcdf = lower_case(path.substr(0, 7)) == "netcdf:";
  if (!is_netcdf && lower_case(path.substr(0, 5)) != "hdf5:") return "";
  const std::size_t quote = path.rfind("\":");
  const std::size_t begin = quote != std::string::npos ? quote + 2 : path.rfind(':') + 1;
  std::string name = path.substr(begin);
  return name.substr(std::min(name.find_first_not_of('/'), name.size()));
}

/// Whether the last two dimensions of an array, which has so many, are those of a raster.
bool has_size(const GDALMDArray& array, const RasterSize& size) {
  const auto& dimensions = array.GetDimensions();
  const auto length = [&](std::size_t from_end) {
    return static_cast<std::int64_t>(dimensions[dimensions.size() - from_end]->GetSize());
  };
  return length(1) == size.cols && length(2) == size.rows;
}

void add_arrays(const Group& group, const RasterSize& size, int depth, std::vector<Array>& found) {
  for (const std::string& name : group->GetMDArrayNames()) {
    Array array = group->OpenMDArray(name);
    if (!array || array->GetDimensionCount() < 2) continue;
    if (has_size(*array, size)) found.push_back(std::move(array));
  }
  if (depth == 0) return;
  for (const std::string& name : group->GetGroupNames())
    if (const Group inner = group->OpenGroup(name)) add_arrays(inner, size, depth - 1, found);
}

Array array_of(const OpenRaster& raster, const DemBase& dem, const Group& root) {
  std::string name = named_array(dem.path);
  if (const char* const variable = raster.band->GetMetadataItem("NETCDF_VARNAME");
      name.empty() && variable != nullptr)
    name = variable;
  if (!name.empty()) {
    if (Array array = root->OpenMDArrayFromFullname("/" + name)) return array;
  }
  std::vector<Array> found;
  constexpr int kDepth = 4;
  add_arrays(root, raster.size, kDepth, found);
  return found.size() == 1 ? found.front() : nullptr;
}

/// Half the distance of neighbouring numbers of a floating-point type at `value`; 0 for integers.
double rounding_of(GDALDataType type, double value) {
  const double step = type == GDT_Float32   ? static_cast<double>(std::numeric_limits<float>::epsilon())
                      : type == GDT_Float64 ? std::numeric_limits<double>::epsilon()
                                            : 0;
  return 0.5 * step * std::abs(value);
}

/// Scale and offset, which the driver of HDF5 leaves among the attributes.
std::optional<double> packing_number(const GDALMDArray& array, const char* attribute) {
  const Numbers numbers = number_attribute(array, attribute);
  return numbers.values.size() == 1 ? std::optional(numbers.values[0]) : std::nullopt;
}

void set_role(const GDALMDArray* variable, FileAxis& axis) {
  const std::string name = lower_case(axis.name);
  if (variable != nullptr) {
    const std::string role = lower_case(text_attribute(*variable, "axis"));
    const std::string standard = lower_case(text_attribute(*variable, "standard_name"));
    axis.is_easting =
        role == "x" || is_one_of(standard, {"projection_x_coordinate", "longitude", "grid_longitude"});
    axis.is_northing =
        role == "y" || is_one_of(standard, {"projection_y_coordinate", "latitude", "grid_latitude"});
    if (axis.is_easting || axis.is_northing) return;
  }
  axis.is_easting = is_one_of(name, {"x", "lon", "long", "longitude", "easting", "east", "e"});
  axis.is_northing = is_one_of(name, {"y", "lat", "latitude", "northing", "north", "n"});
}

FileAxis axis_of(const GDALDimension& dimension) {
  FileAxis axis;
  axis.name = dimension.GetName();
  const Array variable = dimension.GetIndexingVariable();
  set_role(variable.get(), axis);
  if (!variable || variable->GetDimensionCount() != 1 || variable->GetDataType().GetClass() != GEDTC_NUMERIC)
    return axis;
  axis.unit = variable->GetUnit();
  std::vector<double> values(static_cast<std::size_t>(dimension.GetSize()));
  const GUInt64 start = 0;
  const std::size_t count = values.size();
  if (!variable->Read(&start, &count, nullptr, nullptr, GDALExtendedDataType::Create(GDT_Float64),
                      values.data()))
    return axis;
  const double factor = packing_number(*variable, "scale_factor").value_or(1);
  const double offset = packing_number(*variable, "add_offset").value_or(0);
  double largest = 0;
  for (double& value : values) {
    largest = std::max(largest, std::abs(value));
    value = factor * value + offset;
  }
  const GDALDataType type = variable->GetDataType().GetNumericDataType();
  axis.rounding = std::abs(factor) * rounding_of(type, largest);
  axis.values = std::move(values);
  return axis;
}

std::optional<ValidRange> valid_range(const GDALMDArray& array) {
  ValidRange range{-kInfinity, kInfinity};
  const GDALDataType packed = array.GetDataType().GetNumericDataType();
  const auto take = [&](const Numbers& numbers) {
    // CF: limits of the type of the packed data apply to it, limits of another type to the unpacked data.
    range.unpacked = range.unpacked || numbers.type != packed;
  };
  if (const Numbers both = number_attribute(array, "valid_range"); both.values.size() == 2) {
    take(both);
    return ValidRange{both.values[0], both.values[1], range.unpacked};
  }
  const Numbers low = number_attribute(array, "valid_min");
  const Numbers high = number_attribute(array, "valid_max");
  if (low.values.size() != 1 && high.values.size() != 1) return std::nullopt;
  if (low.values.size() == 1) {
    range.low = low.values[0];
    take(low);
  }
  if (high.values.size() == 1) {
    range.high = high.values[0];
    take(high);
  }
  return range;
}

bool counts_downwards(const GDALMDArray& array) {
  const std::string standard = lower_case(text_attribute(array, "standard_name"));
  return lower_case(text_attribute(array, "positive")) == "down" || standard.starts_with("depth") ||
         standard.find("_depth") != std::string::npos;
}

/// Compares rows of the array with rows of the raster.
class RowComparison {
 public:
  RowComparison(const OpenRaster& raster, const GDALMDArray& array, int band)
      : raster_(raster),
        array_(array),
        row_(static_cast<std::size_t>(raster.size.cols)),
        start_(array.GetDimensionCount()),
        count_(array.GetDimensionCount(), 1) {
    const auto& dimensions = array.GetDimensions();
    auto left = static_cast<GUInt64>(band - 1);
    for (std::size_t i = dimensions.size() - 2; i-- > 0;) {
      start_[i] = left % dimensions[i]->GetSize();
      left /= dimensions[i]->GetSize();
    }
    count_.back() = row_.size();
  }

  /// Whether the raster's rows are in reverse order; none where that cannot be seen because the array is
  /// symmetric. Throws FormatError where they are in neither order.
  std::optional<bool> reversed(const std::string& path) {
    constexpr std::int64_t kProbes = 64;
    const std::int64_t step = std::max<std::int64_t>(1, raster_.size.rows / kProbes);
    const std::optional<bool> probed = reversed_by(step, path);
    return probed || step == 1 ? probed : reversed_by(1, path);
  }

 private:
  std::optional<bool> reversed_by(std::int64_t step, const std::string& path) {
    const std::int64_t rows = raster_.size.rows;
    for (std::int64_t row = 0; row < rows; row += step) {
      const std::vector<double> read = raster_row(row);
      const bool same = equal(read, array_row(row));
      const bool mirrored = equal(read, array_row(rows - 1 - row));
      if (!same && !mirrored)
        throw FormatError(path + ": the rows that GDAL reads are not rows of the array '" + array_.GetName() +
                          "'; export it again, or convert it with gdalmdimtranslate");
      if (same != mirrored) return mirrored;
    }
    return std::nullopt;
  }

  std::vector<double> raster_row(std::int64_t row) {
    std::vector<double> values(row_.size());
    const auto cols = static_cast<int>(row_.size());
    const CPLErr status = raster_.band->RasterIO(GF_Read, 0, static_cast<int>(row), cols, 1, values.data(),
                                                 cols, 1, GDT_Float64, 0, 0, nullptr);
    if (status != CE_None) values.clear();
    if (is_signed_byte(*raster_.band)) std::ranges::transform(values, values.begin(), as_signed_byte);
    return values;
  }
  const std::vector<double>& array_row(std::int64_t row) {
    start_[start_.size() - 2] = static_cast<GUInt64>(row);
    row_.resize(count_.back());
    if (!array_.Read(start_.data(), count_.data(), nullptr, nullptr,
                     GDALExtendedDataType::Create(GDT_Float64), row_.data()))
      row_.clear();
    return row_;
  }
  static bool equal(const std::vector<double>& a, const std::vector<double>& b) {
    // A row that cannot be read says nothing; the reader refuses it.
    if (a.empty() || b.empty()) return true;
    return std::ranges::equal(a, b,
                              [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  }

  const OpenRaster& raster_;
  const GDALMDArray& array_;
  std::vector<double> row_;
  std::vector<GUInt64> start_;
  std::vector<std::size_t> count_;
};

std::string multidimensional_driver(const OpenRaster& raster) {
  const std::string driver = GDALGetDriverShortName(raster.dataset->GetDriver());
  if (driver == "netCDF") return "netCDF";
  return driver == "HDF5" || driver == "HDF5Image" ? "HDF5" : "";
}

FileArray description(const GDALMDArray& array) {
  FileArray result;
  result.name = array.GetName();
  const auto& dimensions = array.GetDimensions();
  result.columns = axis_of(*dimensions[dimensions.size() - 1]);
  result.rows = axis_of(*dimensions[dimensions.size() - 2]);
  result.unit = array.GetUnit();
  result.scale = packing_number(array, "scale_factor");
  result.offset = packing_number(array, "add_offset");
  for (const char* const name : {"_FillValue", "missing_value"})
    for (const double fill : number_attribute(array, name).values) result.fills.push_back(fill);
  result.valid = valid_range(array);
  result.downwards = counts_downwards(array);
  return result;
}

/// From a coordinate to the next, in the mean.
double step_of_axis(const FileAxis& axis) {
  return (axis.values.back() - axis.values.front()) / static_cast<double>(axis.values.size() - 1);
}

void require_even(const FileAxis& axis, const DemBase& dem) {
  const auto refuse = [&](std::size_t i, const std::string& what) {
    throw FormatError(dem.path + ": coordinate variable '" + axis.name + "': value " + std::to_string(i) +
                      ", " + number_text(axis.values[i]) + ", " + what +
                      "; resample the raster on an even grid");
  };
  for (std::size_t i = 0; i < axis.values.size(); ++i)
    if (!std::isfinite(axis.values[i])) refuse(i, "is not finite");
  const double step = step_of_axis(axis);
  if (step == 0) refuse(axis.values.size() - 1, "is that of the first one: there is no spacing");
  constexpr double kTolerance = 1e-3;  // of a pixel
  for (std::size_t i = 1; i < axis.values.size(); ++i) {
    const double off = std::abs(axis.values[i] - (axis.values.front() + static_cast<double>(i) * step));
    if (off <= kTolerance * std::abs(step)) continue;
    if (off > 4 * axis.rounding)
      refuse(i, "is off the even spacing of " + number_text(step) + " from the first to the last value");
    if (off > 0.05 * std::abs(step))
      refuse(i, "is stored with too few digits for a spacing of " + number_text(std::abs(step)));
  }
}

}  // namespace

std::optional<FileArray> file_array(const OpenRaster& raster, const DemBase& dem) {
  const std::string driver = multidimensional_driver(raster);
  const std::vector<std::string> files = own_files(dem.path);
  if (driver.empty() || files.empty()) return std::nullopt;
  const CPLErrorHandlerPusher quiet(CPLQuietErrorHandler);  // what arrays lack is not an error of the raster
  const GDALDatasetUniquePtr arrays = raster.guard->open_arrays(files.front(), driver);
  const Group root = arrays ? arrays->GetRootGroup() : nullptr;
  const Array array = root ? array_of(raster, dem, root) : nullptr;
  if (!array || array->GetDimensionCount() < 2 || array->GetDataType().GetClass() != GEDTC_NUMERIC)
    return std::nullopt;
  if (!has_size(*array, raster.size)) return std::nullopt;
  FileArray result = description(*array);
  const std::optional<bool> reversed = RowComparison(raster, *array, dem.band).reversed(dem.path);
  result.rows_reversed = reversed.value_or(false);  // of a symmetric array both orders are right
  return result;
}

std::optional<std::array<double, 6>> axes_transform(const FileArray& array, const DemBase& dem) {
  FileAxis columns = array.columns;
  FileAxis rows = array.rows;
  if (columns.values.size() < 2 || rows.values.size() < 2) return std::nullopt;
  require_even(columns, dem);
  require_even(rows, dem);
  if (array.rows_reversed) std::ranges::reverse(rows.values);
  const double column_step = step_of_axis(columns);
  const double row_step = step_of_axis(rows);
  const double column_edge = columns.values.front() - column_step / 2;
  const double row_edge = rows.values.front() - row_step / 2;
  const bool transposed = columns.is_northing || rows.is_easting;
  if (transposed && (columns.is_easting || rows.is_northing))
    throw FormatError(dem.path + ": the dimensions '" + rows.name + "' and '" + columns.name +
                      "' both run along the same axis by their attributes; export it again");
  if (transposed) return std::array<double, 6>{row_edge, 0, row_step, column_edge, column_step, 0};
  return std::array<double, 6>{column_edge, column_step, 0, row_edge, 0, row_step};
}

}  // namespace landfall
