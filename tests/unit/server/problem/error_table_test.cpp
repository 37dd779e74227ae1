#include "supple/problem/error_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

namespace supple::problem {
namespace {

std::string content(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// What the codes of the table begin with, up to the dot.
const std::set<std::string_view>& families() {
  static const auto found = [] {
    std::set<std::string_view> all;
    for (const auto& kind : error_table()) all.insert(kind.code.substr(0, kind.code.find('.')));
    return all;
  }();
  return found;
}

/// Endings of files' names: "model.md" has the form of a code, and is none.
constexpr std::array<std::string_view, 4> endings{"csv", "json", "md", "svg"};

/// Names of random sequences, which have the form of codes.
constexpr std::array<std::string_view, 1> sequences{"design.family_atlas"};

/// Whether a string literal has the form of a code: a family, a dot, and lower-case letters or underscores.
bool is_code(std::string_view literal) {
  const auto dot = literal.find('.');
  if (dot == std::string_view::npos || dot + 1 == literal.size()) return false;
  if (!families().contains(literal.substr(0, dot))) return false;
  if (std::find(endings.begin(), endings.end(), literal.substr(dot + 1)) != endings.end()) return false;
  if (std::find(sequences.begin(), sequences.end(), literal) != sequences.end()) return false;
  return literal.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", dot + 1) == std::string_view::npos;
}

/// The text of a source file without its #include lines, because the name of a header ("job.h") has the form of a code.
std::string without_includes(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string text;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("#include")) text += line + '\n';
  }
  return text;
}

/// All codes in the sources of the engine and the server: texts of this form between two quotation marks of one line.
std::set<std::string> codes_in_sources() {
  std::set<std::string> codes;
  for (const char* folder : {"engine", "server"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(SUPPLE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      const auto text = without_includes(entry.path());
      for (auto quote = text.find('"'); quote != std::string::npos; quote = text.find('"', quote + 1)) {
        const auto end = text.find_first_of("\"\n", quote + 1);
        if (end == std::string::npos) break;
        const auto literal = std::string_view(text).substr(quote + 1, end - quote - 1);
        if (is_code(literal)) codes.emplace(literal);
      }
    }
  }
  return codes;
}

TEST(ErrorTable, HasEveryCodeThatTheSourcesThrow) {
  const auto codes = codes_in_sources();
  ASSERT_GT(codes.size(), 40U);
  for (const auto& code : codes) EXPECT_EQ(error_kind(code).code, code) << "api/errors.yaml lacks it";
}

TEST(ErrorTable, HasNoCodeTwiceAndOnlyErrorStatuses) {
  std::set<std::string_view> seen;
  for (const auto& kind : error_table()) {
    EXPECT_TRUE(seen.insert(kind.code).second) << kind.code;
    EXPECT_GE(kind.status, 400) << kind.code;
    EXPECT_LT(kind.status, 600) << kind.code;
    EXPECT_FALSE(kind.title.empty()) << kind.code;
    EXPECT_TRUE(kind.hint.ends_with('.')) << kind.code;
  }
}

TEST(ErrorTable, IsTheFileRowByRow) {
  const auto text = content(std::filesystem::path(SUPPLE_SOURCE_DIR) / "api" / "errors.yaml");
  std::size_t rows = 0;
  for (auto at = text.find("\n  - code: "); at != std::string::npos; at = text.find("\n  - code: ", at + 1)) ++rows;
  EXPECT_EQ(error_table().size(), rows);
  for (const auto& kind : error_table()) {
    const auto row = "  - code: " + std::string(kind.code) + "\n    status: " + std::to_string(kind.status) +
                     "\n    title: " + std::string(kind.title) + "\n    hint: " + std::string(kind.hint) + "\n";
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

TEST(ErrorTable, AnswersAnUnknownCodeAsAnInternalError) {
  EXPECT_EQ(error_kind("no.such_code").code, "server.internal");
  EXPECT_EQ(error_kind("no.such_code").status, 500);
}

}  // namespace
}  // namespace supple::problem
