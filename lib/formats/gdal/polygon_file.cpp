// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D402, D448
#include "formats/gdal/polygon_file.h"

#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "base/core/error.h"
#include "base/text/joined.h"
#include "formats/gdal/gdal_crs.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/known_crs.h"
#include "formats/gdal/registry.h"
#include "formats/gdal/site_relation.h"

namespace landfall {
namespace {

constexpr int kMaxVertices = 100'000;
constexpr const char* kToUseXy =
    "; for x and y of the DEM frame the file must have no CRS (GeoJSON: \"crs\": null), or give --same-frame";

/// Whether a GeoJSON has the member "crs": null, which GDAL reads as if it were not there.
bool declares_no_crs(const std::string& path) {
  GByte* bytes = nullptr;
  vsi_l_offset size = 0;
  if (VSIIngestFile(nullptr, path.c_str(), &bytes, &size, -1) == FALSE) return false;
  const std::unique_ptr<GByte, decltype(&VSIFree)> owner(bytes, VSIFree);
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  constexpr std::string_view kKey = "\"crs\"";
  constexpr const char* kBlanks = " \t\r\n";
  for (std::size_t at = text.find(kKey); at != std::string::npos; at = text.find(kKey, at + 1)) {
    const std::size_t colon = text.find_first_not_of(kBlanks, at + kKey.size());
    if (colon == std::string::npos || text[colon] != ':') continue;
    const std::size_t value = text.find_first_not_of(kBlanks, colon + 1);
    if (value != std::string::npos && text.compare(value, 4, "null") == 0) return true;
  }
  return false;
}

class Reader {
 public:
  Reader(const PolygonFileRequest& request, GdalErrors& errors) : request_(request), errors_(errors) {}

  PolygonFile read() {
    open();
    OGRLayer& layer = chosen_layer();
    set_transformation(layer.GetSpatialRef());
    for (const auto& feature : layer) add(feature->GetGeometryRef());
    if (errors_.any()) fail("cannot be read: " + errors_.reason());
    if (file_.polygons.empty()) fail("holds no polygon");
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw FormatError(request_.path + ": " + why); }

  void open() {
    if (!std::filesystem::is_regular_file(request_.path)) fail("no such file");
    prepare_gdal_to_read_polygons();
    dataset_.reset(GDALDataset::Open(request_.path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                     polygon_drivers(), nullptr, nullptr));
    if (!dataset_)
      fail("is not a file of polygons of a known format" + (errors_.any() ? ": " + errors_.reason() : ""));
  }

  [[nodiscard]] bool is_json_without_crs() const {
    return std::string(dataset_->GetDriverName()).find("JSON") != std::string::npos &&
           declares_no_crs(request_.path);
  }

  [[nodiscard]] std::string layer_names() const {
    return joined(dataset_->GetLayers(), ", ", [](OGRLayer* layer) { return layer->GetName(); });
  }

  [[nodiscard]] OGRLayer& chosen_layer() const {
    if (!request_.layer.empty()) {
      OGRLayer* const named = dataset_->GetLayerByName(request_.layer.c_str());
      if (named == nullptr) fail("has no layer '" + request_.layer + "'; its layers: " + layer_names());
      return *named;
    }
    if (dataset_->GetLayerCount() == 0) fail("holds no polygon");
    if (dataset_->GetLayerCount() > 1) fail("has several layers; choose one by layer: " + layer_names());
    return *dataset_->GetLayer(0);
  }

  void set_transformation(const OGRSpatialReference* crs) {
    if (request_.same_frame) return;
    require_known_crs(crs, request_.path, errors_, "assign it one that is, or give --same-frame");
    if (crs == nullptr || crs->IsLocal() != 0 || is_json_without_crs()) {
      file_.assumed.emplace_back("has no CRS: its coordinates are x and y of the DEM frame");
      return;
    }
    if (crs->IsGeocentric() != 0) fail("its CRS is geocentric, not a map");
    const std::string name = crs->GetName() != nullptr ? crs->GetName() : "unnamed";
    const std::string its = "its coordinates are those of a map (" + name + ")";
    site_ = crs_to_export(request_.site_wkt);
    if (site_.IsProjected() == 0) fail(its + ", and the DEM has none" + kToUseXy);
    source_ = *crs;
    source_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    transformation_.reset(OGRCreateCoordinateTransformation(&source_, &site_));
    if (!transformation_)
      fail(its + ", which cannot be converted to the DEM's: " + errors_.reason() + kToUseXy);
    if (std::string shift = datum_shift(source_, site_); !shift.empty())
      file_.assumed.push_back(std::move(shift));
  }

  void add(const OGRGeometry* geometry) {
    if (geometry == nullptr || geometry->IsEmpty() != 0) fail("holds an empty geometry");
    const std::unique_ptr<OGRGeometry> straight(geometry->getLinearGeometry());
    const std::unique_ptr<OGRGeometry> in_file(straight->clone());
    if (transformation_ && straight->transform(transformation_.get()) != OGRERR_NONE)
      fail("a vertex has no place in the DEM frame: " + errors_.reason());
    add_parts(*straight);
    require_valid(*in_file);
  }

  /// For the coordinates of the file: a transformation may move vertices that touch an edge across it.
  void require_valid(const OGRGeometry& geometry) const {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection))
      for (const OGRGeometry* part : *geometry.toGeometryCollection()) require_valid(*part);
    const GdalErrors reasons;
    if ((type == wkbPolygon || type == wkbTriangle) && !geometry.IsValid())
      fail("its polygon is not valid: " + reasons.last_warning() + "; ogr2ogr -makevalid can correct it");
  }

  void add_parts(const OGRGeometry& geometry) {
    const OGRwkbGeometryType type = wkbFlatten(geometry.getGeometryType());
    if (type == wkbPolygon || type == wkbTriangle) return add_polygon(*geometry.toPolygon());
    if (!OGR_GT_IsSubClassOf(type, wkbGeometryCollection))
      fail(std::string("holds a ") + geometry.getGeometryName() + "; only polygons make a region");
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) add_parts(*part);
  }

  void add_polygon(const OGRPolygon& polygon) {
    std::vector<Polygon::Ring> rings;
    for (const OGRLinearRing* ring : polygon) {
      if (transformation_ && !(ring->get_Area() > 0))
        fail("a ring of " + std::to_string(ring->getNumPoints()) +
             " vertices has no area in the DEM frame, which does not hold what reaches around the body");
      rings.push_back(ring_of(*ring));
    }
    file_.polygons.emplace_back(std::move(rings));
    require_simple(file_.polygons.back(), request_.path);
  }

  /// Without the last vertex, which repeats the first.
  Polygon::Ring ring_of(const OGRLinearRing& ring) {
    vertices_ += ring.getNumPoints();
    if (vertices_ > kMaxVertices) fail("has more than 100,000 vertices; simplify it (ogr2ogr -simplify)");
    Polygon::Ring vertices;
    for (int i = 0; i < ring.getNumPoints(); ++i) vertices.push_back({ring.getX(i), ring.getY(i)});
    if (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
    return vertices;
  }

  struct DestroyTransformation {
    void operator()(OGRCoordinateTransformation* t) const { OGRCoordinateTransformation::DestroyCT(t); }
  };

  const PolygonFileRequest& request_;
  GdalErrors& errors_;
  GDALDatasetUniquePtr dataset_;
  OGRSpatialReference site_, source_;
  std::unique_ptr<OGRCoordinateTransformation, DestroyTransformation> transformation_;
  PolygonFile file_;
  int vertices_ = 0;
};

}  // namespace

PolygonFile read_polygons(const PolygonFileRequest& request) {
  GdalErrors errors;
  return Reader(request, errors).read();
}

}  // namespace landfall
