// SPDX-License-Identifier: GPL-3.0-or-later
// Units, types and detectable damage of rasters: what would otherwise be loaded as wrong elevations.
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "formats/gdal/gdal_loader.h"
#include "gdal_rasters.h"
#include "load_dem_test.h"
#include "refusal.h"

namespace landfall {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A level raster of 100 units in a CRS; its elevation as it is loaded.
class VerticalUnit : public LoadDem {
 protected:
  DemBase of(const std::string& unit, const std::string& crs = "EPSG:32631") {
    TestRaster raster{4, 4, [](int, int) { return 100; }, "Float64", {{0, 1, 0, 0, 0, -1}}, crs, {}, 1,
                      0, {}};
    raster.unit = unit;
    return written(raster);
  }
  static double loaded(const DemBase& dem) { return load_dem(dem, kSite).samples.values[0]; }
  static std::string refusal(const DemBase& dem) {
    return landfall::refusal<FormatError>([&] { return load_dem(dem, kSite); });
  }
  inline static const GridSpec kSite = GridSpec::centered(1, 1);
  static constexpr const char* kFeetAboveSea = "EPSG:32631+6360";  ///< NAVD88 height (ftUS)
};

TEST_F(VerticalUnit, OfTheBandIsConverted) {
  EXPECT_EQ(loaded(of("")), 100);
  EXPECT_EQ(loaded(of("m")), 100);
  EXPECT_EQ(loaded(of("metres")), 100);
  EXPECT_DOUBLE_EQ(loaded(of("ft")), 30.48);
  EXPECT_DOUBLE_EQ(loaded(of("US survey foot")), 100 * 1200.0 / 3937);
  EXPECT_DOUBLE_EQ(loaded(of("km")), 100000);
  EXPECT_DOUBLE_EQ(loaded(of("cm")), 1);
}

TEST_F(VerticalUnit, OfACompoundCrsIsConverted) {
  EXPECT_DOUBLE_EQ(loaded(of("", kFeetAboveSea)), 100 * 1200.0 / 3937);
  EXPECT_DOUBLE_EQ(loaded(of("ftUS", kFeetAboveSea)), 100 * 1200.0 / 3937);
}

// netCDF keeps a band's unit and its sign in attributes of the variable.
class NetcdfRaster : public VerticalUnit {
 protected:
  DemBase netcdf(const TestRaster& raster) {
    GDALAllRegister();
    DemBase dem = written(raster);
    const auto source = GDALDatasetUniquePtr(GDALDataset::Open(dem.path.c_str()));
    if (!raster.unit.empty()) source->GetRasterBand(1)->SetMetadataItem("units", raster.unit.c_str());
    dem.path = (folder_ / "site.nc").string();
    GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("netCDF");
    const auto copy = GDALDatasetUniquePtr(
        driver->CreateCopy(dem.path.c_str(), source.get(), 0, nullptr, nullptr, nullptr));
    EXPECT_NE(copy, nullptr);
    return dem;
  }
};

TEST_F(NetcdfRaster, IsConvertedByItsUnit) {
  TestRaster raster{4, 4, [](int, int) { return 2; }, "Float64", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", {}, 1,
                    0, {}};
  for (const auto& [unit, metres] : {std::pair{"", 2.0}, {"m", 2.0}, {"km", 2000.0}, {"feet", 0.6096}}) {
    raster.unit = unit;
    EXPECT_DOUBLE_EQ(loaded(netcdf(raster)), metres) << unit;
  }
  raster.unit = "kelvin";
  EXPECT_THAT(refusal(netcdf(raster)), AllOf(HasSubstr("'kelvin'"), HasSubstr("vertical_scale")));
}

TEST_F(NetcdfRaster, OfSignedBytesIsReadAsSigned) {
  const auto value = [](int, int) { return 132; };
  EXPECT_EQ(loaded(netcdf({4, 4, value, "SignedByte", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", {}, 1, 0, {}})),
            -124);
  EXPECT_EQ(loaded(netcdf({4, 4, value, "Byte", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", {}, 1, 0, {}})), 132);
}

TEST_F(VerticalUnit, ThatIsInDoubtIsRefusedAndCanBeOverridden) {
  DemBase dem = of("m", kFeetAboveSea);
  EXPECT_THAT(refusal(dem),
              AllOf(HasSubstr("in units of 1 m, its CRS in units of 0.3048"), HasSubstr("vertical_scale")));
  dem.vertical_scale = 0.5;
  EXPECT_EQ(loaded(dem), 100);  // the terrain applies the factor
  EXPECT_THAT(refusal(of("degC")), AllOf(HasSubstr("'degC'"), HasSubstr("vertical_scale")));
}

TEST_F(LoadDem, ReadsSignedBytesAsSigned) {
  const auto value = [](int col, int row) { return row == 0 ? 132 : 100 + col; };  // 132 is -124
  DemBase dem = written({4, 4, value, "SignedByte", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", {}, 1, 0, {}});
  const DemRaster raster = load_dem(dem, GridSpec::centered(1, 1));
  EXPECT_EQ(raster.samples.at(0, 0), -124);
  EXPECT_EQ(raster.samples.at(1, 3), 103);
  dem = written({4, 4, value, "SignedByte", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", -124, 1, 0, {}});
  EXPECT_TRUE(std::isnan(load_dem(dem, GridSpec::centered(1, 1)).samples.at(0, 0)));
}

// GDAL converts what a VRT resamples straight to the type that is asked for: 125.75 where the band holds 126.
TEST_F(LoadDem, RoundsResampledBytesAsTheBandDoes) {
  const auto value = [](int col, int) { return 100 + 7 * col; };
  written({8, 8, value, "Byte", {{0, 1, 0, 0, 0, -1}}, "EPSG:32631", {}, 1, 0, {}});
  DemBase dem;
  dem.path = (folder_ / "half.vrt").string();
  dem.datum = Datum::none;
  std::ofstream(dem.path) << R"(<VRTDataset rasterXSize="5" rasterYSize="5"><SRS>EPSG:32631</SRS>
<GeoTransform>0,1.6,0,0,0,-1.6</GeoTransform><VRTRasterBand dataType="Byte" band="1">
<SimpleSource resampling="bilinear"><SourceFilename relativeToVRT="1">raster.tif</SourceFilename>
<SourceBand>1</SourceBand><SrcRect xOff="0" yOff="0" xSize="8" ySize="8"/>
<DstRect xOff="0" yOff="0" xSize="5" ySize="5"/></SimpleSource></VRTRasterBand></VRTDataset>)";
  const DemRaster raster = dem_loader(RasterLinks::followed)(dem, GridSpec::centered(1, 1));
  for (const double z : raster.samples.values) EXPECT_EQ(z, std::round(z));
}

/// An image beside the header of a raw raster of the same name.
class BesideARawHeader : public LoadDem {
 protected:
  /// 16 x 16 bytes of 100 + column in the format of a driver; landfall reads the files of some drivers only.
  DemBase image(const char* driver, const char* extension) {
    GDALAllRegister();
    const auto value = [](int col, int) { return 100 + col; };
    DemBase dem = written({16, 16, value, "Byte"});
    const auto source = GDALDatasetUniquePtr(GDALDataset::Open(dem.path.c_str()));
    dem.path = (folder_ / "site").string() + extension;
    const auto copy = GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName(driver)->CreateCopy(
        dem.path.c_str(), source.get(), 0, nullptr, nullptr, nullptr));
    EXPECT_NE(copy, nullptr);
    std::ofstream(folder_ / "site.hdr") << "nrows 4\nncols 4\nnbits 8\nbyteorder I\nlayout bil\n"
                                           "ulxmap 0\nulymap 3\nxdim 5\nydim 5\n";
    dem.horizontal_scale_m = 1;
    return dem;
  }
};

TEST_F(BesideARawHeader, AnAnymapIsRefused) {
  const DemBase dem = image("PNM", ".pgm");
  EXPECT_THAT(refusal<FormatError>([&] { return load_dem(dem, GridSpec::centered(1, 1)); }),
              HasSubstr("site.pgm: is a PNM file"));
}

TEST_F(BesideARawHeader, OtherImagesKeepTheirOwnValues) {
  for (const auto& [driver, extension] : {std::pair{"PNG", ".png"}, {"GTiff", ".tif"}, {"JPEG", ".jpg"}}) {
    const DemRaster raster = load_dem(image(driver, extension), GridSpec::centered(7, 1));
    const std::int64_t last = raster.samples.size.cols - 1;
    ASSERT_GE(last, 8) << driver;  // the header has 4 columns
    const double first = raster.samples.at(0, 0);
    EXPECT_NEAR(first, 100, 8) << driver;
    const double tolerance = driver == std::string_view("JPEG") ? 2 : 0;
    for (std::int64_t col = 0; col <= last; ++col)
      EXPECT_NEAR(raster.samples.at(last, col), first + static_cast<double>(col), tolerance) << driver;
  }
}

/// A little-endian TIFF of 4 x 4 bytes in one strip, with the sizes of its strips or without.
std::string small_tiff(bool with_sizes) {
  std::string bytes = std::string("II*\0\x08\0\0\0", 8);
  const auto put = [&](std::uint32_t value, int count) {
    for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i));
  };
  struct Tag {
    std::uint32_t id, type, value;
  };
  std::vector<Tag> tags = {{256, 3, 4}, {257, 3, 4}, {258, 3, 8}, {259, 3, 1}, {262, 3, 1},
                           {273, 4, 0}, {277, 3, 1}, {278, 3, 4}, {279, 4, 16}};
  if (!with_sizes) tags.pop_back();
  tags[5].value = static_cast<std::uint32_t>(8 + 2 + 12 * tags.size() + 4);
  put(static_cast<std::uint32_t>(tags.size()), 2);
  for (const Tag& tag : tags) {
    put(tag.id, 2);
    put(tag.type, 2);
    put(1, 4);
    put(tag.value, 4);
  }
  put(0, 4);
  return bytes + std::string(16, '\x07');
}

TEST_F(LoadDem, RefusesATiffWithoutTheSizesOfItsStrips) {
  DemBase dem;
  dem.path = (folder_ / "strips.tif").string();
  dem.horizontal_scale_m = 1;
  dem.datum = Datum::none;
  std::ofstream(dem.path) << small_tiff(true);
  EXPECT_EQ(load_dem(dem, GridSpec::centered(1, 1)).samples.values[0], 7);
  std::ofstream(dem.path) << small_tiff(false);
  EXPECT_THROW((void)load_dem(dem, GridSpec::centered(1, 1)), FormatError);
}

// One bit of a column of a DTED cell: without the check it becomes a peak.
TEST_F(LoadDem, RefusesADtedCellWithAWrongChecksum) {
  GDALRegister_DTED();
  const std::string path = (folder_ / "n00.dt0").string();
  {
    const DemBase plane = written({121,
                                   121,
                                   [](int col, int row) { return col + row; },
                                   "Int16",
                                   {{-1.0 / 240, 1.0 / 120, 0, 1 + 1.0 / 240, 0, -1.0 / 120}},
                                   "EPSG:4326",
                                   {},
                                   1,
                                   0,
                                   {}});
    GDALAllRegister();
    const auto source = GDALDatasetUniquePtr(GDALDataset::Open(plane.path.c_str()));
    GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("DTED");
    ASSERT_NE(
        GDALDatasetUniquePtr(driver->CreateCopy(path.c_str(), source.get(), 0, nullptr, nullptr, nullptr)),
        nullptr);
  }
  DemBase dem;
  dem.path = path;
  dem.datum = Datum::none;
  const GridSpec site = GridSpec::centered(2000, 1000);
  EXPECT_NO_THROW((void)load_dem(dem, site));
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(3428 + 60 * 254 + 8 + 2 * 60);
  file.put('\x10');
  file.close();
  EXPECT_THROW((void)load_dem(dem, site), FormatError);
}

// libjpeg fills what is missing with grey and only warns. The warning counts even where GDAL is told not to
// make an error of it.
TEST_F(LoadDem, RefusesATruncatedJpeg) {
  GDALAllRegister();
  const auto value = [](int col, int row) { return 40 + (col * row) % 80; };
  DemBase dem = written({256, 256, value, "Byte"});
  const auto source = GDALDatasetUniquePtr(GDALDataset::Open(dem.path.c_str()));
  dem.path = (folder_ / "site.jpg").string();
  ASSERT_NE(GDALDatasetUniquePtr(GetGDALDriverManager()->GetDriverByName("JPEG")->CreateCopy(
                dem.path.c_str(), source.get(), 0, nullptr, nullptr, nullptr)),
            nullptr);
  dem.horizontal_scale_m = 1;
  const GridSpec site = GridSpec::centered(120, 1);
  EXPECT_NO_THROW((void)load_dem(dem, site));
  std::filesystem::resize_file(dem.path, std::filesystem::file_size(dem.path) / 2);
  EXPECT_THROW((void)load_dem(dem, site), FormatError);
  CPLSetThreadLocalConfigOption("GDAL_ERROR_ON_LIBJPEG_WARNING", "NO");
  EXPECT_THROW((void)load_dem(dem, site), FormatError);
  CPLSetThreadLocalConfigOption("GDAL_ERROR_ON_LIBJPEG_WARNING", nullptr);
}

}  // namespace
}  // namespace landfall
