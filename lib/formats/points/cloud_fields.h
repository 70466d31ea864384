// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/points/column_name.h"

namespace landfall {

/// The values of a point.
enum class CloudField : std::size_t {
  x,
  y,
  z,
  intensity,
  return_number,
  number_of_returns,
  t,
  pulse,
  pixel,
  classification,
  echo_width
};
inline constexpr std::size_t kCloudFieldCount = 11;
inline constexpr auto kTimeField = static_cast<std::size_t>(CloudField::t);

/// The name of a field, as --columns and /points have it.
[[nodiscard]] const char* name_of(CloudField field);

/// The position of each field among the columns of a file; nothing where the file has none.
using CloudColumns = std::array<std::optional<std::size_t>, kCloudFieldCount>;

/// The unit of each field; only x, y, z and t have one.
using CloudUnits = std::array<ColumnUnit, kCloudFieldCount>;

/// The choice of --columns: a field, and the name or the number (from 1) of its column in the file; "-"
/// leaves the field out.
using ColumnChoice = std::vector<std::pair<CloudField, std::string>>;

/// Parses "x=E,y=N,z=3,t=-". Throws UsageError for a text that is not such a list, an unknown field, one that
/// is given twice, and for x, y or z that is left out.
[[nodiscard]] ColumnChoice column_choice(const std::string& text);

[[nodiscard]] bool is_chosen(const ColumnChoice& choice, CloudField field);

/// The columns of a file that are fields of its points.
struct CloudTable {
  CloudColumns columns;
  CloudUnits units{};
  std::vector<std::string> notes{};  ///< assumptions; sentences without the file's name
};

/// The columns of a file with these column names. A field that is not chosen has the column with one of its
/// usual names ("E", "easting", "x_est_m" for x), compared without case, blanks, underscores, units and
/// CloudCompare's "scalar_"; x and y may also be longitude and latitude.
///
/// Throws UsageError for a chosen column that does not exist; FormatError, naming what there is and what to
/// do, for a field that two columns could be, without x, y or z, for a unit in brackets that is not known or
/// not one of the field, unless its column is chosen (then the unit is assumed, with a note), and where only
/// one of x and y is in degrees or states a unit other than the metre.
[[nodiscard]] CloudTable cloud_columns(const std::vector<std::string>& names, const ColumnChoice& choice,
                                       const std::string& file);

/// cloud_columns() of a file without names: x, y, z are the first three columns for which `is_number`, unless
/// chosen.
[[nodiscard]] CloudTable numbered_columns(const std::vector<bool>& is_number, const ColumnChoice& choice,
                                          const std::string& file);

/// True for names of columns among which x, y and z are found.
[[nodiscard]] bool names_a_cloud(const std::vector<std::string>& names, const ColumnChoice& choice);

/// True for names of columns of which one is a usual name of a field.
[[nodiscard]] bool names_a_field(const std::vector<std::string>& names);

}  // namespace landfall
