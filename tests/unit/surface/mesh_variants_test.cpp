#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/random.h"
#include "supple/surface/mesh_io.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;

const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<Triangle> halves{{0, 1, 2}, {0, 2, 3}};

void expect_square(const std::string& bytes, MeshFormat format) {
  SCOPED_TRACE(bytes.substr(0, 300));
  EXPECT_EQ(detect_format(bytes), format);
  const TriangleSoup soup = read_mesh(bytes, format);
  EXPECT_EQ(soup.positions, corners);
  EXPECT_EQ(soup.faces, halves);
}

std::string refusal(const std::string& bytes, MeshFormat format) {
  SCOPED_TRACE(bytes.substr(0, 300));
  const Error error = expect_error("mesh.malformed", [&] { read_mesh(bytes, format); });
  return error.what();
}

void expect_refused(const std::string& bytes, MeshFormat format, const std::string& reason) {
  const std::string text = refusal(bytes, format);
  EXPECT_NE(text.find(reason), std::string::npos) << text;
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c; });
  return text;
}

std::string square_stl(const std::string& name, const std::string& normal = "0 0 1") {
  std::string text = "solid " + name + "\n";
  for (const Triangle& face : halves) {
    text += "facet normal " + normal + "\nouter loop\n";
    for (const std::int32_t v : face)
      text += "vertex " + std::to_string(corners[v][0]) + " " + std::to_string(corners[v][1]) + " 0\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid " + name + "\n";
}

TEST(MeshVariants, AsciiStlMayBeInCapitalsAndBeginWithComments) {
  const std::string plain = square_stl("part");
  for (const std::string& text : {plain, in_capitals(plain), square_stl(""), square_stl("facet of a facet")}) {
    for (const std::string before :
         {"", "\n\n  ", "# made by hand\n", "; a\n;solid b\n", "// a comment\n\n! another\n", "\xEF\xBB\xBF# mark\n"})
      expect_square(before + text, MeshFormat::stl);
    std::string one_line = text;
    std::replace(one_line.begin(), one_line.end(), '\n', ' ');
    expect_square(one_line, MeshFormat::stl);
  }
  expect_square(in_capitals(plain).insert(plain.find("outer"), "# within\n"), MeshFormat::stl);
}

TEST(MeshVariants, NormalsOfStlFacetsNeedNotBeNumbers) {
  for (const std::string normal :
       {"nan nan nan", "-nan(ind) -nan(ind) -nan(ind)", "-1.#IND -1.#IND 0", "1.#QNAN0 1.#INF 0"})
    expect_square(square_stl("part", normal), MeshFormat::stl);
}

TEST(MeshVariants, BinaryStlMayBeginWithSolidAndTellsWhatItsCountLeavesOut) {
  std::string bytes = "solid made by a scanner";
  bytes.resize(84, '\0');
  bytes[80] = 2;
  bytes.resize(84 + 100, '\0');
  for (int facet = 0; facet < 2; ++facet) {
    for (int corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 2; ++axis) {
        const auto value = static_cast<float>(corners[halves[facet][corner]][axis]);
        std::copy_n(reinterpret_cast<const char*>(&value), 4,
                    bytes.begin() + 84 + 50 * facet + 12 * (corner + 1) + 4 * axis);
      }
    }
  }
  expect_square(bytes, MeshFormat::stl);
  EXPECT_EQ(read_mesh(bytes + "xyz", MeshFormat::stl).faces, halves);
  EXPECT_EQ(read_mesh(bytes + "xyz", MeshFormat::stl).warnings.size(), 1u);
  std::string fewer = bytes;
  fewer[80] = 1;
  expect_refused(fewer, MeshFormat::stl, "announces 1 facets, but 2 would fit");
  expect_refused(bytes.substr(0, 150), MeshFormat::stl, "expected facet 1 of 2");
  expect_refused("just some words that are longer than the eighty-four bytes of the header of a binary file, and more",
                 MeshFormat::stl, "does not begin with the word solid");
}

TEST(MeshVariants, PlyReadsTriangleStrips) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
  const TriangleSoup square = read_mesh(header + strips + points + "4 1 2 0 3\n", MeshFormat::ply);
  EXPECT_EQ(square.faces, (std::vector<Triangle>{{1, 2, 0}, {0, 2, 3}}));
  EXPECT_TRUE(square.warnings.empty());
  const TriangleSoup restarted = read_mesh(header + strips + points + "7 0 1 2 -1 0 2 3\n", MeshFormat::ply);
  EXPECT_EQ(restarted.faces, halves);
  // A repeated vertex turns a strip around a corner.
  const TriangleSoup turned = read_mesh(header + strips + points + "7 0 1 2 2 0 2 3\n", MeshFormat::ply);
  EXPECT_EQ(turned.faces.size(), 2u);
  const TriangleSoup both = read_mesh(
      header + "element face 1\nproperty list uchar int vertex_index\n" + strips + points + "3 0 1 2\n3 0 2 3\n",
      MeshFormat::ply);
  EXPECT_EQ(both.faces, halves);
  expect_refused(header + strips + points + "4 0 1 2 4\n", MeshFormat::ply, "from -1 to 3");
  expect_refused(header + strips + points + "4 0 1 2 -2\n", MeshFormat::ply, "from -1 to 3");
}

TEST(MeshVariants, StripsOfAnyMeshAgreeAboutItsOrientation) {
  // A torus of strips, one around each ring, as programs for graphics write them.
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomStream stream("strips", seed);
    const int rings = 3 + static_cast<int>(stream.uniform(0, 6)), sides = 3 + static_cast<int>(stream.uniform(0, 6));
    std::string points, lists;
    for (int i = 0; i < rings; ++i) {
      std::string list;
      for (int j = 0; j < sides; ++j) {
        const double u = 2 * M_PI * i / rings, v = 2 * M_PI * j / sides;
        for (const double x : {(2 + std::cos(v)) * std::cos(u), (2 + std::cos(v)) * std::sin(u), std::sin(v)})
          points += std::to_string(x) + " ";
        points += "\n";
      }
      for (int j = 0; j <= sides; ++j)
        list += " " + std::to_string(i * sides + j % sides) + " " + std::to_string((i + 1) % rings * sides + j % sides);
      lists += std::to_string(2 * sides + 2) + list + "\n";
    }
    const TriangleMesh mesh =
        load_mesh("ply\nformat ascii 1.0\nelement vertex " + std::to_string(rings * sides) +
                  "\nproperty float x\nproperty float y\nproperty float z\nelement tristrips " + std::to_string(rings) +
                  "\nproperty list int int vertex_indices\nend_header\n" + points + lists);
    EXPECT_EQ(mesh.face_count(), 2 * rings * sides) << "seed " << seed;
    EXPECT_TRUE(mesh.warnings().empty()) << "seed " << seed << ": " << mesh.warnings()[0];
  }
}

TEST(MeshVariants, PlyLinesThatHoldMoreThanTheHeaderSaysAreRefused) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nend_header\n";
  expect_square(text + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", MeshFormat::ply);
  expect_square(text + "0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2 3\n", MeshFormat::ply);
  EXPECT_FALSE(refusal(text + "0 0 0 3\n1 0 0 0\n1 1 0 1\n0 1 0 2\n3 0 1 2\n3 0 2 3\n", MeshFormat::ply).empty());
}

TEST(MeshVariants, OffIsReadHoweverItsWordsAreLaidOut) {
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n", faces = "3 0 1 2\n3 0 2 3\n";
  for (const std::string head : {"OFF4 2 0\n", "OFF 4 2 0\n", "off\n4 2 0\n", "Off4 2\n", "OFF\n4 2\n",
                                 "OFF\n4\n2\n0\n", "# a\nOFF # b\n# c\n4 2 5 # d\n"}) {
    if (head[1] == 'f' && head[0] == 'O') {
      expect_refused(head + points + faces, MeshFormat::off, "expected OFF of three dimensions");
      continue;
    }
    expect_square(head + points + faces, MeshFormat::off);
    expect_square(head + points + "3 0 1\n2\n3\n0\n2 3\n", MeshFormat::off);
    expect_square(head + "0 0\n0\n1 0 0\n1 1\n0\n0 1 0\n" + faces, MeshFormat::off);
    expect_square(head + points + "3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 1 1\n", MeshFormat::off);
  }
  std::string one_line = "OFF 4 2 0 " + points + faces;
  std::replace(one_line.begin(), one_line.end(), '\n', ' ');
  expect_square(one_line, MeshFormat::off);
  expect_square("OFF 4 2 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n" + faces, MeshFormat::off);
  expect_square("OFF 4 2 0\n" + points + "3 0 1 2 3 0 2 3\n", MeshFormat::off);
}

TEST(MeshVariants, OffVerticesMayHaveNormalsColoursAndTextureCoordinates) {
  for (const auto& [keyword, further] : {std::pair{"COFF", " 255 0 0 255"},
                                         {"coff", " 1 0 0 1"},
                                         {"NOFF", " 0 0 1"},
                                         {"noff", " 0 0 1"},
                                         {"CNOFF", " 0 0 1 1 0 0 1"},
                                         {"STOFF", " 0.5 0.5"},
                                         {"STCNOFF", " 0 0 1 1 0 0 1 0.5 0.5"}}) {
    std::string lines, words;
    for (const auto& p : corners) {
      const std::string vertex = std::to_string(p[0]) + " " + std::to_string(p[1]) + " 0" + further;
      lines += vertex + "\n";
      words += vertex + " ";
    }
    expect_square(std::string(keyword) + "\n4 2 0\n" + lines + "3 0 1 2\n3 0 2 3\n", MeshFormat::off);
    expect_square(std::string(keyword) + " 4 2 0 " + words + "3 0 1 2 3 0 2 3", MeshFormat::off);
  }
}

TEST(MeshVariants, OffInOtherDimensionsOrOfMixedLayoutIsRefused) {
  for (const std::string keyword : {"4OFF", "nOFF", "n4OFF", "OFFBINARY"})
    expect_refused(keyword + "\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", MeshFormat::off,
                   "expected OFF of three dimensions");
  // A number too many in one line, and one too few in another.
  refusal("OFF\n4 2 0\n0 0 0 1\n1 0 0\n1 1 0\n0 1\n0 3 0 1 2\n3 0 2 3\n", MeshFormat::off);
  refusal("OFF\n4 2 0\n0 0 0 x\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", MeshFormat::off);
  refusal("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 red\n3 0 2 3\n", MeshFormat::off);
}

TEST(MeshVariants, ObjStatementsMayGoOnInTheNextLines) {
  expect_square("v 0 0 0\nv 1 \\\n0 0\nv 1 1\\\n 0\nv 0 1 0\nf 1 2 \\\n  3\nf 1 \\  \n 3 \\ # comment\n 4\n",
                MeshFormat::obj);
  expect_square("g a \\\nb c\nv 0 0 0\nv 1 0 0\nl 1 \\\n2\nv 1 1 0\nv 0 1 0\nf 1/1/1 2//1 3/2\nf -4/-1 -2 -1\n",
                MeshFormat::obj);
}

TEST(MeshVariants, GarbageAfterNumbersIsRefusedInEveryFormat) {
  for (const std::string garbage : {"1x", "0x10", "1,5", "1..2", "1e", "--1", "1_000", "1.0.0", "1",
                                    "\xC2\xA0"
                                    "1"}) {
    const std::string number = garbage == "1" ? std::string("1\0", 2) : garbage;
    refusal("v 0 0 0\nv " + number + " 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj);
    refusal("v 0 0 0\nv 1 0 0 " + number + "\nv 0 1 0\nf 1 2 3\n", MeshFormat::obj);
    refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3/" + number + "\n", MeshFormat::obj);
    refusal("OFF\n3 1 0\n0 0 0\n" + number + " 0 0\n0 1 0\n3 0 1 2\n", MeshFormat::off);
    refusal("OFF\n3 1 " + number + "\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", MeshFormat::off);
    refusal(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement "
        "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 " +
            number + " 0\n3 0 1 2\n",
        MeshFormat::ply);
    std::string stl = square_stl("part");
    refusal(stl.replace(stl.find("1.000000 0.000000"), 8, number), MeshFormat::stl);
  }
  expect_refused("v 0,5 0 0\n", MeshFormat::obj, "decimals take a point, not a comma");
  expect_refused("v 0 0 0\nf 1/2/3/4 1 1\n", MeshFormat::obj, "at most three numbers");
}

TEST(MeshVariants, NumbersThatAreNotFiniteAreToldWhateverProgramWroteThem) {
  for (const std::string word :
       {"nan", "-nan", "NaN", "inf", "-Infinity", "nan(ind)", "-nan(ind)", "nan(snan)", "-1.#IND", "1.#IND00",
        "1.#QNAN", "1.#QNAN0", "-1.#QNAN", "1.#SNAN", "1.#INF", "-1.#INF000", "1.#J"}) {
    SCOPED_TRACE(word);
    std::string stl = square_stl("part");
    for (const std::string& bytes :
         {"v 0 0 0\nv 0 " + word + " 0\nv 0 1 0\nf 1 2 3\n", "OFF\n3 1 0\n0 0 0\n1 0 " + word + "\n0 1 0\n3 0 1 2\n",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
          "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n" +
              word + " 0 0\n0 1 0\n3 0 1 2\n",
          stl.replace(stl.find("1.000000 0.000000"), 8, word)}) {
      const Error error = expect_error("mesh.non_finite", [&] { load_mesh(bytes); });
      EXPECT_EQ(testing::places(error), std::vector<std::string>{"vertex 1"});
    }
  }
  // Other words with a hash are comments that begin after a number.
  expect_square("v 0 0 0# one\nv 1 0 0.#two\nv 1 1 0. #IND\nv 0 1 0#\nf 1 2 3\nf 1 3 4#IND\n", MeshFormat::obj);
}

TEST(MeshVariants, FilesOfOtherKindsAreNamed) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::string little, big;
  for (const char c : obj) {
    little += std::string{c, '\0'};
    big += std::string{'\0', c};
  }
  for (const std::string& bytes : {"\xFF\xFE" + little, "\xFE\xFF" + big, little, big})
    expect_refused(bytes, detect_format(bytes), "text in UTF-16; save it as UTF-8");
  expect_refused(std::string("\xFF\xFE\0\0v\0\0\0", 8), MeshFormat::obj, "UTF-32");
  expect_refused("PK\x03\x04whatever", MeshFormat::stl, "3MF");
  expect_refused("ISO-10303-21;\nHEADER;", MeshFormat::obj, "STEP");
  expect_refused("glTF\2", MeshFormat::obj, "glTF");
  expect_refused("<?xml version=\"1.0\"?>", MeshFormat::ply, "XML");
}

}  // namespace
}  // namespace supple::surface
