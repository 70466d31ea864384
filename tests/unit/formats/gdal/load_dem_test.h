// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "chain/terrain/terrain_model.h"
#include "gdal_rasters.h"

namespace landfall {

/// Tests that load rasters from a folder of their own.
class LoadDem : public ::testing::Test {
 protected:
  LoadDem() {
    folder_ =
        std::filesystem::path(::testing::TempDir()) /
        ("landfall_dem_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
         "_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~LoadDem() override { std::filesystem::remove_all(folder_); }

  /// A bilinear DemBase of the written raster, its own zero kept.
  DemBase written(const TestRaster& raster) {
    DemBase dem;
    dem.path = (folder_ / "raster.tif").string();
    dem.interpolation = Interpolation::bilinear;
    dem.datum = Datum::none;
    write_geotiff(dem.path, raster);
    return dem;
  }

  std::filesystem::path folder_;
};

}  // namespace landfall
