// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <vector>

#include "base/returns/point_status.h"

// The tables /points, /pulses and /echoes of a scan. A new column needs only a member and its line in the
// declaration below: simulation resizes and packs it, files write it, exports and landfall-info show it.

namespace landfall {

/// Whether the errors of a lidar, except false returns, change a column of /points.
enum class ErrorEffect { changed, unchanged };

/// The scans that have a column.
enum class ColumnGroup {
  always,
  intensity,      ///< with a receiver
  return_number,  ///< with several returns for each pixel
  echo,           ///< with the echoes of all pixels kept, to redraw the errors of the receiver
};

struct OptionalColumns {
  bool intensity = false;
  bool return_number = false;
  bool echo = false;
  bool later_echoes = false;  ///< the table EchoColumns

  [[nodiscard]] constexpr bool has(ColumnGroup group) const {
    return group == ColumnGroup::always || (group == ColumnGroup::intensity && intensity) ||
           (group == ColumnGroup::return_number && return_number) || (group == ColumnGroup::echo && echo);
  }
  friend bool operator==(const OptionalColumns&, const OptionalColumns&) = default;
};

/// One column: its name, unit and long name in the scan file, and the member that holds it. Its stored type
/// is that of the values; doubles of /points become float32 with --float32.
template <class Table, class T>
struct Column {
  using Value = T;

  constexpr Column(const char* column_name, std::vector<T> Table::*member, const char* unit,
                   const char* meaning, ErrorEffect error_effect = ErrorEffect::changed,
                   ColumnGroup of_group = ColumnGroup::always)
      : name(column_name),
        rows(member),
        units(unit),
        long_name(meaning),
        effect(error_effect),
        group(of_group) {}

  const char* name;
  std::vector<T> Table::*rows;
  const char* units;
  const char* long_name;
  ErrorEffect effect;
  ColumnGroup group;
};

/// Calls visit(column) for each column of a declaration, in order.
template <class Columns, class Visit>
constexpr void for_each_column(const Columns& columns, const Visit& visit) {
  std::apply([&](const auto&... column) { (visit(column), ...); }, columns);
}

/// One row per pixel and pulse, or per return, ordered by pulse, then pixel, then return. Positions in D and
/// ranges in metres; values that the status leaves undefined are NaN:
/// - a return has all values;
/// - a false return has all values, except that range_true is NaN where nothing was hit; its true point then
/// lies on the true beam at the false range;
/// - a dropout, and a dead pixel whose ray hit the terrain, have range_true and the true point;
/// - an undetected pixel the same, and its echo;
/// - all others have no values.
/// A column that is not requested, or of which the scan has none, is empty.
struct PointColumns {
  std::vector<double> x_est, y_est, z_est;     ///< Eq. 7, from the measured range and the estimated pose
  std::vector<double> x_true, y_true, z_true;  ///< Eq. 1, from the true range and the true pose
  std::vector<double> range_true, range_measured;
  std::vector<std::int32_t> pulse;
  std::vector<std::int32_t> pixel;  ///< row * columns + column
  std::vector<PointStatus> status;
  std::vector<float> intensity;            ///< photoelectrons of a return; NaN without
  std::vector<std::int8_t> return_number;  ///< 1 for a pixel's first return, 0 where it has none
  std::vector<double> echo_signal, echo_peak, echo_edge, echo_width, echo_range;  ///< Echo's members

  [[nodiscard]] std::size_t size() const { return status.size(); }
  [[nodiscard]] bool holds_truth() const { return !x_true.empty(); }
  [[nodiscard]] bool holds_echoes() const { return !echo_signal.empty(); }
  friend bool operator==(const PointColumns&, const PointColumns&) = default;
};

inline constexpr std::tuple kPointColumns = {
    Column{"x_est", &PointColumns::x_est, "m", "estimated x in the DEM frame"},
    Column{"y_est", &PointColumns::y_est, "m", "estimated y in the DEM frame"},
    Column{"z_est", &PointColumns::z_est, "m", "estimated z in the DEM frame"},
    Column{"x_true", &PointColumns::x_true, "m", "true x in the DEM frame", ErrorEffect::unchanged},
    Column{"y_true", &PointColumns::y_true, "m", "true y in the DEM frame", ErrorEffect::unchanged},
    Column{"z_true", &PointColumns::z_true, "m", "true z in the DEM frame", ErrorEffect::unchanged},
    Column{"range_true", &PointColumns::range_true, "m", "true range", ErrorEffect::unchanged},
    Column{"range_measured", &PointColumns::range_measured, "m", "measured range"},
    Column{"pulse", &PointColumns::pulse, "1", "row in /pulses", ErrorEffect::unchanged},
    Column{"pixel", &PointColumns::pixel, "1", "row * columns + column on the detector",
           ErrorEffect::unchanged},
    Column{"status", &PointColumns::status, "1", "what became of the pixel at this pulse"},
    Column{"intensity", &PointColumns::intensity, "1", "detected photoelectrons", ErrorEffect::changed,
           ColumnGroup::intensity},
    Column{"return_number", &PointColumns::return_number, "1",
           "number of the return, 1 for a pixel's first, 0 without", ErrorEffect::changed,
           ColumnGroup::return_number},
    Column{"echo_signal", &PointColumns::echo_signal, "1", "mean photoelectrons of the echo",
           ErrorEffect::unchanged, ColumnGroup::echo},
    Column{"echo_peak", &PointColumns::echo_peak, "1",
           "maximum of the echo's waveform over that of an unstretched one", ErrorEffect::unchanged,
           ColumnGroup::echo},
    Column{"echo_edge", &PointColumns::echo_edge, "m", "standard deviation of the echo's leading edge",
           ErrorEffect::unchanged, ColumnGroup::echo},
    Column{"echo_width", &PointColumns::echo_width, "m", "standard deviation of the echo's waveform",
           ErrorEffect::unchanged, ColumnGroup::echo},
    Column{"echo_range", &PointColumns::echo_range, "m", "range of the echo's timing point",
           ErrorEffect::unchanged, ColumnGroup::echo}};

/// One row per echo behind a pixel's first one, ordered by pulse, pixel, number; the members of Echo.
struct EchoColumns {
  std::vector<std::int32_t> pulse;
  std::vector<std::int32_t> pixel;
  std::vector<std::int32_t> number;
  std::vector<double> signal, peak, edge, width, range;

  [[nodiscard]] std::size_t size() const { return pulse.size(); }
  friend bool operator==(const EchoColumns&, const EchoColumns&) = default;
};

inline constexpr const char* kEchoGroup = "echoes";
inline constexpr std::tuple kEchoColumns = {
    Column{"pulse", &EchoColumns::pulse, "1", "row in /pulses"},
    Column{"pixel", &EchoColumns::pixel, "1", "row * columns + column on the detector"},
    Column{"number", &EchoColumns::number, "1", "number of the pixel's echo, 1 for the second"},
    Column{"signal", &EchoColumns::signal, "1", "mean photoelectrons of the echo"},
    Column{"peak", &EchoColumns::peak, "1", "maximum of the echo's waveform over that of an unstretched one"},
    Column{"edge", &EchoColumns::edge, "m", "standard deviation of the echo's leading edge"},
    Column{"width", &EchoColumns::width, "m", "standard deviation of the echo's waveform"},
    Column{"range", &EchoColumns::range, "m", "range of the echo's timing point"}};

/// The estimated position of a return, then its true position: x, y, z each. Finite in every return.
inline constexpr std::array kCoordinates = {&PointColumns::x_est,  &PointColumns::y_est,
                                            &PointColumns::z_est,  &PointColumns::x_true,
                                            &PointColumns::y_true, &PointColumns::z_true};

/// One row per pulse: t in seconds, the scanner's two angles in radians, and the pose of the body in D:
/// position in metres, quaternion D <- B scalar first, its scalar >= 0.
struct PulseColumns {
  std::vector<double> t;
  std::vector<double> angle_1, angle_2;
  std::vector<double> px_true, py_true, pz_true, qw_true, qx_true, qy_true, qz_true;
  std::vector<double> px_est, py_est, pz_est, qw_est, qx_est, qy_est, qz_est;
  std::vector<std::int32_t> point_count;  ///< rows of this pulse in the points
  std::vector<std::int64_t> point_begin;  ///< filled by the file's writer, which knows the rows before

  [[nodiscard]] std::size_t size() const { return point_count.size(); }
  friend bool operator==(const PulseColumns&, const PulseColumns&) = default;
};

inline constexpr std::tuple kPulseColumns = {
    Column{"t", &PulseColumns::t, "s", "time of the pulse"},
    Column{"angle_1", &PulseColumns::angle_1, "rad", "scanner angle 1"},
    Column{"angle_2", &PulseColumns::angle_2, "rad", "scanner angle 2"},
    Column{"px_true", &PulseColumns::px_true, "m", "true body position x"},
    Column{"py_true", &PulseColumns::py_true, "m", "true body position y"},
    Column{"pz_true", &PulseColumns::pz_true, "m", "true body position z"},
    Column{"qw_true", &PulseColumns::qw_true, "1", "true attitude, quaternion DEM <- body, scalar"},
    Column{"qx_true", &PulseColumns::qx_true, "1", "true attitude, quaternion DEM <- body, x"},
    Column{"qy_true", &PulseColumns::qy_true, "1", "true attitude, quaternion DEM <- body, y"},
    Column{"qz_true", &PulseColumns::qz_true, "1", "true attitude, quaternion DEM <- body, z"},
    Column{"px_est", &PulseColumns::px_est, "m", "estimated body position x"},
    Column{"py_est", &PulseColumns::py_est, "m", "estimated body position y"},
    Column{"pz_est", &PulseColumns::pz_est, "m", "estimated body position z"},
    Column{"qw_est", &PulseColumns::qw_est, "1", "estimated attitude, quaternion DEM <- body, scalar"},
    Column{"qx_est", &PulseColumns::qx_est, "1", "estimated attitude, quaternion DEM <- body, x"},
    Column{"qy_est", &PulseColumns::qy_est, "1", "estimated attitude, quaternion DEM <- body, y"},
    Column{"qz_est", &PulseColumns::qz_est, "1", "estimated attitude, quaternion DEM <- body, z"},
    Column{"point_count", &PulseColumns::point_count, "1", "rows of the pulse in /points"},
    Column{"point_begin", &PulseColumns::point_begin, "1", "first row of the pulse in /points"}};

/// The name of the column that a member holds: name_of(&PointColumns::status).
template <class Table, class T>
[[nodiscard]] constexpr const char* name_of(std::vector<T> Table::*member) {
  const char* name = nullptr;
  const auto compare = [&](const auto& column) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(column)>::Value, T>)
      if (column.rows == member) name = column.name;
  };
  if constexpr (std::is_same_v<Table, PointColumns>) {
    for_each_column(kPointColumns, compare);
  } else if constexpr (std::is_same_v<Table, EchoColumns>) {
    for_each_column(kEchoColumns, compare);
  } else {
    for_each_column(kPulseColumns, compare);
  }
  return name;
}

// Fails if a member has no line in its declaration.
static_assert(sizeof(PointColumns) == std::tuple_size_v<decltype(kPointColumns)> * sizeof(std::vector<int>));
static_assert(sizeof(EchoColumns) == std::tuple_size_v<decltype(kEchoColumns)> * sizeof(std::vector<int>));
static_assert(sizeof(PulseColumns) == std::tuple_size_v<decltype(kPulseColumns)> * sizeof(std::vector<int>));

}  // namespace landfall
