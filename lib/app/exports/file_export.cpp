// SPDX-License-Identifier: GPL-3.0-or-later
// A TIFF of several layers has one type, the smallest of float64, float32, int32 and int16 that can
// represent all: GDAL's COG driver supports nothing else, and one file per layer would split a DEM. int8
// becomes int16, because GDAL before 3.7 has no int8.
#include "app/exports/file_export.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "app/exports/csv.h"
#include "app/exports/grid_layers.h"
#include "app/exports/las.h"
#include "app/exports/point_clouds.h"
#include "app/exports/point_reader.h"
#include "app/exports/quick_look.h"
#include "app/exports/sites.h"
#include "app/exports/xdmf.h"
#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/text/file_path.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "formats/gdal/gdal_loader.h"
#include "formats/gdal/map_frame.h"
#include "formats/picture/rgb_image.h"
#include "store/files/crs.h"
#include "store/files/grid_mapping.h"
#include "store/files/imported_scan.h"

namespace landfall {
namespace {

/// An export of one file.
struct Job {
  const ExportOptions& options;
  const OutputOptions& output;
  const std::string& tool;
  const ProgressCallback& progress;
};

// They return a remark about the values in the file, or nothing.
using PointWriter = std::string(const Job& job, const PointReader& points, ByteSink& sink);
using GridWriter = std::string(const Job& job, ByteSink& sink);
using FileWriter = std::string(const Job& job);

/// A format of landfall-export.
struct ExportFormat {
  std::string_view name;     ///< its extension without the dot
  std::string_view also;     ///< another extension
  const char* scan_options;  ///< the options that apply to a scan; null: scans cannot become this format
  const char* grid_options;  ///< of the other kinds
  std::string_view only;     ///< the only kind that can become it; empty: all whose options are given
  PointWriter* write_points = nullptr;
  GridWriter* write_grid = nullptr;
  FileWriter* write_file = nullptr;  ///< in place of the others; all null: app/runs/cloud_output.h
};

PointWriter csv_points, las_points, pcd_points, ply_points, xmf_points;
GridWriter csv_grid, xmf_grid;
FileWriter geopackage_file, picture_file, geotiff_file;

constexpr ExportFormat kFormats[] = {
    {"csv", "", "--columns --every --frame --keep-misses", "--every --layers --sites", "", csv_points,
     csv_grid},
    {"gpkg", "", nullptr, "--sites", "hazards", nullptr, nullptr, geopackage_file},
    {"html", "", "--max-points", nullptr, ""},
    {"las", "", "--every --frame --position --time", nullptr, "", las_points},
    {"pcd", "", "--columns --every --frame --position", nullptr, "", pcd_points},
    {"ply", "", "--columns --every --frame --position", nullptr, "", ply_points},
    {"png", "", "--layers", "--layers", "", nullptr, nullptr, picture_file},
    {"tif", "tiff", nullptr, "--layers", "", nullptr, nullptr, geotiff_file},
    {"xmf", "xdmf", "--position", "--layers", "", xmf_points, xmf_grid}};

const ExportFormat& format_named(const std::string& name) {
  return *std::ranges::find(kFormats, name, &ExportFormat::name);
}

bool has_extension(const ExportFormat& format, const std::string& extension) {
  return extension.size() > 1 && (extension.substr(1) == format.name || extension.substr(1) == format.also);
}

const char* options_of(const ExportFormat& format, const std::string& kind) {
  return kind == "scan" ? format.scan_options : format.grid_options;
}

bool is_format_of(const ExportFormat& format, const std::string& kind) {
  return options_of(format, kind) != nullptr && (format.only.empty() || format.only == kind);
}

/// ".csv, .gpkg, ...".
std::string listed_extensions() { return "." + joined(export_formats(), ", ."); }

std::string format_of(const ExportOptions& o, const std::string& output) {
  if (output == "-") {
    if (o.format.empty()) throw UsageError("-o - needs --format csv");
    if (o.format != "csv")
      throw UsageError("--format " + o.format + " cannot be written to standard output; use csv");
    return o.format;
  }
  const std::string extension = file_extension(output);
  std::string named;
  for (const ExportFormat& format : kFormats)
    if (has_extension(format, extension)) named = format.name;
  if (!named.empty() && !o.format.empty() && named != o.format)
    throw UsageError("output " + output + ": its extension contradicts --format " + o.format);
  if (!o.format.empty()) return o.format;
  if (extension == ".geojson")
    throw UsageError("output " + output +
                     ": GeoJSON has longitude and latitude on WGS 84 only (RFC 7946); a .gpkg holds landing "
                     "sites in their own frame");
  if (named.empty())
    throw UsageError("output " + output + ": extension '" + extension + "' is not one of " +
                     listed_extensions() + "; --format names one");
  return named;
}

/// Throws UsageError unless a file of this kind can be exported to this format.
void require_possible(const LandfallFileReader& file, const std::string& format) {
  const std::string& input = file.name();
  if (h5::exists(file.root(), "mesh") && format != "png")
    throw UsageError(input + " is a mesh terrain, which can become .png; terrain-gen --from " + input +
                     " -o mesh.ply exports the mesh");
  const std::string kind = kind_of(file);
  std::vector<std::string> formats;
  for (const ExportFormat& each : kFormats)
    if (is_format_of(each, kind)) formats.emplace_back(each.name);
  if (std::ranges::find(formats, format) != formats.end()) return;
  std::string listed;
  for (const std::string& each : formats)
    listed += (listed.empty() ? "." : each == formats.back() ? " or ." : ", .") + each;
  throw UsageError(input + " is a landfall." + kind + " file, which can become " + listed + "; not ." +
                   format);
}

/// Throws UsageError for an option that has no effect in an export to this format.
void require_no_stray_option(const ExportOptions& o, bool is_scan) {
  const std::string_view applies = options_of(format_named(o.format), is_scan ? "scan" : "");
  const std::pair<bool, std::string_view> options[] = {
      {!o.layers.empty(), "--layers"}, {!o.columns.empty(), "--columns"}, {!o.position.empty(), "--position"},
      {o.every != 1, "--every"},       {o.keep_misses, "--keep-misses"},  {o.max_points != 0, "--max-points"},
      {!o.time.empty(), "--time"},     {!o.frame.empty(), "--frame"},     {o.sites, "--sites"}};
  for (const auto& [given, name] : options)
    if (given && applies.find(name) == std::string_view::npos)
      throw UsageError(std::string(name) + " does not apply to the export of a " +
                       (is_scan ? "scan" : "grid") + " to ." + o.format);
}

void require_sites(const ExportOptions& o, const std::string& kind) {
  if (o.format == "gpkg" && !o.sites)
    throw UsageError("a .gpkg holds the landing sites of a hazard map: add --sites");
  if (!o.sites) return;
  if (kind != "hazards") throw UsageError("--sites: " + o.input + " is not a hazard map");
  if (!o.layers.empty() || o.every != 1) throw UsageError("--sites goes with neither --layers nor --every");
}

/// The map on which the points are exported; none for the site frame.
std::optional<MapFrame> export_map(const PointReader& points, const std::string& frame) {
  if (frame == "site") return std::nullopt;
  std::optional<MapFrame> map;
  try {
    map = map_frame(read_crs(points.file()));
  } catch (const IoError& error) {
    points.file().fail(std::string("its map cannot be read: ") + error.what() + "; --frame site needs none");
  }
  if (!map && frame == "map")
    throw UsageError("--frame map: " + points.file().name() +
                     " has no CRS: its site frame is on no map; import points with landfall-import --crs, or "
                     "use --frame site");
  if (!map || !points.is_imported()) return map;
  const SourceHeights heights = source_heights(points.file());
  map->center_height = heights.center;
  map->metres_per_height = heights.metres_per_unit;
  return map;
}

/// x, y and z first, then the other columns.
PointReader::Pass properties_pass(const PointReader& points, const ExportOptions& o) {
  PointReader::Pass pass{position_columns(o.position), {true, o.every}, 3};
  for (const std::string& name : points.choose(o.columns))
    if (std::find(pass.columns.begin(), pass.columns.begin() + 3, name) == pass.columns.begin() + 3)
      pass.columns.push_back(name);
  return pass;
}

/// Writes the .xmf and the file of positions that it refers to, which gets its final name first. Returns
/// a remark on their frame, or nothing.
std::string xmf_points(const Job& job, const PointReader& points, ByteSink& sink) {
  const auto& [o, output, tool, progress] = job;
  // The .xmf only refers to the scan's rows, so that it cannot leave any out.
  if (points.count({true, 1}) != points.row_count())
    throw UsageError(points.file().name() +
                     " contains rows without a return, which an .xmf cannot omit; export .ply");
  const std::filesystem::path file = xdmf_positions(output.path);
  const PointPositions positions = positions_of(points, o.position, xdmf_reference(o.input, output.path));
  OutputPath positions_output(file, output.overwrite);
  write_point_positions(positions_output, positions, tool, output.compression);
  std::vector<ContentInfo> columns = points.columns();
  std::erase_if(columns, [](const ContentInfo& column) { return column.name == "t"; });
  sink.write(points_xdmf(columns, positions, file.filename().string()));
  sink.flush();
  positions_output.commit();
  if (is_local_crs(read_crs(points.file()))) return "";
  return output.path.string() +
         ": positions are those of the site frame, because an .xmf refers to the scan; a .ply has those of "
         "the map";
}

/// A remark on the times of a .las; empty if the options say it.
std::string time_remark(const PointReader& points, const ExportOptions& o, const std::string& output) {
  constexpr double kWeek_s = 604800;
  if (o.time.empty() && points.is_imported())
    return points.has(name_of(&PulseColumns::t)) ? output + ": times are seconds since the first point" : "";
  if (o.time.empty())
    return output + ": times are seconds since the first pulse; --time gps writes adjusted standard GPS time";
  if (o.time == "gps" && points.pulse_times().epoch_s < kWeek_s)
    return output + ": the times lie in January 1980, because the trajectory begins at t = " +
           number_text(points.pulse_times().epoch_s) + " s; --time gps wants a clock of GPS seconds";
  return "";
}

/// A remark on the offset of positions on a map, and on positions that float32 rounds visibly; else empty.
std::string float_remark(const std::optional<MapFrame>& map, double rounding, const std::string& output) {
  constexpr double kVisible_m = 1e-4;
  const double rounding_m = rounding * (map ? map->metres_per_unit : 1);
  std::string remark;
  if (map)
    remark = "x, y and z are relative to the translation of VIEWPOINT, " +
             joined(pcd_offset(map), ", ", [](double value) { return number_text(value); }) + " in " +
             map->crs_name;
  if (rounding_m > kVisible_m)
    remark += std::string(map ? "; they" : "x, y and z") + " are rounded to float32, by up to " +
              short_number(1000 * rounding_m) + " mm; a .ply keeps them";
  return remark.empty() ? "" : output + ": " + remark;
}

std::string las_points(const Job& job, const PointReader& points, ByteSink& sink) {
  const ExportOptions& o = job.options;
  const std::string output = job.output.path.string();
  std::string remark = time_remark(points, o, output);
  for (const std::string& each : write_points_las(points,
                                                  {.position = o.position,
                                                  .every = o.every,
                                                  .time = o.time == "gps" ? LasTime::gps : LasTime::scan,
                                                  .software = job.tool + " " + program_version()},
                                                  sink, job.progress))
    remark += (remark.empty() ? output + ": " : "; ") + each;
  return remark;
}

/// A remark on a map whose unit is not that of its heights: readers of a .las take both as one.
std::string unit_remark(const std::optional<MapFrame>& map) {
  if (!map || map->is_geographic || std::abs(map->metres_per_unit - map->metres_per_height) < 1e-6) return "";
  return "elevations are in " + length_unit_name(map->metres_per_height) + ", x and y in " + map->unit;
}

std::string pcd_points(const Job& job, const PointReader& points, ByteSink& sink) {
  const double rounding = write_points_pcd(points, properties_pass(points, job.options), sink, job.progress);
  return float_remark(points.map(), rounding, job.output.path.string());
}

std::string csv_points(const Job& job, const PointReader& points, ByteSink& sink) {
  const ExportOptions& o = job.options;
  write_points_csv(points, {points.choose(o.columns), {!o.keep_misses, o.every}}, sink, job.progress);
  return "";
}

std::string ply_points(const Job& job, const PointReader& points, ByteSink& sink) {
  write_points_ply(points, properties_pass(points, job.options), sink, job.progress);
  return "";
}

std::string export_scan(const Job& job, const ExportFormat& format, ByteSink& sink) {
  PointReader points(job.options.input);
  if (format.name != "xmf")
    if (std::optional<MapFrame> map = export_map(points, job.options.frame)) points.place_on(std::move(*map));
  const std::string remark = format.write_points(job, points, sink);
  const std::string units = unit_remark(points.map());
  if (units.empty()) return remark;
  return (remark.empty() ? job.output.path.string() + ": " : remark + "; ") + units;
}

std::string xmf_grid(const Job& job, ByteSink& sink) {
  const ExportOptions& o = job.options;
  const GridSource grid(o.input);
  const std::vector<ContentInfo> layers = o.layers.empty() ? grid.layers() : grid.choose(o.layers);
  sink.write(grid_xdmf(layers, grid.spec(), xdmf_reference(o.input, job.output.path)));
  return "";
}

std::string csv_grid(const Job& job, ByteSink& sink) {
  const ExportOptions& o = job.options;
  if (o.sites) {
    write_sites_csv(LandfallFileReader(o.input, {"hazards"}), sink);
    return "";
  }
  const GridSource grid(o.input);
  const std::vector<NamedLayer> layers =
      grid.read(grid.choose(o.layers), [&](double f) { report(job.progress, f / 4); });
  write_layers_csv(layers, o.every, sink, [&](double f) { report(job.progress, (1 + 3 * f) / 4); });
  return "";
}

/// Adds the input's name to a writer's error about its content.
void naming(const std::string& input, const std::function<void()>& write) {
  try {
    write();
  } catch (const FormatError& error) {
    const std::string what = error.what();
    throw FormatError(what.starts_with(input) ? what : input + ": " + what);
  }
}

std::string geotiff_file(const Job& job) {
  const std::string& input = job.options.input;
  const GridSource grid(input);
  const std::vector<NamedLayer> layers =
      grid.read(grid.choose(job.options.layers), [&](double f) { report(job.progress, f / 2); });
  GeotiffContent content{{}, grid.crs_wkt(), source_line(job.tool), grid.file().file_id()};
  for (const NamedLayer& layer : layers)
    content.bands.push_back(
        {std::visit([](const auto& values) { return decltype(GeotiffBand::values)(&values); }, layer.values),
         layer.info.units, layer.info.name});
  naming(input,
         [&] { write_geotiff(job.output, content, [&](double f) { report(job.progress, (1 + f) / 2); }); });
  return "";
}

std::string geopackage_file(const Job& job) {
  const std::string& input = job.options.input;
  naming(input, [&] { write_sites_geopackage(LandfallFileReader(input, {"hazards"}), job.output); });
  return "";
}

std::string picture_file(const Job& job) {
  const ExportOptions& o = job.options;
  const std::string names = joined(o.layers, ",");
  if (o.layers.size() > 1 || names == "all")
    throw UsageError("a .png shows one layer; --layers names " + names);
  write_png(job.output, quick_look(o.input, names, job.progress));
  return "";
}

}  // namespace

std::vector<std::string> export_formats() {
  return mapped(kFormats, [](const ExportFormat& format) { return std::string(format.name); });
}

bool is_exported(const std::string& kind, const std::string& extension) {
  return std::ranges::any_of(kFormats, [&](const ExportFormat& format) {
    return has_extension(format, extension) && (kind.empty() || is_format_of(format, kind));
  });
}

FileExport::FileExport(ExportOptions options, const std::string& output)
    : options_(std::move(options)), output_(output) {
  options_.format = format_of(options_, output);
  const LandfallFileReader file(options_.input, kLandfallKinds);
  kind_ = kind_of(file);
  require_possible(file, options_.format);
  require_no_stray_option(options_, kind_ == "scan");
  require_sites(options_, kind_);
  if (options_.position.empty()) options_.position = "est";
}

std::string FileExport::second_output() const {
  return kind_ == "scan" && options_.format == "xmf" ? xdmf_positions(output_).string() : "";
}

std::string FileExport::write(const OutputOptions& output, const std::string& tool,
                              const ProgressCallback& progress) const {
  const Job job{options_, output, tool, progress};
  const ExportFormat& format = format_named(options_.format);
  if (format.write_file != nullptr) return format.write_file(job);
  const auto write_to = [&](ByteSink&& sink) {
    const std::string remark =
        kind_ == "scan" ? export_scan(job, format, sink) : format.write_grid(job, sink);
    sink.finish();
    return remark;
  };
  if (output_ == "-") return write_to(StandardOutputSink());
  OutputPath path(output.path, output.overwrite);
  return write_to(FileSink(path));
}

}  // namespace landfall
