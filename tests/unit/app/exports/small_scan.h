// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <string>
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
    LandfallFileWriter file({path, true, 1}, "scan", {.tool = "scan-sim", .config = {{"a", 1}}});
    std::vector<ColumnSpec> specs;
    std::vector<ColumnRows> rows;
    const auto add = [&](const char* name, h5::Type type, const auto& values) {
      specs.push_back({name, type, type == h5::Type::float64 ? "m" : "1", name});
      rows.emplace_back(std::span(values));
    };
    for (const std::string of : {"_est", "_true"}) {
      add(("x" + of).c_str(), h5::Type::float64, of == "_est" ? x : x_true);
      add(("y" + of).c_str(), h5::Type::float64, y);
      add(("z" + of).c_str(), h5::Type::float64, z);
    }
    add("pulse", h5::Type::int32, pulse);
    add("status", h5::Type::int8, status);
    write_table(file.root(), "points", specs, rows, 1);
    const std::array<ColumnRows, 1> times = {std::span(t)};
    write_table(file.root(), "pulses", {{"t", h5::Type::float64, "s", "time"}}, times, 1);
    file.commit();
  }
};

}  // namespace landfall
