// SPDX-License-Identifier: GPL-3.0-or-later
#include "landfall_files.h"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include "chain/lidar/simulation/scan_pipeline.h"
#include "chain/lidar/simulation/scan_plan.h"
#include "chain/ray/flat_terrain.h"
#include "chain/ray/heightfield_engine.h"
#include "store/config/dem_config.h"
#include "store/config/hazard_config.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"
#include "store/config/terrain_config.h"
#include "store/files/dem_file.h"
#include "store/files/draws_file.h"
#include "store/files/draws_verdict.h"
#include "store/files/evaluation_file.h"
#include "store/files/hazard_file.h"
#include "store/files/mesh_terrain_file.h"
#include "store/files/plan_file.h"
#include "store/files/scan_gridding.h"
#include "store/files/terrain_file.h"
#include "store/hdf5/table.h"

namespace landfall::fuzz {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A folder that lives as long as this.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "landfall-fuzz-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

Json terrain_json() {
  return {{"grid", {{"half_width_m", 4}, {"resolution_m", 1}}},
          {"base", {{"type", "plane"}, {"slope_x", 0.1}}},
          {"features", Json::array({{{"type", "crater"}, {"x_m", 1}, {"y_m", 0}, {"diameter_m", 3}},
                                    {{"type", "rock"}, {"x_m", -2}, {"y_m", 1}, {"diameter_m", 1}}})}};
}

/// 4 pixels, 3 pulses.
Json scan_json() {
  return {{"detector", {{"rows", 2}, {"columns", 2}, {"fov_deg", 4}}},
          {"laser", {{"pulse_rate_hz", 10}, {"scan_time_s", 0.3}}},
          {"scanner", {{"type", "flash"}}},
          {"trajectory", {{"type", "constant_velocity"}, {"position_m", {0, 0, 50}}}}};
}

Provenance provenance_of(const char* tool, const char* schema, Json config) {
  return {.tool = tool, .config = resolve_config({"config", std::move(config)}, embedded_schema(schema))};
}

void add_input(Provenance& provenance, const char* role, const fs::path& path, const char* kind) {
  const LandfallFileReader file(path, {kind});
  provenance.add_input(role, file.file_id(), file.chain());
}

void make_terrain(const fs::path& path) {
  const Provenance provenance = provenance_of("terrain-gen", "terrain", terrain_json());
  const TerrainConfig config = terrain_config(provenance.config, "config");
  LandfallFileWriter file({path}, "terrain", provenance);
  write_terrain(file, generate_terrain(config.model, config.grid, {}));
}

void make_mesh(const fs::path& path) {
  LandfallFileWriter file({path}, "terrain", {.tool = "terrain-gen", .config = Json::object()});
  write_mesh_terrain(file, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 1}, {4, 4, 2}}, {{0, 1, 2}, {1, 3, 2}}});
}

ScanModel model_of(const Provenance& provenance) {
  return scan_model(completed_scan_config(provenance.config), "config", {});
}

/// All batches of a scan, one after the other.
template <class Use>
void run(const Simulation& simulation, const Use& use) {
  run_scan(simulation, {}, use, 1 << 12);
}

Provenance make_scan(const fs::path& path, const fs::path& terrain_path) {
  Provenance provenance = provenance_of("scan-sim", "scan", scan_json());
  add_input(provenance, "terrain", terrain_path, "terrain");
  const TerrainInput terrain = read_terrain(terrain_path);
  const auto engine = make_heightfield_engine(terrain.grid);
  const Simulation simulation(model_of(provenance), engine.get(), terrain.surface.get());
  LandfallFileWriter file({path}, "scan", provenance);
  ScanWriter writer(file, {}, terrain.crs_wkt);
  run(simulation, [&](PulseBatch& batch) { return writer.take(batch); });
  writer.commit(simulation.detector(), simulation.dead_map());
  return provenance;
}

void make_dem(const fs::path& path, const fs::path& scan_path, const fs::path& terrain_path) {
  Provenance provenance = provenance_of("regrid", "regrid", {{"half_width_m", 3}, {"resolution_m", 1}});
  add_input(provenance, "scan", scan_path, "scan");
  const TerrainInput terrain = read_terrain(terrain_path);
  Scans scans;
  scans.push_back(std::make_unique<ScanReader>(scan_path));
  const GridSpec grid = regrid_config(provenance.config, "config").grid;
  GriddedScans gridded = grid_scans(scans, {grid, Method::bilinear_nearest, true});
  gridded.slopes = slope_layer(*gridded.nearest);
  const PoseTrack poses({read_scan_poses(*scans.front())});
  gridded.uncertainty = std::make_unique<UncertaintyMap>(*gridded.nearest, *gridded.moments, gridded.slopes,
                                                         poses, UncertaintyParameters{.range_sigma_m = 0.02});
  const DemRequest request{.layers = {},
                           .truth = terrain.surface.get(),
                           .uncertainty = true,
                           .corrected = true,
                           .left_out = "nothing"};
  LandfallFileWriter file({path}, "dem", provenance);
  write_dem(file, gridded, request, scans.front()->crs_wkt());
}

void make_evaluation(const fs::path& path, const fs::path& dem_path) {
  Provenance provenance = provenance_of("dem-eval", "eval", {{"region_radius_m", 2}, {"footprint_m", 3}});
  add_input(provenance, "dem", dem_path, "dem");
  DemInput dem = read_dem(dem_path);
  EvaluationWriter writer({path}, provenance, dem.layers.z_est.spec(), dem.crs_wkt);
  const EvaluationParameters parameters = evaluation_config(provenance.config, "config");
  writer.finish(evaluate(std::move(dem.layers), parameters, {&writer}), parameters.limits);
}

/// With every layer: the terrain is its own truth, and has a sigma.
void make_hazards(const fs::path& path, const fs::path& terrain_path) {
  Provenance provenance = provenance_of("hazard-map", "hazard",
                                        {{"lander", {{"leg_radius_m", 2}, {"body_radius_m", 1}}},
                                         {"limits", {{"slope_deg", 30}, {"roughness_m", 1}}},
                                         {"sites", {{"separation_m", 1}}}});
  add_input(provenance, "terrain", terrain_path, "terrain");
  const HazardSource source = read_hazard_source(terrain_path, true);
  const GridSpec& spec = source.z.spec();
  HazardInput input{source.z, source.z, BinMask(spec), Grid<double>(spec, 0.05)};
  const HazardMap map = map_hazards(input, hazard_config(provenance.config),
                                    [](const std::string& /*name*/, const auto& part) { part({}); });
  LandfallFileWriter file({path}, "hazards", provenance);
  write_hazards(file, map, source.crs_wkt);
}

/// With every layer; the sums are of one error per bin and draw.
void make_draws(const fs::path& path) {
  Provenance provenance = provenance_of("monte-carlo", "draws", {{"draws", 2}});
  provenance.add_input("scan", "f00", Json::array());
  const auto spec = GridSpec::centered(3, 1, "draws");
  Draws draws;
  draws.maps.emplace(spec);
  draws.maps->draws = 2;
  for (std::size_t bin = 0; bin < spec.size(); ++bin)
    for (ErrorSums* const sums : {&draws.maps->e_z, &*draws.maps->e_map})
      for (const double error_m : {0.01, -0.02}) sums->add(bin, error_m);
  draws.region.emplace(spec);
  draws.map_truth.emplace(spec);
  draws.predicted_sigma.emplace(spec, 0.05F);
  draws.table = {0, {1, 1}, {0, 1}, {{"scan.noise.range_sigma_m", {0.01, 0.02}}}, {}, {0, 1}};
  for (const dictionary::Requirement& info : dictionary::kRequirements)
    draws.table.metrics.push_back({std::string("requirements.") + info.name + ".pass", {0, 1}});
  LandfallFileWriter file({path}, "draws", provenance);
  write_draws(file, draws, verdict_json(draws.table, std::nullopt), "");
}

void make_plan(const fs::path& path) {
  constexpr double kRadius_m = 3;
  const Provenance provenance = provenance_of("scan-sim", "scan", scan_json());
  const FlatTerrain ground;
  const Simulation simulation(model_of(provenance), &ground);
  const ScanPlan plan =
      plan_scan(simulation, circular_region(GridSpec::centered(3, 1, "plan"), kRadius_m), 1 << 12);
  LandfallFileWriter file({path}, "plan", provenance);
  write_plan(file, plan, summarize_plan(plan, {kRadius_m, 0.99}, 10));
}

/// A table without an attitude is none, so there is a quaternion.
void make_table(const fs::path& path) {
  h5::initialise();
  const h5::Handle file = h5::create_file(path);
  const auto add = [&](const char* name, const std::array<double, 3>& values) {
    const h5::Handle column =
        h5::create_dataset(file.get(), name, h5::Type::float64, {.size = {3}, .chunk = {}});
    H5Dwrite(column.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  };
  add("t_s", {0, 1, 2});
  add("x_m", {0, 1, 4});
  for (const char* const name : {"y_m", "z_m", "qx", "qy", "qz"}) add(name, {0, 0, 0});
  add("qw", {1, 1, 1});
}

/// Stores a table's column, but for those named, in one piece: chunks of 65536 rows take long to decode, and
/// one column of each type is enough of them.
void unchunk(hid_t group, const std::string& name) {
  const h5::Handle old(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  const h5::Handle type(H5Dget_type(old.get()), H5Tclose);
  const h5::Handle growing(H5Dget_space(old.get()), H5Sclose);
  const auto count = static_cast<hsize_t>(H5Sget_simple_extent_npoints(growing.get()));
  std::vector<std::byte> values(count * H5Tget_size(type.get()));
  H5Dread(old.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Ldelete(group, name.c_str(), H5P_DEFAULT);
  const h5::Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const h5::Handle plain(
      H5Dcreate2(group, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  if (H5Dwrite(plain.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw std::runtime_error("column " + name + " was not rewritten");
}

herr_t add_attribute(hid_t object, const char* name, const H5A_info_t*, void* list) {
  std::string path(static_cast<std::size_t>(H5Iget_name(object, nullptr, 0)) + 1, '\0');
  H5Iget_name(object, path.data(), path.size());
  path.pop_back();
  static_cast<LandfallFile*>(list)->attributes.emplace_back(path, name);
  return 0;
}

herr_t add_object(hid_t root, const char* name, const H5O_info_t*, void* list) {
  const std::string path = std::string(name) == "." ? "/" : "/" + std::string(name);
  static_cast<LandfallFile*>(list)->objects.push_back(path);
  const h5::Handle object(H5Oopen(root, path.c_str(), H5P_DEFAULT), H5Oclose);
  hsize_t next = 0;
  H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &next, add_attribute, list);
  return 0;
}

void unchunk_tables(hid_t file, const std::vector<std::string>& objects) {
  constexpr std::array kKept = {"/points/x_est", "/points/pulse", "/points/status",
                                "/pulses/t",     "/features/x",   "/features/kind",
                                "/sites/cost",   "/draws/seed",   "/state/e_z_sum"};
  for (const std::string& path : objects) {
    const bool in_table = path.starts_with("/points/") || path.starts_with("/pulses/") ||
                          path.starts_with("/detector/") || path.starts_with("/features/") ||
                          path.starts_with("/sites/") || path.starts_with("/draws/") ||
                          path.starts_with("/state/");
    if (in_table && std::find(kKept.begin(), kKept.end(), path) == kKept.end()) unchunk(file, path);
  }
}

std::vector<std::byte> bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

LandfallFile load(const char* kind, const fs::path& path) {
  LandfallFile result{kind, {}, bytes_of(path), {}, {}};
  h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, add_object, &result, H5O_INFO_BASIC);
  unchunk_tables(file.get(), result.objects);
  file.reset();
  result.bytes = bytes_of(path);
  return result;
}

struct Made {
  std::vector<LandfallFile> files;
  Provenance scan;
};

Made make() {
  const Folder folder;
  make_terrain(folder / "terrain.h5");
  make_mesh(folder / "mesh.h5");
  const Provenance scan = make_scan(folder / "scan.h5", folder / "terrain.h5");
  make_dem(folder / "dem.h5", folder / "scan.h5", folder / "terrain.h5");
  make_evaluation(folder / "eval.h5", folder / "dem.h5");
  make_hazards(folder / "hazards.h5", folder / "terrain.h5");
  make_draws(folder / "draws.h5");
  make_plan(folder / "plan.h5");
  make_table(folder / "table.h5");
  return {{load("terrain", folder / "terrain.h5"), load("mesh", folder / "mesh.h5"),
           load("scan", folder / "scan.h5"), load("dem", folder / "dem.h5"),
           load("evaluation", folder / "eval.h5"), load("plan", folder / "plan.h5"),
           load("table", folder / "table.h5"), load("hazards", folder / "hazards.h5"),
           load("draws", folder / "draws.h5")},
          scan};
}

const Made& made() {
  static const Made files = make();
  return files;
}

}  // namespace

const std::vector<LandfallFile>& landfall_files() { return made().files; }

const Provenance& scan_provenance() { return made().scan; }

}  // namespace landfall::fuzz
