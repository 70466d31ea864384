// SPDX-License-Identifier: GPL-3.0-or-later
// A TIFF of several layers has one type, the smallest of float64, float32, int32 and int16 that can
// represent all: GDAL's COG driver supports nothing else, and one file per layer would split a DEM. int8
// becomes int16, because GDAL before 3.7 has no int8.
#include "exports/file_export.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "base/error.h"
#include "base/file_path.h"
#include "base/joined.h"
#include "base/number_text.h"
#include "exports/csv.h"
#include "exports/grid_layers.h"
#include "exports/las.h"
#include "exports/point_clouds.h"
#include "exports/point_reader.h"
#include "exports/quick_look.h"
#include "exports/sites.h"
#include "exports/xdmf.h"
#include "files/crs.h"
#include "files/grid_mapping.h"
#include "files/imported_scan.h"
#include "picture/rgb_image.h"
#include "terrain/gdal/gdal_loader.h"
#include "terrain/gdal/map_frame.h"

namespace landfall {
namespace {

/// Whether `words`, separated by spaces, contain this format.
bool has(std::string_view words, const std::string& format) {
  return words.find(format) != std::string_view::npos;
}

/// ".csv, .gpkg, ...".
std::string listed_extensions() {
  std::string text;
  for (const std::string& format : export_formats()) text += (text.empty() ? "." : ", .") + format;
  return text;
}

std::string format_of(const ExportOptions& o, const std::string& output) {
  if (output == "-") {
    if (o.format.empty()) throw UsageError("-o - needs --format csv");
    if (o.format != "csv")
      throw UsageError("--format " + o.format + " cannot be written to standard output; use csv");
    return o.format;
  }
  const std::string extension = file_extension(output);
  std::string named;
  if (extension == ".xdmf") named = "xmf";
  if (extension == ".tiff") named = "tif";
  for (const std::string& known : export_formats())
    if (extension == "." + known) named = known;
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

/// The formats of a kind of file, in alphabetical order.
std::vector<std::string> formats_of(const std::string& kind) {
  if (kind == "scan") return {"csv", "html", "las", "pcd", "ply", "png", "xmf"};
  if (kind == "hazards") return {"csv", "gpkg", "png", "tif", "xmf"};
  return {"csv", "png", "tif", "xmf"};
}

/// Throws UsageError unless a file of this kind can be exported to this format.
void require_possible(const LandfallFileReader& file, const std::string& format) {
  const std::string& input = file.name();
  if (h5::exists(file.root(), "mesh") && format != "png")
    throw UsageError(input + " is a mesh terrain, which can become .png; terrain-gen --from " + input +
                     " -o mesh.ply exports the mesh");
  const std::string kind = kind_of(file);
  const std::vector<std::string> formats = formats_of(kind);
  if (std::ranges::find(formats, format) != formats.end()) return;
  std::string listed;
  for (const std::string& each : formats)
    listed += (listed.empty() ? "." : each == formats.back() ? " or ." : ", .") + each;
  throw UsageError(input + " is a landfall." + kind + " file, which can become " + listed + "; not ." +
                   format);
}

/// Throws UsageError for an option that has no effect in an export to this format.
void require_no_stray_option(const ExportOptions& o, bool is_scan) {
  struct Option {
    bool given;
    const char* name;
    std::string_view of_scan;  ///< the formats to which it applies
    std::string_view of_grid;
  };
  const Option options[] = {{!o.layers.empty(), "--layers", "png", "csv png tif xmf"},
                            {!o.columns.empty(), "--columns", "csv pcd ply", ""},
                            {!o.position.empty(), "--position", "las pcd ply xmf", ""},
                            {o.every != 1, "--every", "csv las pcd ply", "csv"},
                            {o.keep_misses, "--keep-misses", "csv", ""},
                            {o.max_points != 0, "--max-points", "html", ""},
                            {!o.time.empty(), "--time", "las", ""},
                            {!o.frame.empty(), "--frame", "csv las pcd ply", ""},
                            {o.sites, "--sites", "", "csv gpkg"}};
  for (const Option& option : options)
    if (option.given && !has(is_scan ? option.of_scan : option.of_grid, o.format))
      throw UsageError(std::string(option.name) + " does not apply to the export of a " +
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
    throw UsageError(
        "--frame map: " + points.file().name() +
        " has no CRS: its site frame is on no map; import points with --crs, or use --frame site");
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

/// Writes the .xmf, and beside it the positions that it refers to, which get their final name first. Returns
/// a remark on their frame, or nothing.
std::string export_points_xdmf(const PointReader& points, const ExportOptions& o, const OutputOptions& output,
                               const std::string& tool, ByteSink& sink) {
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
             joined(pcd_offset(map), ", ", number_text) + " in " + map->crs_name;
  if (rounding_m > kVisible_m)
    remark += std::string(map ? "; they" : "x, y and z") + " are rounded to float32, by up to " +
              short_number(1000 * rounding_m) + " mm; a .ply keeps them";
  return remark.empty() ? "" : output + ": " + remark;
}

/// Returns a remark about the values in the file, or nothing.
std::string export_las(const PointReader& points, const ExportOptions& o, const std::string& output,
                       const std::string& tool, ByteSink& sink, const ProgressCallback& progress) {
  std::string remark = time_remark(points, o, output);
  for (const std::string& each : write_points_las(points,
                                                  {.position = o.position,
                                                  .every = o.every,
                                                  .time = o.time == "gps" ? LasTime::gps : LasTime::scan,
                                                  .software = tool + " " + program_version()},
                                                  sink, progress))
    remark += (remark.empty() ? output + ": " : "; ") + each;
  return remark;
}

/// A remark on a map whose unit is not that of its heights: readers of a .las take both as one.
std::string unit_remark(const std::optional<MapFrame>& map) {
  if (!map || map->is_geographic || std::abs(map->metres_per_unit - map->metres_per_height) < 1e-6) return "";
  return "elevations are in " + length_unit_name(map->metres_per_height) + ", x and y in " + map->unit;
}

/// Returns a remark about the values in the file, or nothing.
std::string export_points(const ExportOptions& o, const PointReader& points, const OutputOptions& output,
                          const std::string& tool, ByteSink& sink, const ProgressCallback& progress) {
  if (o.format == "pcd")
    return float_remark(points.map(), write_points_pcd(points, properties_pass(points, o), sink, progress),
                        output.path.string());
  if (o.format == "las") return export_las(points, o, output.path.string(), tool, sink, progress);
  if (o.format == "csv")
    write_points_csv(points, {points.choose(o.columns), {!o.keep_misses, o.every}}, sink, progress);
  else if (o.format == "ply")
    write_points_ply(points, properties_pass(points, o), sink, progress);
  else
    return export_points_xdmf(points, o, output, tool, sink);
  return "";
}

/// Returns a remark about the values in the file, or nothing.
std::string export_scan(const ExportOptions& o, const OutputOptions& output, const std::string& tool,
                        ByteSink& sink, const ProgressCallback& progress) {
  PointReader points(o.input);
  if (o.format != "xmf")
    if (std::optional<MapFrame> map = export_map(points, o.frame)) points.place_on(std::move(*map));
  const std::string remark = export_points(o, points, output, tool, sink, progress);
  const std::string units = unit_remark(points.map());
  if (units.empty()) return remark;
  return (remark.empty() ? output.path.string() + ": " : remark + "; ") + units;
}

void export_grid(const ExportOptions& o, const OutputOptions& output, ByteSink& sink,
                 const ProgressCallback& progress) {
  const GridSource grid(o.input);
  if (o.format == "xmf") {
    const std::vector<ContentInfo> layers = o.layers.empty() ? grid.layers() : grid.choose(o.layers);
    sink.write(grid_xdmf(layers, grid.spec(), xdmf_reference(o.input, output.path)));
    return;
  }
  const std::vector<NamedLayer> layers =
      grid.read(grid.choose(o.layers), [&](double f) { report(progress, f / 4); });
  write_layers_csv(layers, o.every, sink, [&](double f) { report(progress, (1 + 3 * f) / 4); });
}

/// Adds the input's name to what a writer finds wrong in its content.
void naming(const std::string& input, const std::function<void()>& write) {
  try {
    write();
  } catch (const FormatError& error) {
    const std::string what = error.what();
    throw FormatError(what.starts_with(input) ? what : input + ": " + what);
  }
}

void export_geotiff(const ExportOptions& o, const OutputOptions& output, const std::string& tool,
                    const ProgressCallback& progress) {
  const GridSource grid(o.input);
  const std::vector<NamedLayer> layers =
      grid.read(grid.choose(o.layers), [&](double f) { report(progress, f / 2); });
  GeotiffContent content{{}, grid.crs_wkt(), source_line(tool), grid.file().file_id()};
  for (const NamedLayer& layer : layers)
    content.bands.push_back(
        {std::visit([](const auto& values) { return decltype(GeotiffBand::values)(&values); }, layer.values),
         layer.info.units, layer.info.name});
  naming(o.input, [&] { write_geotiff(output, content, [&](double f) { report(progress, (1 + f) / 2); }); });
}

void export_picture(const ExportOptions& o, const OutputOptions& output, const ProgressCallback& progress) {
  const std::string names = joined(o.layers, ",");
  if (o.layers.size() > 1 || names == "all")
    throw UsageError("a .png shows one layer; --layers names " + names);
  write_png(output, quick_look(o.input, names, progress));
}

}  // namespace

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = {"csv", "gpkg", "html", "las", "pcd",
                                                   "ply", "png",  "tif",  "xmf"};
  return formats;
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
  std::string remark;
  if (options_.format == "tif") {
    export_geotiff(options_, output, tool, progress);
  } else if (options_.format == "png") {
    export_picture(options_, output, progress);
  } else if (options_.format == "gpkg") {
    naming(options_.input,
           [&] { write_sites_geopackage(LandfallFileReader(options_.input, {"hazards"}), output); });
  } else {
    const auto write_to = [&](ByteSink&& sink) {
      if (options_.sites)
        write_sites_csv(LandfallFileReader(options_.input, {"hazards"}), sink);
      else if (kind_ == "scan")
        remark = export_scan(options_, output, tool, sink, progress);
      else
        export_grid(options_, output, sink, progress);
      sink.finish();
    };
    if (output_ == "-") {
      write_to(StandardOutputSink());
    } else {
      OutputPath path(output.path, output.overwrite);
      write_to(FileSink(path));
    }
  }
  return remark;
}

}  // namespace landfall
