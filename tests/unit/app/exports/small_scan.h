// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <vector>

#include "store/files/landfall_file.h"
#include "store/hdf5/table.h"

namespace landfall {

/// A scan of three pulses: five rows, of which the second is a miss and the fourth a false return. x_est
/// grows by 0.5 per row, y_est and z_est are -x_est and 2 x_est, and the truth is 100 m away.
struct SmallScan {
  std::vector<double> x = {1, std::numeric_limits<double>::quiet_NaN(), 2, 2.5, 3};
  std::vector<std::int32_t> pulse = {0, 0, 1, 1, 2};
  std::vector<std::int8_t> status = {0, 1, 0, 6, 0};
  std::vector<double> t = {0, 0.25, 0.5};

  void write(const std::filesystem::path& path) const {
    const auto scaled = [this](double factor, double shift) {
      std::vector<double> values;
      for (const double value : x) values.push_back(factor * value + shift);
      return values;
    };
    const std::vector<double> y = scaled(-1, 0);
    const std::vector<double> z = scaled(2, 0);
    const std::vector<double> x_true = scaled(1, 100);
    using Real = std::span<const double>;
    LandfallFileWriter file({path, true, 1}, "scan", {.tool = "scan-sim", .config = {{"a", 1}}});
    const auto real = [](const char* name) { return ColumnSpec{name, h5::Type::float64, "m", "place"}; };
    const std::array<ColumnRows, 8> rows = {Real(x),
                                            Real(y),
                                            Real(z),
                                            Real(x_true),
                                            Real(y),
                                            Real(z),
                                            std::span<const std::int32_t>(pulse),
                                            std::span<const std::int8_t>(status)};
    write_table(file.root(), "points",
                {real("x_est"),
                 real("y_est"),
                 real("z_est"),
                 real("x_true"),
                 real("y_true"),
                 real("z_true"),
                 {"pulse", h5::Type::int32, "1", "pulse"},
                 {"status", h5::Type::int8, "1", "status"}},
                rows, 1);
    const std::array<ColumnRows, 1> times = {Real(t)};
    write_table(file.root(), "pulses", {{"t", h5::Type::float64, "s", "time"}}, times, 1);
    file.commit();
  }
};

}  // namespace landfall
