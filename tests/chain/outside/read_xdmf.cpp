// SPDX-License-Identifier: GPL-3.0-or-later
// usage: read_xdmf FILE: what the Xdmf project's own library (Debian's libxdmf-dev) reads of the first grid,
// a line of name and numbers each: `points` and `row` of points, or `origin`, `step` and `size` of a grid
// (slowest first), then every attribute.
#include <XdmfArray.hpp>
#include <XdmfAttribute.hpp>
#include <XdmfDomain.hpp>
#include <XdmfGeometry.hpp>
#include <XdmfReader.hpp>
#include <XdmfRegularGrid.hpp>
#include <XdmfTopology.hpp>
#include <XdmfUnstructuredGrid.hpp>
#include <cstdio>
#include <string>

namespace {

void print(const std::string& name, const shared_ptr<XdmfArray>& values) {
  values->read();
  std::printf("%s", name.c_str());
  for (unsigned i = 0; i < values->getSize(); ++i) std::printf(" %.17g", values->getValue<double>(i));
  std::printf("\n");
}

void print_attributes(XdmfGrid& grid) {
  for (unsigned i = 0; i < grid.getNumberAttributes(); ++i)
    print(grid.getAttribute(i)->getName(), grid.getAttribute(i));
}

void print_points(XdmfUnstructuredGrid& points) {
  print("points", points.getGeometry());
  print("row", points.getTopology());
  print_attributes(points);
}

void print_grid(XdmfRegularGrid& grid) {
  print("origin", grid.getOrigin());
  print("step", grid.getBrickSize());
  print("size", grid.getDimensions());
  print_attributes(grid);
}

}  // namespace

int main(int /*argc*/, char** argv) {
  const auto domain = shared_dynamic_cast<XdmfDomain>(XdmfReader::New()->read(argv[1]));
  if (domain->getNumberUnstructuredGrids() > 0)
    print_points(*domain->getUnstructuredGrid(0));
  else
    print_grid(*domain->getRegularGrid(0));
}
