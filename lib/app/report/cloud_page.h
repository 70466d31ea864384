// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "app/report/page_parts.h"

namespace landfall::html_report {

/// Points of a scan, row by row: values of columns by their name in the file (kPointColumns), and `t`, the
/// time since the first pulse or point. x_est, y_est and z_est are always there. NaN: no value.
struct CloudContent {
  std::map<std::string, std::vector<double>> columns;
  std::uint64_t all_count = 0;  ///< returns of the scan
  double cell_m = 0;            ///< the squares of which each keeps one point; 0: no point is left out
  bool has_pulses = false;      ///< `t` counts from the first pulse; false: from the earliest point

  [[nodiscard]] std::size_t size() const { return columns.at("z_est").size(); }
};

/// Numbers as 32-bit codes: value = offset + code * step, kNoWideCode is NaN.
struct WideCodes {
  double offset = 0;
  double step = 1;
  double low = 0;  ///< the least and the greatest finite value; both 0 without one
  double high = 0;
  std::vector<std::uint32_t> codes;
};
inline constexpr std::uint32_t kNoWideCode = 0xffffffff;

/// The step is the least of 1, 2 or 5 times a power of ten of which `steps` span the middle 99 % of the
/// values, so that a few outliers do not coarsen the others, or the least with which 32 bits reach all of
/// them; whole numbers have steps of 1 where 32 bits reach them.
[[nodiscard]] WideCodes wide_codes(std::span<const double> values, int steps);

/// The data of the page: the columns of a cloud, and the errors that follow from them.
[[nodiscard]] ReportData cloud_data(const CloudContent& content);

/// A page that shows points of a scan: one self-contained HTML file, which needs no other files and no
/// network. Equal contents give equal bytes. `steps`: the scan's chain of provenance, itself last
/// (LandfallFileReader::chain).
[[nodiscard]] std::string cloud_page(const CloudContent& content, const nlohmann::json& steps);

}  // namespace landfall::html_report
