// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "store/config/scan_config.h"
#include "store/config/schema.h"

namespace landfall {

/// The resolved and complete configuration c.json, which has these `changes`.
inline nlohmann::json completed_scan(const nlohmann::json& changes) {
  return completed_scan_config(resolve_config({"c.json", changes}, embedded_schema("scan")));
}

/// The model of the configuration c.json of that text. Without a loader it is only checked.
inline ScanModel typed_scan(const std::string& text, const TableLoader& load_table = {}) {
  return scan_model(completed_scan(nlohmann::json::parse(text)), "c.json", load_table);
}

/// Loads poses at (1, 3, 4) m and, after 5 s, (2, 3, 4) m from b.csv, where a.csv is wanted for `role`.
inline TableLoader two_poses(const std::string& role) {
  return [role](const std::string& path, const std::string& wanted, const TableColumns&) {
    EXPECT_EQ(path + " as " + wanted, "a.csv as " + role);
    const std::vector<double> one{1, 1};
    const std::vector<double> zero{0, 0};
    return NumberTable("b.csv", {{"t_s", {0, 5}},
                                 {"x_m", {1, 2}},
                                 {"y_m", {3, 3}},
                                 {"z_m", {4, 4}},
                                 {"qw", one},
                                 {"qx", zero},
                                 {"qy", zero},
                                 {"qz", zero}});
  };
}

}  // namespace landfall
