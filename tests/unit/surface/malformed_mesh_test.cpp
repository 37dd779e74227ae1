#include <gtest/gtest.h>

#include <string>

#include "supple/surface/mesh_io.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;

struct Case {
  std::string bytes;
  std::string where;
  std::string found;  // part of the message
};

void expect_malformed(MeshFormat format, const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.bytes.substr(0, 200));
    const Error error = expect_error("mesh.malformed", [&] { read_mesh(c.bytes, format); });
    ASSERT_EQ(error.details().size(), 1u);
    EXPECT_EQ(error.details()[0].where, c.where);
    EXPECT_NE(error.details()[0].message.find(c.found), std::string::npos) << error.details()[0].message;
  }
}

const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(MalformedMesh, ObjNamesTheLine) {
  expect_malformed(MeshFormat::obj, {
                                        {"v 0 0\n", "line 1", "expected a coordinate, found nothing"},
                                        {three + "v 0 1x 0\n", "line 4", "'1x'"},
                                        {three + "v 1e999 0 0\n", "line 4", "beyond the range"},
                                        {three + "f 1 2 0\n", "line 4", "vertex number 0 does not exist"},
                                        {three + "f 1 2 -4\n", "line 4", "vertex number -4 does not exist"},
                                        {three + "f 1 2 99999999999\n", "line 4", "99999999999 does not exist"},
                                        {three + "f 1 2 99999999999999999999\n", "line 4", "expected a vertex number"},
                                        {three + "f 1 2 3.5\n", "line 4", "'3.5'"},
                                        {three + "f 1 2 /3\n", "line 4", "found nothing"},
                                        {"\xff\xff\xff garbage\n", "line 1", "found '?"},
                                        {"{\"vertices\": []}", "line 1", "expected an OBJ statement"},
                                    });
}

TEST(MalformedMesh, OffNamesTheLine) {
  const std::string head = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  expect_malformed(MeshFormat::off, {
                                        {"", "line 0", "expected OFF"},
                                        {"4OFF\n", "line 1", "three dimensions"},
                                        {"OFF BINARY\n", "line 1", "binary OFF"},
                                        {"OFF\n", "line 1", "number of vertices"},
                                        {"OFF\n3\n", "line 2", "number of faces"},
                                        {"OFF\n-3 1 0\n", "line 2", "negative"},
                                        {"OFF\n3 1 0\n0 0 0\n1 0 0\n", "line 4", "vertex 2 of 3"},
                                        {"OFF\n3 1 0\n0 0\n", "line 3", "vertex 0 of 3"},
                                        {head, "line 5", "expected face 0 of 1"},
                                        {head + "3 0 1\n", "line 6", "expected a vertex number, found nothing"},
                                        {head + "3 0 1 3\n", "line 6", "vertex number 3 does not exist"},
                                        {head + "3 0 1 -1\n", "line 6", "vertex number -1 does not exist"},
                                        {head + "1000000000000 0 1 2\n", "line 6", "expected a vertex number"},
                                    });
}

std::string ply(const std::string& format, const std::string& rest) {
  return "ply\nformat " + format + " 1.0\n" + rest;
}

TEST(MalformedMesh, PlyNamesTheLineOrTheByte) {
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string head = vertices + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string points = "0 0 0 1 0 0 0 1 0\n";
  const std::string binary = ply("binary_big_endian", head);
  expect_malformed(
      MeshFormat::ply,
      {
          {"plx\n", "line 1", "expected ply"},
          {"ply\n", "line 1", "no end_header"},
          {"ply\nend_header\n", "line 2", "no format"},
          {"ply\nformat ascii 2.0\n", "line 2", "version"},
          {"ply\nformat text 1.0\n", "line 2", "'text'"},
          {ply("ascii", "property float x\n"), "line 3", "precedes"},
          {ply("ascii", "element vertex -1\n"), "line 3", "negative"},
          {ply("ascii", "element vertex many\n"), "line 3", "'many'"},
          {ply("ascii", "element vertex 1\nproperty real x\n"), "line 4", "'real'"},
          {ply("ascii", "element vertex 1\nproperty float\n"), "line 4", "name"},
          {ply("ascii", "hello\n"), "line 3", "'hello'"},
          {ply("ascii", vertices + "end_header\n"), "line 7", "no element face"},
          {ply("ascii", vertices + head), "line 13", "more than one element vertex"},
          {ply("ascii", "element vertex 1\nproperty float x\nelement face 1\nend_header\n1"), "line 6", "x, y and z"},
          {ply("ascii", vertices + "element face 1\nproperty int vertex_indices\nend_header\n" + points), "line 10",
           "no list property"},
          {ply("ascii", head) + "0 0 0 1 0", "line 10", "end of the file"},
          {ply("ascii", head) + points + "3 0 1 3", "line 11", "from 0 to 2"},
          {ply("ascii", head) + points + "3 0 1 -1", "line 11", "from 0 to 2"},
          {ply("ascii", head) + points + "3 0 1 0.5", "line 11", "from 0 to 2"},
          {ply("ascii", head) + points + "-3 0 1 2", "line 11", "number of corners"},
          {ply("ascii", head) + points + "nan 0 1 2", "line 11", "number of corners"},
          {ply("ascii", head) + points + "3 0 1", "line 11", "end of the file"},
          {ply("ascii", "element junk 1\nproperty list float int a\n" + head) + "inf 1 2 3", "line 12",
           "length of a list"},
          {ply("ascii", "element junk 1\nproperty list float int a\n" + head) + "1e9 1 2 3", "line 12",
           "end of the file"},
          {binary, "byte " + std::to_string(binary.size()), "end of the file"},
          {binary + std::string(36, '\0') + "\3", "byte " + std::to_string(binary.size() + 37), "end of the file"},
          {binary + std::string(36, '\0') + "\3\xff\xff\xff\xff", "byte " + std::to_string(binary.size() + 41),
           "from 0 to 2"},
      });
}

TEST(MalformedMesh, StlNamesTheLineOrTheByte) {
  const std::string header = "binary" + std::string(74, ' ');
  expect_malformed(MeshFormat::stl,
                   {
                       {"short", "byte 5", "84 bytes"},
                       {header + std::string("\2\0\0\0", 4) + std::string(60, '\0'), "byte 144", "facet 1 of 2"},
                       {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "line 4", "a coordinate"},
                       {"solid a\nfacet normal 0 0 1\nouter circle\n", "line 3", "expected loop"},
                       {"solid a\nbox\n", "line 2", "expected facet, found 'box'"},
                       {"solid a\n", "line 1", "expected endsolid"},
                       {"solid a\nendsolid a\nmore\n", "line 3", "expected solid"},
                   });
}

TEST(MalformedMesh, CountsAboveTheLimitsNameLimitAndValue) {
  const MeshLimits limits{.vertices = 10, .faces = 12};
  const auto message = [&](const std::string& bytes) {
    const Error error = expect_error("mesh.too_large", [&] { load_mesh(bytes, limits); });
    return error.details().empty() ? "" : error.details()[0].message;
  };
  EXPECT_EQ(message("OFF\n11 1 0\n"), "11 vertices, the limit is 10");
  EXPECT_EQ(message("OFF\n10 9000000000 0\n"), "9000000000 faces, the limit is 12");
  EXPECT_EQ(message(ply("ascii", "element vertex 900000000000000\nelement face 1\nend_header\n")),
            "900000000000000 vertices, the limit is 10");
  EXPECT_EQ(message(write_obj(testing::icosphere(0))), "11 vertices, the limit is 10");
  std::string many = three;
  for (int i = 0; i < 13; ++i) many += "f 1 2 3\n";
  EXPECT_EQ(message(many), "13 faces, the limit is 12");
  EXPECT_EQ(message("solid" + std::string(75, ' ') + std::string("\xd\0\0\0", 4) + std::string(650, '\0')),
            "13 faces, the limit is 12");
}

TEST(MalformedMesh, HugeAnnouncedCountsReserveNoMemoryTheFileCouldNotFill) {
  // Within the default limits 20 million vertices are allowed, but these files hold none.
  const std::string off = "OFF\n20000000 40000000 0\n";
  expect_error("mesh.malformed", [&] { read_mesh(off, MeshFormat::off); });
  const std::string skipped = ply("binary_little_endian",
                                  "element junk 9000000000000000000\nproperty double a\nproperty double b\nelement "
                                  "vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face "
                                  "0\nproperty list uchar int vertex_indices\nend_header\n");
  const Error error = expect_error("mesh.malformed", [&] { read_mesh(skipped, MeshFormat::ply); });
  EXPECT_NE(error.details().at(0).message.find("0 bytes"), std::string::npos);
}

TEST(MalformedMesh, ElementsWithoutPropertiesAreSkippedAtOnceHoweverMany) {
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    const std::string bytes = ply(format,
                                  "element nothing 9000000000000000000\nelement vertex 0\nproperty float "
                                  "x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar "
                                  "int vertex_indices\nend_header\n");
    EXPECT_TRUE(read_mesh(bytes, MeshFormat::ply).positions.empty());
  }
}

TEST(MalformedMesh, EveryTruncationOfAFileIsRefusedOrReadShort) {
  const TriangleMesh mesh = testing::icosphere(0);
  const std::string whole = write_ply(mesh);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(read_mesh(whole.substr(0, size), MeshFormat::ply), Error) << size;
  }
}

TEST(MalformedMesh, NumbersThatAreNotFiniteNameTheVertex) {
  const Error error = expect_error("mesh.non_finite", [] { load_mesh("v 0 0 0\nv nan 0 0\nv 0 -inf 0\nf 1 2 3\n"); });
  EXPECT_EQ(testing::places(error), (std::vector<std::string>{"vertex 1", "vertex 2"}));
}

TEST(MalformedMesh, AFaceOfAMissingVertexNamesTheFace) {
  const Error error = expect_error("mesh.index_out_of_range", [] { load_mesh(three + "f 1 2 3\nf 1 3 4\n"); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"face 1"});
}

TEST(MalformedMesh, NonFiniteStlCornersStayApart) {
  // Many equal corners that are not numbers: joined by a careless comparison they would take quadratic time.
  std::string text = "solid\n";
  for (int i = 0; i < 20'000; ++i) {
    text += "facet normal 0 0 0 outer loop vertex nan 0 0 vertex nan 0 0 vertex nan 0 0 endloop endfacet\n";
  }
  const TriangleSoup soup = read_mesh(text + "endsolid\n", MeshFormat::stl);
  EXPECT_EQ(soup.positions.size(), 60'000u);
  expect_error("mesh.non_finite", [&] { load_mesh(text + "endsolid\n"); });
}

}  // namespace
}  // namespace supple::surface
