// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh/mesh_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/core/error.h"
#include "bins.h"
#include "chain/terrain/mesh/triangle_mesh.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "constants.h"
#include "refusal.h"
#include "store/files/provenance.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MeshFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("landfall-mesh-") + test->name());
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  /// The message about such a file, without its folder.
  [[nodiscard]] std::string refusal(const std::string& name, const std::string& bytes) const {
    return refusal_of(write(name, bytes));
  }
  [[nodiscard]] std::string refusal_of(const fs::path& path) const {
    const std::string what = landfall::refusal<FormatError>(
        [&] { return clean_mesh(read_mesh_file(path).soup, {}, path.string()); });
    const std::string prefix = path.string() + ": ";
    return what.starts_with(prefix) ? what.substr(prefix.size()) : "no name: " + what;
  }

  fs::path folder_;
};

template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

// A tetrahedron with a quad's worth of each format's oddities.
const std::vector<Eigen::Vector3d> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.5}};
const std::vector<std::uint32_t> kFacets = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

void expect_tetrahedron(const PolygonSoup& soup) {
  EXPECT_EQ(soup.points, kCorners);
  EXPECT_EQ(soup.corners, kFacets);
  EXPECT_EQ(soup.polygon_ends, (std::vector<std::size_t>{3, 6, 9, 12}));
}

TEST_F(MeshFileTest, Obj) {
  const fs::path path = write("T.OBJ",
                              "# comment\r\nmtllib missing.mtl\r\no body\r\nv 0 0 0\r\nv +1 0 0 1.0\r\n"
                              "vt 0 0\r\nvn 0 0 1\r\nv 0\t1e0 0 0.5 0.5 0.5\r\nv 0 0 1.5\r\nusemtl x\r\n"
                              "f 1/1 3/1 2/1\r\nf 1//1\t2//1\t4//1 # last\r\nf -3/1/1 -2/1/1 -1/1/1\r\n"
                              "g a b\r\nf 1 4 3");
  const MeshFile file = read_mesh_file(path);
  expect_tetrahedron(file.soup);
  EXPECT_EQ(file.content_id, content_id(path));
}

TEST_F(MeshFileTest, ABackslashJoinsLinesOfObj) {
  const fs::path path = write("t.obj",
                              "# no more \\\nv 0 0 \\\n0\nv 1\\\r\n 0 0\nv 0 1 0\nv 0 0 1.5 \\\n1 1 1\n"
                              "f 1 3\\\n2\nf 1 2 \\\n \\\n4\nf 2 3 4\nf 1 4 3 \\");
  EXPECT_THAT(refusal_of(path), ::testing::HasSubstr("line 15: '\\' is not an integer"));
  std::string text;
  std::getline(std::ifstream(path), text, '\0');
  text.erase(text.size() - 2);
  expect_tetrahedron(read_mesh_file(write("t.obj", text)).soup);
}

TEST_F(MeshFileTest, CommentsBeforeOff) {
  expect_tetrahedron(
      read_mesh_file(write("t.off",
                           "# made by hand\n\n# twice\nOFF # here\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n"
                           "0 0 1.5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"))
          .soup);
}

TEST_F(MeshFileTest, Off) {
  const std::string body =
      "# comment\n\n4 4 0\n0 0 0\n1 0 0 255 0 0\n# between\n0 1 0\n0 0 1.5\n"
      "3 0 2 1\n3 0 1 3 255 0 0\n3 1 2 3\n3 0 3 2\n";
  for (const char* const keyword : {"OFF\n", "COFF\n", "OFF "})
    expect_tetrahedron(read_mesh_file(write("t.off", keyword + body)).soup);
}

std::string ascii_stl() {
  std::string text = "solid any name\n";
  for (std::size_t i = 0; i < kFacets.size(); i += 3) {
    text += "facet normal 0 0 nan\n outer loop\n";
    for (std::size_t k = i; k < i + 3; ++k) {
      const Eigen::Vector3d& p = kCorners[kFacets[k]];
      text += "  vertex " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " +
              std::to_string(p.z()) + "\n";
    }
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid any name\n";
}

std::string binary_stl(const std::string& comment) {
  std::string bytes = comment + std::string(80 - comment.size(), ' ') + bytes_of(std::uint32_t{4});
  for (std::size_t i = 0; i < kFacets.size(); i += 3) {
    bytes += std::string(12, '\0');
    for (std::size_t k = i; k < i + 3; ++k)
      for (const double coordinate : kCorners[kFacets[k]]) bytes += bytes_of(static_cast<float>(coordinate));
    bytes += std::string(2, '\7');
  }
  return bytes;
}

std::string in_capitals(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

TEST_F(MeshFileTest, Stl) {
  for (const std::string& bytes :
       {ascii_stl(), in_capitals(ascii_stl()), binary_stl("any"), binary_stl("solid, but binary")}) {
    const CleanMesh mesh = clean_mesh(read_mesh_file(write("t.stl", bytes)).soup, {}, "t");
    EXPECT_EQ(mesh.mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.welded_vertex_count, 8U);
    ASSERT_EQ(mesh.mesh.triangles.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(mesh.mesh.corners(i)[k], kCorners[kFacets[3 * i + k]]);
  }
}

std::string ply_header(const std::string& format, const std::string& faces = "4") {
  return "ply\nformat " + format + " 1.0\ncomment x\nelement camera 1\nproperty float f\nelement vertex 4\n" +
         "property uchar red\nproperty double x\nproperty float y\nproperty double z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nproperty short flags\nend_header\n";
}

std::string ascii_ply() {
  return ply_header("ascii") +
         "2.5\n9 0 0 0\n9 1 0 0\n9 0 1 0\n9 0 0 1.5\n3 0 2 1 7\n3 0 1 3 7\n3 1 2 3 7\n3 0 3 2 7\n";
}

std::string binary_ply(bool big) {
  std::string bytes = ply_header(big ? "binary_big_endian" : "binary_little_endian") + bytes_of(2.5F, big);
  for (const Eigen::Vector3d& p : kCorners)
    bytes += bytes_of(std::uint8_t{9}) + bytes_of(p.x(), big) + bytes_of(static_cast<float>(p.y()), big) +
             bytes_of(p.z(), big);
  for (std::size_t i = 0; i < kFacets.size(); i += 3) {
    bytes += bytes_of(std::uint8_t{3});
    for (std::size_t k = i; k < i + 3; ++k) bytes += bytes_of(kFacets[k], big);
    bytes += bytes_of(std::int16_t{7}, big);
  }
  return bytes;
}

TEST_F(MeshFileTest, Ply) {
  for (const std::string& bytes : {ascii_ply(), binary_ply(false), binary_ply(true)})
    expect_tetrahedron(read_mesh_file(write("t.ply", bytes)).soup);
}

TEST_F(MeshFileTest, RefusesWhatIsNoFileOrNoMesh) {
  EXPECT_EQ(refusal_of(folder_ / "none.obj"), "no such file");
  fs::create_directory(folder_ / "folder.obj");
  EXPECT_EQ(refusal_of(folder_ / "folder.obj"), "is a directory");
  ASSERT_EQ(mkfifo((folder_ / "pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(refusal_of(folder_ / "pipe.ply"), "is not a regular file");
  EXPECT_EQ(refusal("t", ""), "'' is not a supported mesh format: use .obj, .ply, .off, .stl or .tab");
  for (const char* const name : {"t.obj", "t.ply", "t.off", "t.stl", "t.tab"}) {
    EXPECT_NE(refusal(name, ""), "accepted");
    EXPECT_NE(refusal(name, std::string(4096, '\0')), "accepted");
    EXPECT_NE(refusal(name, std::string(4096, '\xff')), "accepted");
  }
}

TEST_F(MeshFileTest, RefusesBadObj) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(refusal("t.obj", points + "f -4 1 2\n"), HasSubstr("line 4: a facet names vertex number -1"));
  EXPECT_THAT(refusal("t.obj", points + "f 1 2 99999999999\n"), HasSubstr("names vertex number 99999999998"));
  EXPECT_EQ(refusal("t.obj", points + "f 1 2 99999999999999999999\n"),
            "line 4: '99999999999999999999' is not an integer");
  EXPECT_THAT(refusal("t.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(refusal("t.obj", "v 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              HasSubstr("vertex 1 is not finite"));
}

TEST_F(MeshFileTest, RefusesBadOffAndStl) {
  EXPECT_EQ(refusal("t.off", "OFF\n4000000000000 1 0\n0 0 0\n"), "line 4: ends before its last vertex");
  EXPECT_EQ(refusal("t.off", "OFF\n1 1 0\n0 0 0\n4000000000 0 0\n"), "line 4: '' is not an integer");
  for (const char* const keyword : {"4OFF", "nOFF", "C4OFF", "STCN4OFF"})
    EXPECT_THAT(refusal("t.off", std::string(keyword) + "\n"), HasSubstr("in 4 or n dimensions")) << keyword;
  EXPECT_THAT(refusal("t.off", "8 6 12\n"), HasSubstr("it begins with '8'"));
  std::string huge = binary_stl("any");
  huge.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(refusal("t.stl", huge),
            "a binary STL file of 4294967295 facets, but there are 284 bytes, enough for 4");
  EXPECT_EQ(refusal("t.stl", "solid x\nendsolid\n"), "has no facet with an area");
  EXPECT_EQ(refusal("t.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n"),
            "line 5: 'endloop' where 'vertex' belongs");
}

TEST_F(MeshFileTest, RefusesBadPly) {
  EXPECT_THAT(refusal("t.ply", ply_header("binary_little_endian", "4000000000000")),
              HasSubstr("elements 'camera', more than the file has left"));
  std::string claims = binary_ply(false);
  claims.replace(claims.find("face 4"), 6, "face 999999999999");
  EXPECT_THAT(refusal("t.ply", claims),
              HasSubstr("999999999999 elements 'face', more than the file has left"));
  std::string list = ply_header("ascii");
  list.replace(list.find("list uchar"), 10, "list int");
  EXPECT_THAT(refusal("t.ply", list + "1\n9 0 0 0\n9 1 0 0\n9 0 1 0\n9 0 0 1\n2000000000 1 2 3"),
              HasSubstr("more than the file has left"));
  for (const bool big : {false, true}) {
    const std::string whole = binary_ply(big);
    for (std::size_t size = 0; size < whole.size(); ++size)
      ASSERT_NE(refusal("t.ply", whole.substr(0, size)), "accepted") << size;
  }
}

std::string with_line_ends(std::string text, const std::string& end) {
  std::size_t at = 0;
  while ((at = text.find('\n', at)) != std::string::npos) {
    text.replace(at, 1, end);
    at += end.size();
  }
  return text;
}

const std::string kObj =
    "# tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1.5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const std::string kOff =
    "OFF\n# tetrahedron\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1.5\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

TEST_F(MeshFileTest, LinesEndWithLfCrLfOrCr) {
  for (const char* const end : {"\n", "\r\n", "\r"})
    for (const char* const mark : {"", "\xEF\xBB\xBF"}) {
      const auto soup = [&](const char* name, const std::string& text) {
        return read_mesh_file(write(name, mark + with_line_ends(text, end))).soup;
      };
      expect_tetrahedron(soup("t.obj", kObj));
      expect_tetrahedron(soup("t.tab", kObj));
      expect_tetrahedron(soup("t.off", kOff));
      expect_tetrahedron(soup("t.ply", ascii_ply()));
      EXPECT_EQ(soup("t.stl", ascii_stl()).polygon_ends.size(), 4U);
    }
  EXPECT_THAT(refusal("t.obj", with_line_ends(kObj, "\r") + "x"), HasSubstr("line 10: 'x'"));
}

// The camera's number has a line feed as its first byte (little-endian): a header that ends its lines with CR
// alone must not take it as the second half of its last line end.
TEST_F(MeshFileTest, HeadersOfBinaryPlyEndTheirLinesInAnyWay) {
  for (const bool big : {false, true})
    for (const char* const end : {"\n", "\r\n", "\r"}) {
      std::string bytes = binary_ply(big);
      const std::size_t header = bytes.find("end_header\n") + 11;
      bytes.replace(header, 4, bytes_of(std::bit_cast<float>(0x41200A0AU)));
      expect_tetrahedron(
          read_mesh_file(write("t.ply", with_line_ends(bytes.substr(0, header), end) + bytes.substr(header)))
              .soup);
    }
}

TEST_F(MeshFileTest, ReadsEverySolidOfAnStl) {
  const PolygonSoup soup =
      read_mesh_file(write("t.stl", ascii_stl() + "\n\n" + in_capitals(ascii_stl()))).soup;
  EXPECT_EQ(soup.polygon_ends.size(), 8U);
  EXPECT_EQ(read_mesh_file(write("t.stl", "solid\nendsolid\n" + ascii_stl())).soup.polygon_ends.size(), 4U);
  EXPECT_THAT(refusal("t.stl", ascii_stl() + "facet"), HasSubstr("'facet' where 'solid' belongs"));
  EXPECT_THAT(refusal("t.stl", ascii_stl() + "solid two\n"), HasSubstr("ends before 'endsolid'"));
}

TEST_F(MeshFileTest, ReadsPolygonsOfAnStl) {
  const PolygonSoup soup =
      read_mesh_file(write("t.stl",
                           "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
                           "vertex 0 1 0\nendloop\nendfacet\nendsolid\n"))
          .soup;
  EXPECT_EQ(soup.polygon_ends, std::vector<std::size_t>{4});
}

TEST_F(MeshFileTest, RefusesTrailingBytesOfAnStl) {
  EXPECT_THAT(refusal("t.stl", binary_stl("any") + "x"), HasSubstr("of 4 facets, but there are 285 bytes"));
  EXPECT_THAT(refusal("t.stl", binary_stl("solid, but binary") + "x"),
              HasSubstr("of 4 facets, but there are 285 bytes"));
  EXPECT_THAT(refusal("t.stl", binary_stl("solid, but binary").substr(0, 200)),
              HasSubstr("of 4 facets, but there are 200 bytes"));
}

std::string ply_of_strips(const std::string& format, const std::string& faces) {
  return "ply\nformat " + format + " 1.0\nelement vertex 6\nproperty double x\nproperty double y\n" +
         "property double z\n" + faces +
         "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
}

// Corners at (k, k mod 2, 0): every second triangle of a strip is turned so that all face up.
TEST_F(MeshFileTest, ReadsTriangleStrips) {
  std::string text = ply_of_strips("ascii", "");
  std::string bytes = ply_of_strips("binary_little_endian", "");
  for (int k = 0; k < 6; ++k) {
    text += std::to_string(k) + " " + std::to_string(k % 2) + " 0\n";
    for (const double value : {1.0 * k, 1.0 * (k % 2), 0.0}) bytes += bytes_of(value);
  }
  const std::vector<int> strips = {0, 2, 1, -1, 1, 2, 3, 4, -1, 5, 3, 4, -1};
  bytes += bytes_of(static_cast<int>(strips.size()));
  text += std::to_string(strips.size());
  for (const int corner : strips) {
    text += " " + std::to_string(corner);
    bytes += bytes_of(corner);
  }
  for (const std::string& file : {text, bytes}) {
    const PolygonSoup soup = read_mesh_file(write("t.ply", file)).soup;
    EXPECT_EQ(soup.corners, (std::vector<std::uint32_t>{0, 2, 1, 1, 2, 3, 3, 2, 4, 5, 3, 4}));
    EXPECT_EQ(soup.polygon_ends, (std::vector<std::size_t>{3, 6, 9, 12}));
  }
  const std::string head = text.substr(0, text.rfind("13 "));
  EXPECT_THAT(refusal("t.ply", head + "3 0 1 -2\n"), HasSubstr("vertex number -2"));
}

TEST_F(MeshFileTest, NamesOtherElementsOfAPly) {
  EXPECT_THAT(read_mesh_file(write("t.ply", ascii_ply())).soup.unread,
              testing::ElementsAre("element 'camera' (1)"));
  for (const char* const name : {"edge", "range_grid", "point"}) {
    std::string text = ascii_ply();
    text.replace(text.find("camera"), 6, name);
    EXPECT_THAT(refusal("t.ply", text), HasSubstr("has element '" + std::string(name) + "' (count 1)"));
    text.replace(text.find(" 1\n", text.find(name)), 3, " 0\n");
    text.erase(text.find("2.5\n"), 4);
    expect_tetrahedron(read_mesh_file(write("t.ply", text)).soup);
  }
}

TEST_F(MeshFileTest, RefusesElementsThatDoNotFitThePlyHeader) {
  std::string other = ascii_ply();
  other.replace(other.find("vertex_indices"), 14, "corner_indices");
  EXPECT_THAT(refusal("t.ply", other), HasSubstr("its element 'face' has no list vertex_indices"));
  std::string line = ascii_ply();
  line.replace(line.rfind("3 0 3 2 7"), 9, "2 0 3 7");
  EXPECT_THAT(refusal("t.ply", line), HasSubstr("a facet of 2 corners"));
}

TEST_F(MeshFileTest, RefusesOtherElementsOfAnObj) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(refusal("t.obj", points + "p 1\n"), HasSubstr("line 5: a point element 'p'"));
  for (const char* const keyword : {"cstype", "curv", "curv2", "surf", "vp", "end"})
    EXPECT_THAT(refusal("t.obj", points + keyword + " 1\n"), HasSubstr("' is free-form geometry")) << keyword;
  EXPECT_THAT(refusal("t.obj", points + "vertex 1 2 3\n"),
              HasSubstr("line 5: 'vertex' is not an OBJ keyword"));
  EXPECT_THAT(refusal("t.obj", points + "v 1 2 3 4 5 6 7 8\n"), HasSubstr("a vertex of 8 numbers"));
  EXPECT_THAT(refusal("t.obj", points + "v 1 2 3 a\n"), HasSubstr("'a' is not a number"));
}

TEST_F(MeshFileTest, RefusesOffThatDoesNotFitItsCounts) {
  EXPECT_THAT(refusal("t.off", "OFF\n2 1 0\n0 0 0 1 0 0 0\n"), HasSubstr("ends before its last vertex"));
  EXPECT_THAT(refusal("t.off", "NOFF\n1 1 0\n0 0 0\n"), HasSubstr("a vertex of 3 numbers"));
  EXPECT_THAT(refusal("t.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n"),
              HasSubstr("a facet of 2 corners"));
  expect_tetrahedron(read_mesh_file(write("t.off", kOff + "# the end\n\n")).soup);
}

TEST_F(MeshFileTest, RefusesOtherTables) {
  EXPECT_THAT(refusal("t.tab", "!table\n!version 300\n"),
              HasSubstr("begins with '!table'; a .tab is read as a shape"));
  EXPECT_THAT(refusal("t.tab", "1348 2692\n1 0 0 0\n"), HasSubstr("begins with '1348'"));
  EXPECT_THAT(refusal("t.tab", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"),
              HasSubstr("vertex 0; OBJ counts from 1"));
}

TEST_F(MeshFileTest, NamesOtherKindsOfContent) {
  std::string utf16 = "\xFF\xFE";
  for (const char c : kObj) utf16 += {c, '\0'};
  for (const char* const name : {"t.obj", "t.off", "t.ply", "t.stl", "t.tab"}) {
    EXPECT_EQ(refusal(name, utf16), "is UTF-16 text: save it as UTF-8") << name;
    EXPECT_EQ(refusal(name, "\x1F\x8B\x08 and so on"), "is compressed by gzip: unpack it with gunzip")
        << name;
    EXPECT_THAT(refusal(name, "PK\x03\x04 and so on"), HasSubstr("is a zip archive")) << name;
  }
}

// NaN nodes: one lonely corner node, one hole in the middle.
TriangulatedGrid grid_with_holes() {
  Grid<double> nodes(GridSpec::centered(1.5, 0.5));
  for (const auto [r, c] : Bins({0, 0}, {7, 7}))
    nodes.at({r, c}) = 0.1 * static_cast<double>(r * r) - 1.0 / 3 * static_cast<double>(c);
  nodes.at({3, 3}) = kNan;
  nodes.at({0, 1}) = kNan;
  nodes.at({1, 0}) = kNan;
  return TriangulatedGrid(std::move(nodes));
}

TEST_F(MeshFileTest, WritesAGridsTriangles) {
  const TriangulatedGrid grid = grid_with_holes();
  std::vector<std::array<Eigen::Vector3d, 3>> expected;
  for (std::size_t i = 0; i < grid.triangle_count(); ++i)
    if (const auto t = grid.triangle(i); t[0].allFinite() && t[1].allFinite() && t[2].allFinite())
      expected.push_back(t);
  for (const char* const name : {"out.obj", "out.ply"}) {
    write_mesh_file({folder_ / name}, grid);
    const CleanMesh back = clean_mesh(read_mesh_file(folder_ / name).soup, {}, name);
    EXPECT_EQ(back.unreferenced_vertex_count + back.welded_vertex_count + back.degenerate_facet_count, 0U);
    EXPECT_EQ(back.mesh.vertices.size(), 49U - 4U);
    ASSERT_EQ(back.mesh.triangles.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(back.mesh.corners(i), expected[i]);
  }
}

TEST_F(MeshFileTest, WritesAMeshAsItIs) {
  const IndexedTriangles mesh{{{0, 0.1, 1e-20}, {1.0 / 3, 0, 0}, {0, 1, 0}, {0, 0, 1e9}},
                              {{0, 2, 1}, {0, 1, 3}}};
  for (const char* const name : {"out.obj", "out.ply"}) {
    write_mesh_file({folder_ / name}, mesh);
    const PolygonSoup soup = read_mesh_file(folder_ / name).soup;
    EXPECT_EQ(soup.points, mesh.vertices);
    EXPECT_EQ(soup.corners, (std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3}));
  }
}

TEST_F(MeshFileTest, WritingLeavesNoHalfFile) {
  const fs::path old = write("old.ply", "old");
  const TriangulatedGrid holes(Grid<double>(GridSpec::centered(1, 1), kNan));
  EXPECT_THROW(write_mesh_file({old}, grid_with_holes()), UsageError);
  EXPECT_THROW(write_mesh_file({old, true}, holes), FormatError);
  EXPECT_EQ(fs::file_size(old), 3U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
  write_mesh_file({old, true}, grid_with_holes());
  EXPECT_GT(fs::file_size(old), 100U);
}

}  // namespace
}  // namespace landfall
