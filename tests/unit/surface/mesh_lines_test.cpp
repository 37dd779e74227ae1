#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/mesh_io.h"
#include "support/expect_error.h"

namespace supple::surface {
namespace {

using testing::expect_error;

/// Text of lines that end in the given ways, with comments between and behind them, of which some are long.
class LinesWriter {
 public:
  LinesWriter(std::vector<std::string> ends, RandomStream& stream) : ends_(std::move(ends)), stream_(stream) {}

  void add(const std::string& line) {
    const bool has_comment = stream_.below(8) == 0;
    text += line + (has_comment ? " # 1 2 3" : "");
    end_line();
    if (stream_.below(100) != 0) return;
    text += "#" + std::string(static_cast<std::size_t>(stream_.below(3) == 0 ? 40'000 : stream_.below(100)), 'x');
    end_line();
    if (stream_.below(2) == 0) end_line();
  }

  std::string text;
  std::int64_t lines = 0;

 private:
  void end_line() {
    // A line feed after a return would be the same end of a line.
    std::string end = ends_[stream_.below(static_cast<int>(ends_.size()))];
    if (end == "\n" && text.ends_with('\r')) end = "\r\n";
    text += end;
    ++lines;
  }

  std::vector<std::string> ends_;
  RandomStream& stream_;
};

const std::vector<std::vector<std::string>> ends_of_lines{{"\n"}, {"\r\n"}, {"\r"}, {"\n", "\r\n", "\r"}};

TEST(MeshLines, EndInAllWaysAlsoBesideCommentsAndInOneFile) {
  for (const auto& ends : ends_of_lines) {
    for (int seed = 0; seed < 5; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(ends.size()) + " ends");
      RandomStream stream("lines", seed);
      std::vector<Eigen::Vector3d> positions;
      std::vector<Triangle> faces;
      constexpr std::int32_t vertices = 900;
      for (std::int32_t v = 0; v < vertices; ++v) positions.emplace_back(v, v / 64.0 - 1, v / -8.0);
      for (std::int32_t f = 0; f + 2 < vertices; ++f) faces.push_back({f, f + 1, f + 2});
      const auto words = [](const auto& row) {
        std::string line;
        for (int i = 0; i < 3; ++i) line += " " + std::to_string(row[i]);
        return line;
      };
      LinesWriter obj(ends, stream), off(ends, stream);
      off.add("OFF");
      off.add(std::to_string(vertices) + " " + std::to_string(faces.size()) + " 0");
      for (const Eigen::Vector3d& p : positions) {
        obj.add("v" + words(p));
        off.add(words(p));
      }
      for (const Triangle& face : faces) {
        obj.add("f" + words(Triangle{face[0] + 1, face[1] + 1, face[2] + 1}));
        off.add("3" + words(face));
      }
      for (const auto& [text, format] : {std::pair(obj.text, MeshFormat::obj), std::pair(off.text, MeshFormat::off)}) {
        EXPECT_EQ(detect_format(text), format);
        const TriangleSoup soup = read_mesh(text, format);
        EXPECT_EQ(soup.positions, positions);
        EXPECT_EQ(soup.faces, faces);
      }
      const std::int64_t before = obj.lines;
      obj.text += "f 1 2 word";
      const Error error = expect_error("mesh.malformed", [&] { read_mesh(obj.text, MeshFormat::obj); });
      EXPECT_EQ(error.details().at(0).where, "line " + std::to_string(before + 1));
    }
  }
}

}  // namespace
}  // namespace supple::surface
