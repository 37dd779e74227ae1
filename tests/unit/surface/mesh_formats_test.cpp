#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <string>

#include "supple/surface/mesh_io.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

template <typename Value>
void append(std::string& bytes, Value value, bool big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  static_assert(std::endian::native == std::endian::little);
  if (big_endian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
  EXPECT_EQ(a.positions(), b.positions());
  EXPECT_EQ(a.faces(), b.faces());
}

void expect_triangle(const TriangleSoup& soup) {
  EXPECT_EQ(soup.positions, (std::vector<Eigen::Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(soup.faces, (std::vector<Triangle>{{0, 1, 2}}));
}

std::string binary_stl(const TriangleMesh& mesh, const std::string& header = "made by a test") {
  std::string bytes = header + std::string(80 - header.size(), '\0');
  append(bytes, static_cast<std::uint32_t>(mesh.face_count()));
  for (const Triangle& face : mesh.faces()) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0f);
    for (const std::int32_t v : face) {
      for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(mesh.positions()[v][i]));
    }
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST(MeshFormats, ObjRoundTripKeepsEveryBit) {
  const TriangleMesh mesh = testing::bumpy_cube(6);
  expect_same(load_mesh(write_obj(mesh)), mesh);
}

TEST(MeshFormats, PlyRoundTripKeepsEveryBitAndTheBytes) {
  const TriangleMesh mesh = testing::genus3(2);
  const std::string bytes = write_ply(mesh);
  const TriangleMesh again = load_mesh(bytes);
  expect_same(again, mesh);
  EXPECT_EQ(write_ply(again), bytes);
  EXPECT_TRUE(again.warnings().empty());
}

TEST(MeshFormats, AreDetectedByTheirFirstBytes) {
  const TriangleMesh mesh = testing::icosphere(0);
  EXPECT_EQ(detect_format(write_obj(mesh)), MeshFormat::obj);
  EXPECT_EQ(detect_format(write_ply(mesh)), MeshFormat::ply);
  EXPECT_EQ(detect_format("ply\r\nformat ascii 1.0\r\n"), MeshFormat::ply);
  EXPECT_EQ(detect_format("# made by hand\n\nOFF 3 1 0\n"), MeshFormat::off);
  EXPECT_EQ(detect_format("COFF\n"), MeshFormat::off);
  EXPECT_EQ(detect_format("solid cube\nfacet"), MeshFormat::stl);
  EXPECT_EQ(detect_format(binary_stl(mesh)), MeshFormat::stl);
  EXPECT_EQ(detect_format(binary_stl(mesh, "solid, but binary")), MeshFormat::stl);
  EXPECT_EQ(detect_format(""), MeshFormat::obj);
}

TEST(MeshFormats, ObjReadsEveryWayToWriteAFace) {
  expect_triangle(read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj));
  expect_triangle(read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1 2/1/1 3//1", MeshFormat::obj));
  expect_triangle(read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n", MeshFormat::obj));
  expect_triangle(read_mesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", MeshFormat::obj));
  expect_triangle(read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n 3\n", MeshFormat::obj));
  expect_triangle(read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\\\n3\n", MeshFormat::obj));
}

TEST(MeshFormats, ObjSkipsColoursCommentsAndOtherStatements) {
  expect_triangle(
      read_mesh("# comment\nmtllib a.mtl\no thing\ng part\nv 0 0 0 0.5 0.5 0.5 # red\nv +1 0e0 0 1\n"
                "\tv\t0\t1.0\t0\n\ns off\nusemtl steel\nf 1 2 3 # face\n",
                MeshFormat::obj));
  const TriangleSoup soup = read_mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 3\nf 1 2 3\nf 1 2\n", MeshFormat::obj);
  expect_triangle(soup);
  EXPECT_EQ(soup.warnings, (std::vector<std::string>{"2 line or point elements were left out.",
                                                     "1 face of fewer than three corners was left out."}));
}

TEST(MeshFormats, PolygonsBecomeFansWithAWarning) {
  const TriangleSoup soup = read_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 2 0\nv 0 1 0\nf 1 2 3 4 5\n", MeshFormat::obj);
  EXPECT_EQ(soup.faces, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_EQ(soup.warnings, std::vector<std::string>{"1 polygon was cut into triangles."});
}

TEST(MeshFormats, LinesMayEndInAnyWayAndBeginWithAByteOrderMark) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    for (const std::string mark : {"", "\xEF\xBB\xBF"}) {
      expect_triangle(
          read_mesh(mark + "v 0 0 0" + end + "v 1 0 0" + end + "v 0 1 0" + end + "f 1 2 3" + end, MeshFormat::obj));
      const std::string off =
          mark + "OFF" + end + "3 1 0" + end + "0 0 0" + end + "1 0 0" + end + "0 1 0" + end + "3 0 1 2";
      EXPECT_EQ(detect_format(off), MeshFormat::off);
      expect_triangle(read_mesh(off, MeshFormat::off));
      const std::string ply = mark + "ply" + end + "format ascii 1.0" + end + "element vertex 3" + end +
                              "property float x" + end + "property float y" + end + "property float z" + end +
                              "element face 1" + end + "property list uchar int vertex_indices" + end + "end_header" +
                              end + "0 0 0" + end + "1 0 0" + end + "0 1 0" + end + "3 0 1 2" + end;
      EXPECT_EQ(detect_format(ply), MeshFormat::ply);
      expect_triangle(read_mesh(ply, MeshFormat::ply));
      const std::string stl = mark + "solid a b c" + end + "facet normal 0 0 1" + end + "outer loop" + end +
                              "vertex 0 0 0" + end + "vertex 1 0 0" + end + "vertex 0 1 0" + end + "endloop" + end +
                              "endfacet" + end + "endsolid a b c" + end;
      EXPECT_EQ(detect_format(stl), MeshFormat::stl);
      expect_triangle(read_mesh(stl, MeshFormat::stl));
    }
  }
}

TEST(MeshFormats, OffReadsCommentsColoursAndCountsOnTheFirstLine) {
  expect_triangle(
      read_mesh("OFF 3 1 0 # counts\n# vertices\n0 0 0\n1 0 0\n\n0 1 0\n3 0 1 2 255 0 0\n", MeshFormat::off));
  expect_triangle(read_mesh("COFF\n3 1\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n", MeshFormat::off));
  expect_triangle(read_mesh("STCNOFF\n3 1 3\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n", MeshFormat::off));
}

TEST(MeshFormats, PlyLinesOfMoreNumbersThanTheHeaderAnnouncesAreRefused) {
  // Read three by three, the numbers of these lines are three vertices and the face 0, 1, 2, and three are left over.
  const auto fault = expect_error("mesh.malformed", [] {
    read_mesh(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 3\n0 0 0 3\n5 3 0 1\n2 0 0 0\n",
        MeshFormat::ply);
  });
  EXPECT_NE(std::string(fault.what()).find("numbers are left over"), std::string::npos) << fault.what();
}

TEST(MeshFormats, WhatFollowsTheLastElementIsLeftOutWithAWarning) {
  const TriangleSoup off = read_mesh("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\nmore\n", MeshFormat::off);
  expect_triangle(off);
  EXPECT_EQ(off.warnings, std::vector<std::string>{"What follows the last face, from line 7 on, was left out."});
  const TriangleMesh mesh = testing::icosphere(0);
  EXPECT_EQ(read_mesh(write_ply(mesh) + "junk", MeshFormat::ply).warnings,
            std::vector<std::string>{"What follows the last element was left out."});
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const std::string within : {" ", "\n"}) {
    for (const std::string between : {" ", "\n"}) {
      const std::string body = "0 0 0" + within + "1 0 0" + within + "0 1 0" + between + "3 0 1 2" + between;
      EXPECT_EQ(read_mesh(header + body + "junk\n", MeshFormat::ply).warnings,
                std::vector<std::string>{"What follows the last element was left out."})
          << body;
    }
  }
  EXPECT_EQ(read_mesh(binary_stl(mesh) + "junk", MeshFormat::stl).warnings,
            std::vector<std::string>{"The 4 bytes after the last facet were left out."});
}

template <typename Coordinate, typename Index>
std::string binary_ply(const std::string& coordinate, const std::string& index_type, bool big_endian) {
  std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                      "_endian 1.0\ncomment by a test\nelement vertex 3\nproperty uchar red\nproperty " + coordinate +
                      " x\nproperty " + coordinate + " y\nproperty list uchar float extra\nproperty " + coordinate +
                      " z\nelement edge 2\nproperty int vertex1\nproperty int vertex2\nelement strip 1\n"
                      "property list ushort short values\nelement face 1\nproperty float quality\n"
                      "property list uint " +
                      index_type + " vertex_index\nproperty uchar flags\nend_header\n";
  const Eigen::Vector3d corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (const Eigen::Vector3d& p : corners) {
    append(bytes, std::uint8_t{255});
    append(bytes, static_cast<Coordinate>(p[0]), big_endian);
    append(bytes, static_cast<Coordinate>(p[1]), big_endian);
    append(bytes, std::uint8_t{2});
    for (int i = 0; i < 2; ++i) append(bytes, 7.0f, big_endian);
    append(bytes, static_cast<Coordinate>(p[2]), big_endian);
  }
  for (int i = 0; i < 4; ++i) append(bytes, std::int32_t{1}, big_endian);
  append(bytes, std::uint16_t{3}, big_endian);
  for (int i = 0; i < 3; ++i) append(bytes, std::int16_t{9}, big_endian);
  append(bytes, 0.5f, big_endian);
  append(bytes, std::uint32_t{3}, big_endian);
  for (const int v : {0, 1, 2}) append(bytes, static_cast<Index>(v), big_endian);
  append(bytes, std::uint8_t{1});
  return bytes;
}

TEST(MeshFormats, PlyReadsAnyScalarTypesInEitherByteOrderAndSkipsTheRest) {
  for (const bool big_endian : {false, true}) {
    for (const TriangleSoup& soup :
         {read_mesh(binary_ply<float, std::int32_t>("float", "int", big_endian), MeshFormat::ply),
          read_mesh(binary_ply<double, std::uint8_t>("float64", "uint8", big_endian), MeshFormat::ply),
          read_mesh(binary_ply<std::int8_t, std::int16_t>("char", "short", big_endian), MeshFormat::ply),
          read_mesh(binary_ply<std::uint16_t, std::uint32_t>("ushort", "uint32", big_endian), MeshFormat::ply)}) {
      expect_triangle(soup);
      EXPECT_EQ(soup.warnings,
                std::vector<std::string>{"Elements other than vertex and face were left out: 'edge' and 1 more."});
    }
  }
}

TEST(MeshFormats, PlyDataMayBeginWithTheByteOfALineFeed) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string bytes = "ply" + end + "format binary_little_endian 1.0" + end + "element vertex 3" + end +
                        "property uchar x" + end + "property uchar y" + end + "property uchar z" + end +
                        "element face 1" + end + "property list uchar uchar vertex_indices" + end + "end_header" + end;
    for (const int byte : {10, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2}) bytes += static_cast<char>(byte);
    const TriangleSoup soup = read_mesh(bytes, MeshFormat::ply);
    EXPECT_EQ(soup.positions, (std::vector<Eigen::Vector3d>{{10, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(soup.faces, (std::vector<Triangle>{{0, 1, 2}}));
  }
}

TEST(MeshFormats, StlJoinsEqualCornersAndKeepsFloatPrecision) {
  const TriangleMesh mesh = testing::torus(12, 8);
  const TriangleMesh read = load_mesh(binary_stl(mesh));
  ASSERT_EQ(read.vertex_count(), mesh.vertex_count());
  ASSERT_EQ(read.face_count(), mesh.face_count());
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT((read.positions()[read.faces()[f][i]] - mesh.positions()[mesh.faces()[f][i]]).norm(), 1e-7);
    }
  }
}

TEST(MeshFormats, LoadingHandsOnTheWarningsOfReaderAndMesh) {
  const TriangleMesh mesh = load_mesh("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nf 1 2 3 4\n");
  EXPECT_EQ(mesh.warnings(),
            (std::vector<std::string>{"1 polygon was cut into triangles.", "1 vertex belongs to no face."}));
}

}  // namespace
}  // namespace supple::surface
