// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D38, D120
// Terrains above 2^26 nodes are made in strips of 768 rows, a multiple of the 256 of the chunks and the
// 384 of the fractal patches. Strips wait in memory until the ground under the centre of every feature
// that reaches into them is known; the alternatives, a temporary file or making the ground twice, cost 8
// bytes of disk per node or twice the time. A feature that reaches across the whole site keeps the site in
// memory.
#include "chain/terrain/relief/terrain_strips.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "base/core/error.h"
#include "base/raster/by_rows.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/mesh/indexed_triangles.h"
#include "chain/terrain/relief/fractal.h"
#include "chain/terrain/relief/terrain_generator.h"
#include "chain/terrain/site_wkt.h"

namespace landfall {
namespace {

constexpr std::int64_t kMaxNodes = std::int64_t{1} << 30U;  // 8 GiB of elevations
constexpr std::int64_t kBorderRows = 2;

TerrainModel fitting_model(TerrainModel model, const GridSpec& spec) {
  validate(model, spec);
  return model;
}

/// Checks explicit wavelengths only: a raster may leave no waves to a fractal.
void require_waves(const TerrainModel& model, const GridSpec& spec) {
  for (std::size_t i = 0; i < model.bases.size(); ++i)
    if (const auto* const fractal = std::get_if<FractalBase>(&model.bases[i]);
        fractal != nullptr && fractal->longest_wavelength_m)
      require(*fractal->longest_wavelength_m > 2 * spec.resolution_m,
              {"base/" + std::to_string(i), "longest_wavelength_m"}, *fractal->longest_wavelength_m,
              "above twice the grid's resolution, the shortest wave that the grid can represent");
}

/// Calls set(z, x, y) for every node.
template <class F>
void for_each_node(Grid<double>& z, const ProgressCallback& progress, const F& set) {
  const GridSpec spec = z.spec();
  const auto set_row = [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) set(z.at({row, col}), spec.x(col), spec.y(row));
  };
  by_rows(spec, set_row, progress);
}

/// The elevation of the raster that becomes 0.
double datum_of(const DemBase& dem, const DemRaster& raster) {
  if (dem.datum == Datum::none) return 0;
  const double datum_m = dem.vertical_scale.value_or(1) *
                         interpolate(raster.samples, dem.interpolation, raster.mapping.pixel({0, 0}));
  if (!std::isfinite(datum_m))
    throw FormatError(dem.path +
                      ": has no elevation at the site centre, which datum \"center\" needs; give another "
                      "center, or datum \"none\"");
  return datum_m;
}

void add_plane(Grid<double>& z, const PlaneBase& plane, const ProgressCallback& progress) {
  for_each_node(z, progress, [&](double& node, double x_m, double y_m) {
    node += plane.elevation_m + plane.slope_x * x_m + plane.slope_y * y_m;
  });
}

/// z += elevation - datum at every node. Returns whether any elevation is finite.
bool add_raster(Grid<double>& z, const DemRaster& raster, const DemBase& dem, double datum_m,
                const ProgressCallback& progress) {
  std::atomic<bool> any_finite = false;
  for_each_node(z, progress, [&](double& node, double x_m, double y_m) {
    const PixelPosition pixel = raster.mapping.pixel({x_m, y_m});
    if (!inside(raster.samples.size, dem.interpolation, pixel)) {
      std::ostringstream message;
      message << dem.path << ": the site's node at (" << x_m << ", " << y_m << ") m lies outside the raster";
      throw FormatError(message.str());
    }
    const double elevation =
        dem.vertical_scale.value_or(1) * interpolate(raster.samples, dem.interpolation, pixel);
    if (std::isfinite(elevation) && !any_finite.load(std::memory_order_relaxed)) any_finite = true;
    node += elevation - datum_m;
  });
  return any_finite;
}

/// The first node, row by row, whose elevation is infinite or farther than kLargestCoordinate_m from 0. Holes
/// are skipped.
std::optional<BinIndex> first_absurd_node(const Grid<double>& z, const ProgressCallback& progress) {
  const auto is_absurd = [](double z_m) { return std::abs(z_m) > kLargestCoordinate_m; };
  std::atomic<std::int64_t> first_row = z.spec().rows;
  const auto check_row = [&](std::int64_t row) {
    std::int64_t known = first_row;
    if (row > known || std::ranges::none_of(z.row(row), is_absurd)) return;
    while (row < known && !first_row.compare_exchange_weak(known, row)) continue;
  };
  by_rows(z.spec(), check_row, progress);
  if (first_row == z.spec().rows) return std::nullopt;
  const auto nodes = z.row(first_row);
  return BinIndex{first_row, std::ranges::find_if(nodes, is_absurd) - nodes.begin()};
}

/// The progress of part `step` of `steps` equal parts; `progress` must outlive it.
ProgressCallback step_of(const ProgressCallback& progress, std::size_t step, std::size_t steps) {
  return [&progress, step, steps](double fraction) {
    report(progress, (static_cast<double>(step) + fraction) / static_cast<double>(steps));
  };
}

/// Joins the last rows of one grid and the first rows of the grid north of it.
Grid<double> joined_rows(const Grid<double>& south, const Grid<double>& north) {
  GridSpec spec = south.spec();
  spec.rows += kBorderRows;
  Grid<double> both(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    const bool in_south = row < south.spec().rows;
    std::ranges::copy(in_south ? south.row(row) : north.row(row - south.spec().rows), both.row(row).begin());
  }
  return both;
}

Grid<double> last_rows(const Grid<double>& strip) {
  GridSpec spec = strip.spec();
  spec.first_row += spec.rows - kBorderRows;
  spec.rows = kBorderRows;
  Grid<double> rows(spec);
  for (std::int64_t row = 0; row < kBorderRows; ++row)
    std::ranges::copy(strip.row(strip.spec().rows - kBorderRows + row), rows.row(row).begin());
  return rows;
}

}  // namespace

void validate(const TerrainModel& model, const GridSpec& spec) {
  validate(model);
  if (spec.rows > kMaxNodes || spec.cols > kMaxNodes || spec.rows * spec.cols > kMaxNodes)
    throw UsageError("grid: " + std::to_string(spec.cols) + " x " + std::to_string(spec.rows) +
                     " nodes are more than 2^30");
  require_waves(model, spec);
  if (model.albedo) validate(*model.albedo, spec);
  require_on_grid(model, spec);
}

TerrainStrips::TerrainStrips(TerrainModel model, const GridSpec& spec, const DemLoader& load_dem,
                             const StripSize& size, const ProgressCallback& progress)
    : model_(fitting_model(std::move(model), spec)), spec_(spec), size_(size), field_(model_, spec) {
  for (const Base& base : model_.bases) {
    const auto* const dem = std::get_if<DemBase>(&base);
    if (dem == nullptr) continue;
    DemRaster raster = load_dem(*dem, spec);
    const double datum_m = datum_of(*dem, raster);
    dems_.push_back({std::move(raster), datum_m});
  }
  make_fractals(progress);
  if (model_.albedo)
    albedo_.emplace(*model_.albedo, AlbedoSite{spec_, model_.seed, size_.max_nodes}, load_dem);
  report(progress, 1);
}

/// A raster of posting p holds wavelengths down to 2 p: fractal waves shorter than this lie in no raster.
double TerrainStrips::waves_without_raster_m() const {
  double longest_m = std::numeric_limits<double>::infinity();
  for (const DemLayer& dem : dems_) {
    const double posting_m = dem.raster.mapping.posting_m();
    if (!(posting_m > 0) || !std::isfinite(posting_m))
      throw FormatError(dem.raster.source.path +
                        ": has no posting at the site centre, which is a pole of its " +
                        "longitudes; give the fractal's longest_wavelength_m in metres");
    longest_m = std::min(longest_m, 2 * posting_m);
  }
  return longest_m;
}

void TerrainStrips::make_fractals(const ProgressCallback& progress) {
  for (std::size_t i = 0; i < model_.bases.size(); ++i) {
    auto* const fractal = std::get_if<FractalBase>(&model_.bases[i]);
    if (fractal == nullptr) continue;
    if (!fractal->longest_wavelength_m) fractal->longest_wavelength_m = waves_without_raster_m();
    if (is_whole()) continue;
    large_fractals_.emplace(
        i, LargeFractal(*fractal, {model_.seed, i}, spec_, step_of(progress, i, model_.bases.size())));
  }
}

std::string TerrainStrips::crs_wkt() const {
  if (dems_.empty()) return kLocalSiteCrsWkt;
  double datum_m = 0;
  for (const DemLayer& dem : dems_) datum_m += dem.datum_m;
  return raised(dems_.front().raster.crs_wkt, datum_m);
}

std::vector<DemSource> TerrainStrips::dem_sources() const {
  std::vector<DemSource> sources;
  for (const DemLayer& dem : dems_) sources.push_back(dem.raster.source);
  return sources;
}

std::vector<GridSpec> TerrainStrips::cut() const {
  std::vector<GridSpec> strips;
  const std::int64_t height = is_whole() ? spec_.rows : size_.rows;
  for (std::int64_t row = 0; row < spec_.rows;) {
    const std::int64_t left = spec_.rows - row;
    // The remaining rows must suffice for the borders.
    const std::int64_t rows = left < height + 2 * kBorderRows ? left : height;
    strips.push_back({spec_.resolution_m, spec_.first_row + row, spec_.first_col, rows, spec_.cols});
    row += rows;
  }
  return strips;
}

TerrainStrip TerrainStrips::ground(const GridSpec& strip, const ProgressCallback& progress) {
  Grid<double> z(strip);
  const std::size_t steps = model_.bases.size() + 1;
  auto dem_layer = dems_.begin();
  for (std::size_t i = 0; i < model_.bases.size(); ++i) {
    const ProgressCallback step = step_of(progress, i, steps);
    const Base& base = model_.bases[i];
    if (const auto* const plane = std::get_if<PlaneBase>(&base)) add_plane(z, *plane, step);
    if (const auto* const dem = std::get_if<DemBase>(&base)) {
      if (add_raster(z, dem_layer->raster, *dem, dem_layer->datum_m, step)) dem_layer->any_finite = true;
      ++dem_layer;
    }
    if (const auto* const fractal = std::get_if<FractalBase>(&base)) {
      if (is_whole())
        add_fractal(z, *fractal, {model_.seed, i}, step);
      else
        large_fractals_.at(i).add_to(z, step);
    }
  }
  std::optional<Grid<float>> albedo;
  if (albedo_) albedo = albedo_->layer(strip);
  field_.shape_ground(z, step_of(progress, steps - 1, steps), albedo ? &*albedo : nullptr);
  require_elevations(z);
  return {std::move(z), std::move(albedo)};
}

void TerrainStrips::require_elevations(const Grid<double>& z) const {
  const std::optional<BinIndex> node = first_absurd_node(z, {});
  if (!node) return;
  std::ostringstream message;
  message << "the elevation at (" << z.spec().x(node->col) << ", " << z.spec().y(node->row) << ") m is "
          << z.at(*node) << " m, farther than 1e12 m from 0";
  if (dems_.empty()) throw UsageError(message.str() + "; lower what the base or the features add there");
  throw FormatError(dems_.front().raster.source.path + ": " + message.str() +
                    "; is it a nodata value that the raster does not declare (gdal_translate -a_nodata)?");
}

void TerrainStrips::require_relief() const {
  auto dem_layer = dems_.begin();
  for (const Base& base : model_.bases) {
    const auto* const dem = std::get_if<DemBase>(&base);
    if (dem == nullptr) continue;
    if (!dem_layer->any_finite)
      throw FormatError(dem->path + ": no node of the site has an elevation; give another center");
    ++dem_layer;
  }
}

void TerrainStrips::seat(Grid<double>& strip) {
  const CellOrigin origin = is_whole() ? CellOrigin() : CellOrigin::of_windows(spec_, 0);
  if (border_) field_.seat(TriangulatedGrid(joined_rows(*border_, strip), origin));
  if (!is_whole()) border_ = last_rows(strip);
  TriangulatedGrid ground(std::move(strip), origin);
  field_.seat(ground);
  strip = std::move(ground).take_nodes();
}

void TerrainStrips::give_ready(const Sink& sink, const ProgressCallback& progress) {
  while (!waiting_.empty()) {
    TerrainStrip& strip = waiting_.front();
    const GridSpec& rows = strip.nodes.spec();
    const std::int64_t begin = rows.first_row - spec_.first_row;
    if (!field_.can_stand(begin, begin + rows.rows)) return;
    field_.stand(strip.nodes, progress, strip.albedo ? &*strip.albedo : nullptr);
    require_elevations(strip.nodes);
    if (strip.albedo) albedo_->finish(*strip.albedo, strip.nodes);
    sink(std::move(strip));
    waiting_.pop_front();
  }
}

void TerrainStrips::make(const Sink& sink, const ProgressCallback& progress) {
  const std::vector<GridSpec> strips = cut();
  for (std::size_t i = 0; i < strips.size(); ++i) {
    const ProgressCallback of_strip = step_of(progress, i, strips.size());
    waiting_.push_back(ground(strips[i], [&](double fraction) { report(of_strip, 0.9 * fraction); }));
    if (i + 1 == strips.size()) require_relief();
    seat(waiting_.back().nodes);
    give_ready(sink, strips.size() == 1
                         ? ProgressCallback([&](double fraction) { report(of_strip, 0.9 + fraction / 10); })
                         : ProgressCallback());
    report(of_strip, 1);
  }
}

}  // namespace landfall
