#include "supple/configuration/config_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "supple/configuration/nearest_name.h"

namespace supple::configuration {
namespace {

using Texts = std::vector<std::string>;

TEST(ConfigFile, HasTextsNumbersTruthValuesAndLists) {
  const auto file = parse_config(
      "# a comment\n"
      "\n"
      "host = \"0.0.0.0\"   # beyond this machine\r\n"
      "port=8081\n"
      "  client-share = 0.5\n"
      "open = true\n"
      "data = 'C:\\folder # no comment'\n"
      "keys = \"a \\\"quoted\\\" \\\\ name\"\n"
      "allowed-host = [\"a.example\", 'b.example',]\n"
      "allowed-origin = []");
  EXPECT_EQ(file.faults, Texts());
  ASSERT_EQ(file.settings.size(), 8U);
  EXPECT_EQ(file.settings[0].key, "host");
  EXPECT_EQ(file.settings[0].values, Texts{"0.0.0.0"});
  EXPECT_EQ(file.settings[0].line, 3);
  EXPECT_EQ(file.settings[1].values, Texts{"8081"});
  EXPECT_EQ(file.settings[2].values, Texts{"0.5"});
  EXPECT_EQ(file.settings[3].values, Texts{"true"});
  EXPECT_EQ(file.settings[4].values, Texts{"C:\\folder # no comment"});
  EXPECT_EQ(file.settings[5].values, Texts{"a \"quoted\" \\ name"});
  EXPECT_EQ(file.settings[6].values, (Texts{"a.example", "b.example"}));
  EXPECT_EQ(file.settings[7].values, Texts());
  EXPECT_EQ(file.settings[7].line, 10);
}

TEST(ConfigFile, NamesTheLineOfEachFault) {
  const auto file = parse_config(
      "[server]\n"
      "port 80\n"
      "port =\n"
      "max-body = 2GB\n"
      "host = \"open\n"
      "port = 1 2\n"
      "allowed-host = [\"a\"\n"
      "allowed-host = [\"a\" \"b\"]\n"
      "= 3\n"
      "data = \"\\n\"\n"
      "port = 1\n"
      "port = 2\n");
  const Texts expected{
      "line 1: sections in brackets are not used; write \"key = value\" lines alone",
      "line 2: after the key 'port' a \"=\" is expected",
      "line 3: the key 'port' has no value",
      "line 4: the value '2GB' is neither a number nor true or false; text needs quotes: \"2GB\"",
      "line 5: a quote is not closed in its line",
      "line 6: more than one value follows the key 'port'",
      "line 7: in the list of 'allowed-host' a \",\" or \"]\" is expected",
      "line 8: in the list of 'allowed-host' a \",\" or \"]\" is expected",
      "line 9: a key of letters, digits and hyphens is expected",
      "line 10: between double quotes a backslash may be followed by \\ or \" alone",
      "line 12: the key 'port' was given in line 11 already",
  };
  EXPECT_EQ(file.faults, expected);
  ASSERT_EQ(file.settings.size(), 1U);
  EXPECT_EQ(file.settings[0].values, Texts{"1"});
}

TEST(ConfigFile, ThatCannotBeReadIsNamed) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "supple-config-file-test.toml";
  std::filesystem::remove(path);
  try {
    read_config_file(path);
    FAIL() << "a file that does not exist was read";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path.string() + " cannot be read: No such file or directory");
  }
  EXPECT_THROW(read_config_file(::testing::TempDir()), std::runtime_error);
  std::ofstream(path) << std::string(max_config_bytes + 1, '#');
  EXPECT_THROW(read_config_file(path), std::runtime_error);
  std::ofstream(path) << "port = 1";
  EXPECT_EQ(read_config_file(path).settings.size(), 1U);
  std::filesystem::remove(path);
}

TEST(NearestName, IsFoundForASlipAndForNothingElse) {
  const Texts known{"max-vertices", "max-faces", "port", "SUPPLE_MAX_STORE"};
  EXPECT_EQ(nearest_name("max-vertice", known), "max-vertices");
  EXPECT_EQ(nearest_name("max_faces", known), "max-faces");
  EXPECT_EQ(nearest_name("SUPPLE_MAX_STOR", known), "SUPPLE_MAX_STORE");
  EXPECT_EQ(nearest_name("prot", known), std::nullopt) << "two of four letters are others";
  EXPECT_EQ(nearest_name("colour", known), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(1000, 'x'), known), std::nullopt);
  EXPECT_EQ(nearest_name("", known), std::nullopt);
}

}  // namespace
}  // namespace supple::configuration
