// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A header of points with a normal of three values, which is not read, and padding.
std::string pcd_header(const std::string& form, const std::string& points = "POINTS 2\n") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x normal y _ z intensity\nSIZE 4 4 8 1 4 2\nTYPE F F F U F U\n"
         "COUNT 1 3 1 2 1 1\nWIDTH 2\nHEIGHT 1\n" +
         points + "DATA " + form + "\n";
}

/// Field after field, each of both points.
std::string pcd_columns() {
  std::string bytes;
  for (const float x : {1.5F, 2.5F}) put(bytes, x);
  bytes += std::string(24, '\x7f');
  for (const double y : {0.1, 0.2}) put(bytes, y);
  bytes += std::string(4, '\x7f');
  for (const float z : {-1.0F, -2.0F}) put(bytes, z);
  for (const int intensity : {7, 65535}) put(bytes, static_cast<std::uint16_t>(intensity));
  return bytes;
}

std::string pcd_rows() {
  std::string bytes;
  for (const int i : {0, 1}) {
    put(bytes, 1.5F + static_cast<float>(i));
    bytes += std::string(12, '\x7f');
    put(bytes, i == 0 ? 0.1 : 0.2);
    bytes += std::string(2, '\x7f');
    put(bytes, -1.0F - static_cast<float>(i));
    put(bytes, static_cast<std::uint16_t>(i == 0 ? 7 : 65535));
  }
  return bytes;
}

/// LibLZF: runs of up to 32 literal bytes.
std::string lzf_literals(const std::string& bytes) {
  std::string packed;
  for (std::size_t at = 0; at < bytes.size(); at += 32) {
    const std::string run = bytes.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

std::string pcd_compressed(const std::string& packed, std::uint32_t unpacked) {
  std::string bytes = pcd_header("binary_compressed");
  put(bytes, static_cast<std::uint32_t>(packed.size()));
  put(bytes, unpacked);
  return bytes + packed;
}

void expect_both_points(const std::string& bytes) {
  const WholeCloud cloud = read_cloud("a.pcd", bytes, {}, 2);
  EXPECT_THAT(cloud[CloudField::x], ElementsAre(1.5, 2.5));
  EXPECT_THAT(cloud[CloudField::y], ElementsAre(0.1, 0.2));
  EXPECT_THAT(cloud[CloudField::z], ElementsAre(-1, -2));
  EXPECT_THAT(cloud[CloudField::intensity], ElementsAre(7, 65535));
  EXPECT_EQ(cloud.info.point_count, 2);
}

TEST(PcdReader, ReadsItsThreeForms) {
  expect_both_points(pcd_header("ascii") + "1.5 9 9 9 0.1 0 0 -1 7\n2.5 9 9 9 0.2 0 0 -2 65535\n");
  expect_both_points(pcd_header("binary") + pcd_rows());
  expect_both_points(pcd_header("binary", "") + pcd_rows());  // WIDTH x HEIGHT
  expect_both_points("# " + std::string(1'000'000, 'c') + "\n" + pcd_header("binary") + pcd_rows());
  expect_both_points(pcd_compressed(lzf_literals(pcd_columns()), 64));
}

// A reference of 3 + 2 bytes, one byte back, makes four further bytes of the first one.
TEST(PcdReader, FollowsReferencesOfTheCompressedForm) {
  std::string packed = lzf_literals(pcd_columns().substr(0, 9));
  packed += std::string("\xe0\x0e\x00", 3);  // 7 + 14 + 2 bytes
  packed += lzf_literals(pcd_columns().substr(32));
  expect_both_points(pcd_compressed(packed, 64));
}

TEST(PcdReader, RefusesWhatDoesNotFit) {
  const auto refusal = [](const std::string& bytes) { return cloud_refusal("a.pcd", bytes); };
  const auto with = [](std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::string binary = pcd_header("binary") + pcd_rows();
  EXPECT_THAT(refusal(binary.substr(0, binary.size() - 1)), HasSubstr("but has the bytes of 1"));
  EXPECT_THAT(refusal(with(pcd_header("binary", ""), "WIDTH 2", "WIDTH 0")), HasSubstr("has no points"));
  EXPECT_THAT(refusal(with(binary, "WIDTH 2", "WIDTH 0")),
              HasSubstr("declares 2 POINTS, but WIDTH x HEIGHT is 0"));
  EXPECT_THAT(refusal(with(binary, "POINTS 2", "POINTS -2")), HasSubstr("POINTS '-2' is not a count"));
  EXPECT_THAT(refusal(with(binary, "COUNT 1 3", "COUNT 1 65537")), HasSubstr("a COUNT of 65537"));
  EXPECT_THAT(refusal(with(binary, "COUNT 1 3 1", "COUNT 3 1")), HasSubstr("COUNT differ in length"));
  EXPECT_THAT(refusal(with(pcd_header("binary", ""), "WIDTH 2\nHEIGHT 1", "WIDTH 16777217\nHEIGHT 16777217")),
              HasSubstr("declares too many points"));
  EXPECT_THAT(refusal(with(binary, " z ", " q ")), HasSubstr("no column is recognised as z"));
  EXPECT_THAT(refusal(pcd_header("ascii") + "1 9 9 9 1 0 0 1\n"), HasSubstr("line 11: has 8 cells, not 9"));
}

TEST(PcdReader, AccountsForTheBytesBehindThePoints) {
  const auto notes = [](const std::string& bytes) { return read_cloud("a.pcd", bytes).info.notes; };
  const std::string binary = pcd_header("binary") + pcd_rows();
  EXPECT_THAT(cloud_refusal("a.pcd", binary + std::string(64, 'x')),
              HasSubstr("declares 2 points, but the bytes of 2 more follow"));
  EXPECT_THAT(notes(binary + "x"), ElementsAre(HasSubstr("has 1 bytes that belong to nothing")));
  EXPECT_THAT(notes(pcd_compressed(lzf_literals(pcd_columns()), 64) + "xy"),
              ElementsAre(HasSubstr("has 2 bytes behind its compressed points")));
}

TEST(PcdReader, SaysThatAViewpointIsIgnored) {
  const auto notes = [](const std::string& viewpoint) {
    return read_cloud("a.pcd", pcd_header("binary", "VIEWPOINT " + viewpoint + "\nPOINTS 2\n") + pcd_rows())
        .info.notes;
  };
  EXPECT_THAT(notes("0 0 0 1 0 0 0"), testing::IsEmpty());
  EXPECT_THAT(notes("1 0 0 1 0 0 0"), ElementsAre(HasSubstr("VIEWPOINT is ignored")));
}

/// A camera of two values, two vertices, one face.
std::string ply_header(const std::string& form) {
  return "ply\nformat " + form +
         " 1.0\nelement camera 1\nproperty float f\nproperty uchar kind\nelement vertex 2\nproperty double "
         "x\n"
         "property float y\nproperty short z\nproperty uchar intensity\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n";
}

std::string binary(bool is_big_endian) {
  std::string bytes = ply_header(is_big_endian ? "binary_big_endian" : "binary_little_endian");
  put(bytes, 50.0F, is_big_endian);
  put(bytes, std::uint8_t{1});
  for (const int i : {0, 1}) {
    put(bytes, 0.1 + i, is_big_endian);
    put(bytes, 1.5F + static_cast<float>(i), is_big_endian);
    put(bytes, static_cast<std::int16_t>(-300 + i), is_big_endian);
    put(bytes, static_cast<std::uint8_t>(254 + i));
  }
  put(bytes, std::uint8_t{3});
  for (const std::int32_t vertex : {0, 1, 0}) put(bytes, vertex, is_big_endian);
  return bytes;
}

const std::string kText = ply_header("ascii") + "50 1\n0.1 1.5 -300 254\n1.1 2.5 -299 255\n3 0 1 0\n";

TEST(PlyCloud, ReadsTheVerticesOfItsThreeForms) {
  for (const std::string& bytes : {kText, binary(false), binary(true)}) {
    const WholeCloud cloud = read_cloud("a.ply", bytes, {}, 2);
    EXPECT_THAT(cloud[CloudField::x], ElementsAre(0.1, 1.1));
    EXPECT_THAT(cloud[CloudField::y], ElementsAre(1.5, 2.5));
    EXPECT_THAT(cloud[CloudField::z], ElementsAre(-300, -299));
    EXPECT_THAT(cloud[CloudField::intensity], ElementsAre(254, 255));
    EXPECT_THAT(cloud.info.notes, ElementsAre(HasSubstr("are ignored: 1 camera, 1 face")));
  }
}

// The length of a list is in its row.
TEST(PlyCloud, AccountsForTheBytesBehindTheVertices) {
  const auto with = [](std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::string good = binary(false);
  for (const bool is_big_endian : {false, true}) {
    const std::string bytes = binary(is_big_endian);
    EXPECT_THAT(cloud_refusal("a.ply", with(bytes, "face 1", "face 2")),
                HasSubstr("declares 2 elements face, more than it has"));
    EXPECT_THAT(cloud_refusal("a.ply", bytes.substr(0, bytes.size() - 1)),
                HasSubstr("1 elements face, more"));
    EXPECT_THAT(cloud_refusal("a.ply", bytes + std::string(30, 'x')),
                HasSubstr("declares 2 points, but the bytes of 2 more follow"));
    EXPECT_THAT(cloud_refusal("a.ply", with(bytes, "vertex 2", "vertex 1")), Not("accepted"));
    const std::string negative = with(bytes, "list uchar", "list char");
    EXPECT_THAT(cloud_refusal("a.ply", with(negative, "\3", "\xff")), HasSubstr("1 elements face, more"));
  }
  for (const char* const count : {"face 0", "face 2"})
    EXPECT_THAT(cloud_refusal("a.ply", with(kText, "face 1", count)), Not("accepted"));
  EXPECT_THAT(cloud_refusal("a.ply", with(kText, "vertex 2", "vertex 1")),
              HasSubstr("declares 3 rows of vertices and other elements, but has 4"));
  EXPECT_THAT(read_cloud("a.ply", kText + "\n \r\n").batches.size(), 1U);
  EXPECT_THAT(cloud_refusal("a.ply", with(good, "face 1", "face 9000000000000000000")),
              HasSubstr("declares 9000000000000000000 elements face, more than it has"));
  const std::string plain = with(good, "list uchar int vertex_indices", "uchar a");
  const std::string vertices = plain.substr(0, plain.size() - 12);  // one byte for the element face
  EXPECT_THAT(cloud_refusal("a.ply", vertices), "accepted");
  EXPECT_THAT(cloud_refusal("a.ply", vertices + std::string(30, 'x')),
              HasSubstr("declares 2 points, but the bytes of 2 more follow"));
  EXPECT_THAT(read_cloud("a.ply", vertices + "xy").info.notes,
              ElementsAre(HasSubstr("are ignored"), HasSubstr("has 2 bytes that belong to nothing")));
  const std::string no_face = with(kText, "face 1", "face 0");
  EXPECT_THAT(cloud_refusal("a.ply", no_face), HasSubstr("declares 2 points, but has more"));
}

TEST(PlyCloud, ReadsLongComments) {
  const std::string comment = "comment " + std::string(1'000'000, 'c') + "\n";
  for (std::string bytes : {kText, binary(false)}) {
    bytes.insert(bytes.find("element"), comment);
    EXPECT_THAT(read_cloud("a.ply", bytes)[CloudField::x], ElementsAre(0.1, 1.1));
  }
}

TEST(PlyCloud, RefusesWhatDoesNotFit) {
  const auto refusal = [](const std::string& bytes) { return cloud_refusal("a.ply", bytes); };
  const auto with = [](std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  const std::string good = binary(false);
  EXPECT_THAT(refusal(good.substr(0, good.size() - 14)), HasSubstr("but has the bytes of 1"));
  EXPECT_THAT(refusal(with(good, "vertex 2", "vertex 9000000000000000000")), HasSubstr("it is truncated"));
  EXPECT_THAT(refusal(with(good, "vertex 2", "vertex 0")), HasSubstr("has no points"));
  EXPECT_THAT(refusal(with(good, "element vertex", "element point")), HasSubstr("has no element vertex"));
  EXPECT_THAT(refusal(with(good, "float f", "list uchar float f")), HasSubstr("element camera has a list"));
  EXPECT_THAT(refusal(with(good, "camera 1", "camera 9000000000000000000")),
              HasSubstr("is shorter than its elements before the vertices"));
  EXPECT_THAT(refusal(good.substr(0, good.find("element vertex"))), HasSubstr("ends within the header"));
  EXPECT_THAT(refusal(with(kText, "camera 1", "camera 9")), HasSubstr("declares 12 rows"));
  EXPECT_THAT(refusal(with(with(kText, "camera 1", "camera 9"), "face 1", "face 0")),
              HasSubstr("ends before its vertices"));
}

}  // namespace
}  // namespace landfall
