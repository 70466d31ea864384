// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
  classification
};
inline constexpr std::size_t kCloudFieldCount = 10;

/// The name of a field, as --columns and /points have it.
[[nodiscard]] const char* name_of(CloudField field);
[[nodiscard]] std::optional<CloudField> cloud_field(std::string_view name);

/// The position of each field among the columns of a file; nothing where the file has none.
using CloudColumns = std::array<std::optional<std::size_t>, kCloudFieldCount>;

/// The choice of --columns: a field, and the name or the number (from 1) of its column in the file.
using ColumnChoice = std::vector<std::pair<CloudField, std::string>>;

/// Parses "x=E,y=N,z=3". Throws UsageError for a text that is not such a list, an unknown field or one that
/// is given twice.
[[nodiscard]] ColumnChoice column_choice(const std::string& text);

/// The columns of a file with these column names. A field that is not chosen has the column with one of its
/// usual names ("E", "easting", "x_est_m" for x), compared without case, blanks, underscores, units and
/// CloudCompare's "scalar_"; x and y may also be longitude and latitude.
///
/// Throws UsageError for a chosen column that does not exist, FormatError, naming what there is and what to
/// do, for a field that two columns could be, and without x, y or z. `file` begins the messages.
[[nodiscard]] CloudColumns cloud_columns(const std::vector<std::string>& names, const ColumnChoice& choice,
                                         const std::string& file);

/// cloud_columns() of a file whose columns have numbers only: x, y, z are the first three, unless chosen.
[[nodiscard]] CloudColumns numbered_columns(std::size_t count, const ColumnChoice& choice,
                                            const std::string& file);

/// True for names of columns among which x, y and z are found.
[[nodiscard]] bool names_a_cloud(const std::vector<std::string>& names, const ColumnChoice& choice);

}  // namespace landfall
