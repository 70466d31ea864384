// SPDX-License-Identifier: GPL-3.0-or-later
// Positions of points in an .xmf are a virtual dataset of N x 3 in a small file next to it. Only
// ParaView's older library reads three columns as positions (`X_Y_Z`); a copy would cost 24 bytes per
// point. Vertices are written explicitly (`/row`), because meshio needs them. `/position` is float64
// unless all three columns are float32.
#include "app/exports/xdmf.h"

#include <algorithm>

#include "base/text/number_text.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

/// Escapes a text for XML.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string number_type(h5::Type type) {
  switch (type) {
    case h5::Type::int8:
      return R"(NumberType="Char" Precision="1")";
    case h5::Type::int32:
      return R"(NumberType="Int" Precision="4")";
    case h5::Type::int64:
      return R"(NumberType="Int" Precision="8")";
    case h5::Type::float32:
      return R"(NumberType="Float" Precision="4")";
    default:
      return R"(NumberType="Float" Precision="8")";
  }
}

/// The XML of a dataset in the file.
std::string data_item(const ContentInfo& info, const std::string& dimensions, const std::string& path) {
  return "<DataItem Dimensions=\"" + dimensions + "\" " + number_type(info.type) + " Format=\"HDF\">" +
         escaped(path + info.name) + "</DataItem>";
}

std::string attribute(const ContentInfo& info, const std::string& dimensions, const std::string& path) {
  return "      <Attribute Name=\"" + info.name + "\" AttributeType=\"Scalar\" Center=\"Node\">\n        " +
         data_item(info, dimensions, path) + "\n      </Attribute>\n";
}

std::string document(const std::string& name, const std::string& content) {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"" +
         name + "\" GridType=\"Uniform\">\n" + content + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

/// Formats three numbers, given x first; XDMF needs the slowest dimension first.
std::string triple(const char* what, double x, double y, double z) {
  return std::string("        <DataItem Name=\"") + what +
         "\" Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">" + number_text(z) + " " +
         number_text(y) + " " + number_text(x) + "</DataItem>\n";
}

}  // namespace

std::string xdmf_reference(const fs::path& data, const fs::path& xdmf) {
  const fs::path target = fs::weakly_canonical(fs::absolute(data));
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(xdmf).parent_path());  // an output replaces a symbolic link
  const fs::path relative = target.lexically_relative(folder);
  return relative.empty() || *relative.begin() == ".." ? target.string() : relative.string();
}

fs::path xdmf_positions(const fs::path& xdmf) { return xdmf.string() + ".h5"; }

PointPositions positions_of(const PointReader& points, const std::string& position, const std::string& scan) {
  PointPositions positions{scan, {}, h5::Type::float32, points.row_count(), points.file().file_id()};
  std::ranges::copy(position_columns(position), positions.columns.begin());
  for (const std::string& column : positions.columns)
    if (points.column(column).type == h5::Type::float64) positions.type = h5::Type::float64;
  return positions;
}

std::string points_xdmf(const std::vector<ContentInfo>& columns, const PointPositions& positions,
                        const std::string& positions_file) {
  const std::string count = std::to_string(positions.rows);
  const std::string root = positions_file + ":/";
  std::string content = "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"" + count +
                        "\" NodesPerElement=\"1\">\n        " +
                        data_item({"row", row_type(positions.rows), "", ""}, count + " 1", root) +
                        "\n      </Topology>\n      <Geometry GeometryType=\"XYZ\">\n        " +
                        data_item({"position", positions.type, "", ""}, count + " 3", root) +
                        "\n      </Geometry>\n";
  for (const ContentInfo& column : columns) content += attribute(column, count, positions.scan + ":/points/");
  return document("points", content);
}

std::string grid_xdmf(const std::vector<ContentInfo>& layers, const GridSpec& spec,
                      const std::string& reference) {
  const std::string dimensions = std::to_string(spec.rows) + " " + std::to_string(spec.cols);
  std::string content =
      "      <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"1 " + dimensions +
      "\"/>\n      <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n" + triple("origin", spec.x(0), spec.y(0), 0) +
      triple("spacing", spec.resolution_m, spec.resolution_m, spec.resolution_m) + "      </Geometry>\n";
  for (const ContentInfo& layer : layers) content += attribute(layer, "1 " + dimensions, reference + ":/");
  return document("grid", content);
}

}  // namespace landfall
