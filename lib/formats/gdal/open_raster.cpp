// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D434
#include "formats/gdal/open_raster.h"

#include <cpl_string.h>
#include <cpl_vsi.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/core/error.h"
#include "base/text/file_path.h"
#include "chain/terrain/mesh/mesh_name.h"
#include "formats/gdal/classic_netcdf.h"
#include "formats/gdal/known_crs.h"
#include "formats/gdal/point_crs.h"
#include "formats/gdal/raster_files.h"
#include "formats/gdal/registry.h"

namespace landfall {
namespace {

constexpr std::int64_t kBlockBytesLimit = std::int64_t{256} << 20U;

/// Lists the rasters in the file: naming a container of several rasters is a common mistake.
std::string subdataset_hint(GDALDataset& dataset) {
  const char* const first = CSLFetchNameValue(dataset.GetMetadata("SUBDATASETS"), "SUBDATASET_1_NAME");
  return first != nullptr ? std::string("; it holds several rasters, name one, such as ") + first : "";
}

struct Magic {
  std::string bytes;
  const char* format;
};

/// "P5\n12 " or "P2 # made by": a portable anymap, whose text header a raw raster is unlikely to begin with.
bool is_pnm(std::span<const char> head) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; };
  if (head[0] != 'P' || head[1] < '1' || head[1] > '7' || !is_blank(head[2])) return false;
  return head[3] == '#' || (head[3] >= '0' && head[3] <= '9');
}

/// The format that the first bytes of a file indicate; empty if they indicate none.
std::string promised_format(const std::string& path) {
  static const Magic kMagics[] = {{"CDF", "netCDF"},
                                  {"\x89HDF", "HDF5"},
                                  {std::string("II*\0", 4), "TIFF"},
                                  {std::string("MM\0*", 4), "TIFF"},
                                  {"\x89PNG", "PNG"},
                                  {"\xff\xd8\xff", "JPEG"}};
  std::array<char, 8> head{};
  VSILFILE* const file = VSIFOpenL(path.c_str(), "rb");
  if (file == nullptr) return "";
  VSIFReadL(head.data(), 1, head.size(), file);
  VSIFCloseL(file);
  for (const Magic& magic : kMagics)
    if (std::memcmp(head.data(), magic.bytes.data(), magic.bytes.size()) == 0) return magic.format;
  return is_pnm(head) ? "PNM" : "";
}

[[noreturn]] void refuse_unopened(const DemBase& dem, const GdalErrors& errors) {
  if (dem.path.find(':') == std::string::npos && !std::filesystem::exists(status_of(dem.path)))
    throw FormatError(dem.path + ": no such file");
  const std::string reason = errors.reason();
  if (reason.find("not recognized as a supported file format") == std::string::npos)
    throw FormatError(dem.path + ": GDAL cannot open it (" + reason + "); get or export it again");
  if (is_mesh_name(dem.path))
    throw FormatError(
        dem.path + R"(: is a mesh by its extension; configure it as "mesh": {"path": ..}, not as a raster)");
  if (const std::string unread = unread_format(dem.path); !unread.empty())
    throw FormatError(
        dem.path + ": is in the format " + unread +
        ", which terrain-gen does not read; convert it, for example with gdal_translate FILE out.tif");
  const std::string format = promised_format(dem.path);
  if (!format.empty())
    throw FormatError(dem.path + ": begins as a " + format +
                      " file does but cannot be opened: it is truncated or damaged; get or export it again");
  throw FormatError(
      dem.path +
      ": is not in a supported raster format; a raw file without a header needs a .vrt that gives its "
      "size, type and byte order (VRTRawRasterBand); convert other formats with gdal_translate");
}

/// Refuses pipes and devices. Rasters may be folders.
void require_no_stream(const std::string& file) {
  if (!std::filesystem::is_directory(status_of(file))) require_regular_file(file);
}

std::int64_t block_bytes(const OpenRaster& raster) {
  int cols = 0;
  int rows = 0;
  raster.band->GetBlockSize(&cols, &rows);
  const std::int64_t sample_bytes = GDALGetDataTypeSizeBytes(raster.band->GetRasterDataType());
  const char* const interleave = raster.dataset->GetMetadataItem("INTERLEAVE", "IMAGE_STRUCTURE");
  const bool together = interleave != nullptr && std::strcmp(interleave, "PIXEL") == 0;
  // Uses double because products of two 32-bit numbers and a few bands could overflow an integer.
  const double bytes = static_cast<double>(cols) * rows * static_cast<double>(sample_bytes) *
                       (together ? raster.dataset->GetRasterCount() : 1);
  return bytes < 0x1p62 ? static_cast<std::int64_t>(bytes) : std::int64_t{1} << 62U;
}

/// A DTED cell stores whole columns, so its length gives their number; GDAL takes missing columns for
/// holes. A cell that is marked complete must hold all of them.
void require_whole_dted(const OpenRaster& raster, const DemBase& dem) {
  const char* const partial = raster.dataset->GetMetadataItem("DTED_PartialCellIndicator");
  if (partial == nullptr || std::strcmp(partial, "00") != 0) return;
  constexpr std::int64_t kHeaderBytes = 3428;
  const std::int64_t column_bytes = 12 + 2 * raster.size.rows;
  VSIStatBufL status{};
  if (VSIStatL(dem.path.c_str(), &status) != 0) return;
  const std::int64_t columns = (static_cast<std::int64_t>(status.st_size) - kHeaderBytes) / column_bytes;
  if (columns < raster.size.cols)
    throw FormatError(dem.path + ": holds " + std::to_string(columns) + " of the " +
                      std::to_string(raster.size.cols) +
                      " columns of a complete DTED cell: it is truncated; get or export it again");
}

/// The header of a USGS DEM gives its corners, from which its columns follow; GDAL reads fewer if they are
/// not there.
void require_whole_usgs_dem(const OpenRaster& raster, const DemBase& dem) {
  if (std::string_view(GDALGetDriverShortName(raster.dataset->GetDriver())) != "USGSDEM") return;
  constexpr std::size_t kCorners = 546;
  constexpr std::size_t kSpacing = 816;
  constexpr std::size_t kDigits = 24;
  std::array<char, 1024> head{};
  VSILFILE* const file = VSIFOpenL(dem.path.c_str(), "rb");
  if (file == nullptr) return;
  VSIFReadL(head.data(), 1, head.size(), file);
  VSIFCloseL(file);
  const auto number = [&](std::size_t begin, std::size_t size) {
    std::string text(head.data() + begin, size);
    std::ranges::replace(text, 'D', 'e');
    return CPLAtof(text.c_str());
  };
  const auto corner_x = [&](std::size_t corner) { return number(kCorners + 2 * kDigits * corner, kDigits); };
  const double west = std::min(corner_x(0), corner_x(1));
  const double east = std::max(corner_x(2), corner_x(3));
  const double columns = std::round((east - west) / number(kSpacing, 12)) + 1;
  if (static_cast<double>(raster.size.cols) < columns / 2 && columns < 1e6)  // corners are not exact
    throw FormatError(
        dem.path + ": holds " + std::to_string(raster.size.cols) + " of about " +
        std::to_string(static_cast<std::int64_t>(columns)) +
        " columns between the corners of a USGS DEM: it is truncated or damaged; get or export it again");
}

/// A header next to an image of another format (FILE.hdr next to FILE.pgm) makes the drivers of raw rasters
/// read the image's own header and samples as elevations.
void require_own_data(const OpenRaster& raster, const DemBase& dem) {
  constexpr std::array<std::string_view, 6> kRawDrivers = {"EHdr", "ENVI", "ERS", "RST", "SAGA", "PDS"};
  const std::string_view driver = GDALGetDriverShortName(raster.dataset->GetDriver());
  if (std::ranges::find(kRawDrivers, driver) == kRawDrivers.end()) return;
  const std::string format = promised_format(dem.path);
  if (!format.empty())
    throw FormatError(dem.path + ": is a " + format + " file, which a header of a raw raster next to it (" +
                      std::string(driver) +
                      ") describes otherwise; rename one of them, or gdal_translate it");
}

/// The samples of a picture, and elevations that are coded in several colours, are not elevations.
void require_no_colour(GDALRasterBand& band, const DemBase& dem) {
  const GDALColorInterp colour = band.GetColorInterpretation();
  if (dem.takes_colours || colour == GCI_Undefined || colour == GCI_GrayIndex) return;
  const std::string number = std::to_string(dem.band);
  throw FormatError(dem.path + ": band " + number + " is a colour (" +
                        GDALGetColorInterpretationName(colour) +
                        "), not an elevation; give the band of the elevations, or band " + number +
                        " to take its samples as they are",
                    "band");
}

void require_usable(const OpenRaster& raster, const DemBase& dem) {
  const auto [rows, cols] = raster.size;
  require_whole_usgs_dem(raster, dem);
  require_no_colour(*raster.band, dem);
  if (rows < 2 || cols < 2)
    throw FormatError(dem.path + ": " + std::to_string(cols) + " x " + std::to_string(rows) +
                      " pixels are fewer than 2 x 2, which a surface needs; is it a cut or truncated file?");
  if (GDALDataTypeIsComplex(raster.band->GetRasterDataType()) != 0)
    throw FormatError(
        dem.path + ": band " + std::to_string(dem.band) +
        " holds complex numbers, not elevations; gdal_translate -ot Float32 keeps their real part");
  if (const std::int64_t bytes = block_bytes(raster); bytes > kBlockBytesLimit)
    throw FormatError(dem.path + ": is stored in blocks of " + std::to_string(bytes >> 20U) +
                      " MiB, more than 256; gdal_translate -co TILED=YES makes smaller ones");
  require_whole_dted(raster, dem);
  require_own_data(raster, dem);
}

}  // namespace

void refuse_link(const FileGuard& guard, const DemBase& dem) {
  if (const std::optional<std::string> file = guard.refused())
    throw FormatError(dem.path + ": refers to another file, " + *file +
                          "; merge them into one file with gdal_translate, or follow its links",
                      "follow_links");
}

bool is_signed_byte(GDALRasterBand& band) {
  const char* const type = band.GetMetadataItem("PIXELTYPE", "IMAGE_STRUCTURE");
  return band.GetRasterDataType() == GDT_Byte && type != nullptr && EQUAL(type, "SIGNEDBYTE");
}

OpenRaster open_raster(const DemBase& dem, RasterLinks links, const GdalErrors& errors) {
  for (const std::string& file : named_files(dem.path, links)) {
    require_no_stream(file);
    require_whole_classic_netcdf(file);
  }
  auto checks = std::make_unique<StrictReading>();
  auto guard = std::make_unique<FileGuard>(dem.path, links);
  constexpr unsigned kFlags = GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR;
  GDALDatasetUniquePtr dataset = guard->open(kFlags);
  if (!dataset) {
    refuse_link(*guard, dem);
    refuse_unopened(dem, errors);
  }
  const int bands = dataset->GetRasterCount();
  if (bands < 1) throw FormatError(dem.path + ": has no raster band" + subdataset_hint(*dataset));
  if (dem.band < 1 || dem.band > bands)
    throw UsageError(dem.path + ": band " + std::to_string(dem.band) + " is not in 1.." +
                     std::to_string(bands));
  GDALRasterBand* band = dataset->GetRasterBand(dem.band);
  const RasterSize size{dataset->GetRasterYSize(), dataset->GetRasterXSize()};
  OpenRaster raster{std::move(checks), std::move(guard), std::move(dataset), band, size};
  require_usable(raster, dem);
  const OGRSpatialReference* const own_crs = raster.dataset->GetSpatialRef();
  if (dem.crs.empty() && (own_crs != nullptr || errors.unknown_crs()))
    require_known_crs(own_crs, dem.path, errors, "give the CRS");
  if (!dem.crs.empty())
    raster.given_crs = std::make_unique<OGRSpatialReference>(crs_of_text(dem.crs, dem.path + ": crs"));
  return raster;
}

}  // namespace landfall
