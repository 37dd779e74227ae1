#include "supple/design/measured_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_text.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using testing::expect_error;
using testing::places;
using testing::text_or_places;
using Values = std::vector<double>;

struct Written {
  const char* name;
  const char* text;
  char delimiter;
  char decimal;
};

class TableFormats : public ::testing::TestWithParam<Written> {};

TEST_P(TableFormats, GiveTheSameNumbers) {
  const MeasuredTable table = read_table(GetParam().text);
  ASSERT_EQ(table.columns.size(), 2U);
  EXPECT_EQ(table.columns[0].values, (Values{0, 0.5, 1}));
  EXPECT_EQ(table.columns[1].values, (Values{0, -1.5, 20}));
  EXPECT_EQ(table.delimiter, GetParam().delimiter);
  EXPECT_EQ(table.decimal_separator, GetParam().decimal);
}

INSTANTIATE_TEST_SUITE_P(
    Measured, TableFormats,
    ::testing::Values(Written{"commas", "0,0\n0.5,-1.5\n1,2e1\n", ',', '.'},
                      Written{"semicolons", "0;0\r\n0.5;-1.5\r\n1;+20", ';', '.'},
                      Written{"tabs", "0\t0\n0.5\t-1.5\n1\t20\n", '\t', '.'},
                      Written{"blanks", "  0   0\n 0.5 \t -1.5\n1 20  \n", ' ', '.'},
                      Written{"decimal_commas", "0;0\n0,5;-1,5\n1;2e1\n", ';', ','},
                      Written{"decimal_commas_and_tabs", "0,0\t0,0\n0,5\t-1,5\n1,0\t20\n", '\t', ','},
                      Written{"decimal_commas_and_blanks", "0,0 0,0\n0,5 -1,5\n1,0 20\n", ' ', ','},
                      Written{"old_line_ends", "0,0\r0.5,-1.5\r1,20\r", ',', '.'},
                      Written{"quotes", "\"0\",\"0\"\n\"0.5\",\"-1.5\"\n\"1\", \"20\"\n", ',', '.'},
                      Written{"byte_order_mark",
                              "\xEF\xBB\xBF"
                              "0,0\n0.5,-1.5\n1,20\n",
                              ',', '.'}),
    [](const auto& format) { return format.param.name; });

TEST(MeasuredTable, NamesColumnsAndUnitsByItsHeader) {
  const MeasuredTable table = read_table("Strain [%];Stress (kPa);force/N;Zeit in s;load\n0;1;2;3;4\n5;6;7;8;9\n");
  ASSERT_EQ(table.columns.size(), 5U);
  const char* const names[] = {"Strain", "Stress", "force", "Zeit", "load"};
  const char* const units[] = {"%", "kPa", "N", "s", ""};
  for (std::size_t c = 0; c < 5; ++c) {
    EXPECT_EQ(table.columns[c].name, names[c]);
    EXPECT_EQ(table.columns[c].unit, units[c]);
  }
  EXPECT_EQ(table.skipped_lines, 0U);
}

TEST(MeasuredTable, ReadsUnitsFromALineOfTheirOwn) {
  const MeasuredTable table = read_table("Extension,Load,Note\n(mm),(N),\n0,0,\"a, b\"\n0.1,3,\n");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[0].name, "Extension");
  EXPECT_EQ(table.columns[0].unit, "mm");
  EXPECT_EQ(table.columns[1].unit, "N");
  EXPECT_TRUE(std::isnan(table.columns[2].values[0]));
}

TEST(MeasuredTable, SkipsWhatAnInstrumentWritesBeforeTheRows) {
  const MeasuredTable table = read_table("Specimen 3, width 10 mm\nOperator;A. B.\n\nstrain;stress\n0;0\n0,1;2,5\n\n");
  EXPECT_EQ(table.rows(), 2U);
  EXPECT_EQ(table.columns[1].name, "stress");
  EXPECT_EQ(table.columns[1].values, (Values{0, 2.5}));
  EXPECT_NE(table.remarks.find("Operator"), std::string::npos);
  EXPECT_EQ(table.skipped_lines, 2U) << "two remarks; empty lines do not count";
}

TEST(MeasuredTable, TakesNoPartsOfDecimalsForColumns) {
  const MeasuredTable table = read_table("0,0;0,0;0,0\n0,5;1,5;2,5\n1,5;2,5;3,5\n");
  ASSERT_EQ(table.columns.size(), 3U);
  EXPECT_EQ(table.columns[1].values, (Values{0, 1.5, 2.5}));
}

TEST(MeasuredTable, MarksCellsWithoutNumbers) {
  const MeasuredTable table = read_table("0,1,2\n1,,3\n2,nan,4\n3,inf,5\n");
  ASSERT_EQ(table.rows(), 4U);
  for (const std::size_t row : {1U, 2U, 3U}) EXPECT_TRUE(std::isnan(table.columns[1].values[row])) << row;
  EXPECT_EQ(table.columns[2].values, (Values{2, 3, 4, 5}));
}

TEST(MeasuredTable, SeparatesThousandsInEveryUsualWay) {
  for (const char* text : {"a;b\n1,800.50;2\n0.25;3\n", "a;b\n1.800,50;2\n0,25;3\n", "a;b\n1 800,50;2\n0,25;3\n",
                           "a;b\n1\xC2\xA0"
                           "800,50;2\n0,25;3\n",
                           "a;b\n1\xE2\x80\xAF"
                           "800,50;2\n0,25;3\n",
                           "a;b\n1'800.50;2\n0.25;3\n", "a,b\n\"1,800.50\",2\n0.25,3\n"})
    EXPECT_EQ(read_table(text).columns[0].values, (Values{1800.5, 0.25})) << text;
  EXPECT_EQ(read_table("1,234,567;1\n2;3\n").columns[0].values, (Values{1234567, 2})) << "two groups tell";
  EXPECT_EQ(read_table("0,123;1,234\n0,500;2,345\n").columns[1].values, (Values{1.234, 2.345}))
      << "a group that begins with zero is none, and all numbers of a file are written alike";
}

TEST(MeasuredTable, ReadsTypographicMinusSignsAndFullWidthDigits) {
  const MeasuredTable table = read_table(
      "\xE2\x88\x92"
      "1.5;2\n\xE2\x80\x93"
      "2;3\n\xEF\xBC\x91\xEF\xBC\x92;4\n");
  EXPECT_EQ(table.columns[0].values, (Values{-1.5, -2, 12}));
}

std::string place_of(const std::string& text, const TableOptions& options = {}) {
  return text_or_places([&] {
    read_table(text, options);
    return "nothing thrown";
  });
}

TEST(MeasuredTable, AsksWhereANumberMayBeReadInTwoWays) {
  for (const char* text : {"a;b\n1,234;2,345\n3,456;4,567\n", "a\tb\n1.234\t5\n2.345\t6\n", "0.5;1\n0,5;2\n"}) {
    EXPECT_EQ(place_of(text), "decimal_separator") << text;
    EXPECT_EQ(place_of(text, {',', {}}), "nothing thrown") << text;
  }
  EXPECT_EQ(read_table("a;b\n1,234;2,345\n", {',', {}}).columns[0].values, (Values{1.234}));
  EXPECT_EQ(read_table("a;b\n1,234;2,345\n", {'.', {}}).columns[0].values, (Values{1234}));
  EXPECT_EQ(read_table("a,b\n1.234,2.345\n").columns[0].values, (Values{1.234})) << "the commas are taken";
}

TEST(MeasuredTable, RefusesDecimalCommasBetweenSeparatingCommas) {
  EXPECT_EQ(place_of("Strain,Stress\n0,00,0,00\n0,05,1,20\n0,10,2,50\n"), "text");
  EXPECT_EQ(place_of("0,0\n0,5,1,5\n1,2,5\n1,5,3\n2,4,5\n2,5,6,25\n"), "text") << "whole numbers lose their commas";
}

TEST(MeasuredTable, ReadsUnitsWithoutBracketsInTitlesAndInALineOfTheirOwn) {
  const auto units = [](const char* text) {
    std::string out;
    for (const auto& column : read_table(text).columns) out += canonical_unit(column.unit) + "|";
    return out;
  };
  EXPECT_EQ(units("\"Time\",\"Force\",\"Stroke\"\n\"sec\",\"N\",\"mm\"\n0,0,0\n1,2,1\n"), "|N|mm|");
  EXPECT_EQ(units("Strain %,Stress kPa\n0,0\n1,2\n"), "%|kPa|");
  EXPECT_EQ(units("Force_N,Strain mm/mm\n0,0\n1,2\n"), "N|1|");
  EXPECT_EQ(units("Extension (mm),Load (KN)\n0,0\n1,2\n"), "mm|kN|");
  EXPECT_EQ(units("Extension,Load\nINCH,lbs\n0,0\n1,2\n"), "in|lbf|");
  EXPECT_EQ(units("Strain (Video) (%);Stress (MPa) 1\n0;0\n1;2\n"), "%|MPa|");
  EXPECT_EQ(units("# Strain % Stress kPa\n0 0\n1 2\n"), "%|kPa|");
  EXPECT_EQ(units("Strain (%)  Tensile stress (kPa)\n0 0\n1 2\n"), "%|kPa|");
  EXPECT_EQ(units("\"Strain\n(%)\",\"Stress\n(MPa)\"\n0,0\n1,2\n"), "%|MPa|") << "a title of two lines";
  EXPECT_EQ(units("a,b\n0.00%,1\n5.00%,2\n"), "%||") << "a spreadsheet's per cent";
  EXPECT_EQ(units("Strain 1,Stress 1\n0,0\n1,2\n"), "||") << "a digit counts specimens";
  EXPECT_EQ(units("Strain (furlong),Stress (mPa)\n0,0\n1,2\n"), "||") << "unknown, and a million times less";
}

TEST(MeasuredTable, TakesNoRemarksForRowsAndNoEndsOfRowsForColumns) {
  const MeasuredTable table = read_table(
      "Width (mm),20,Thickness (mm),4\nTime (s),Extension (mm),Load (N),Strain (%)\n"
      "0,0,0,0\n1,1,2,2\n2,2,5,4\n");
  EXPECT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.columns[3].name, "Strain");
  const MeasuredTable trailing = read_table("Strain (%),Stress (kPa)\n0,0,\n5,21,\n10,50,\n");
  ASSERT_EQ(trailing.columns.size(), 2U);
  EXPECT_EQ(trailing.columns[1].unit, "kPa");
}

TEST(MeasuredTable, ReadsOneBlockOfSeveralSpecimens) {
  const std::string blocks =
      "SID,\"A\"\n1,Time,Tensile stress,Tensile strain\n,(s),(kPa),(%)\n,\"0\",\"0\",\"0\"\n"
      ",\"1\",\"21\",\"5\"\n2,Time,Tensile stress,Tensile strain\n,(s),(kPa),(%)\n"
      ",\"0\",\"0\",\"0\"\n,\"1\",\"18\",\"5\"\n,\"2\",\"44\",\"10\"\n";
  const MeasuredTable first = read_table(blocks);
  EXPECT_EQ(first.blocks, 2U);
  EXPECT_EQ(first.columns[2].values, (Values{0, 21}));
  const MeasuredTable second = read_table(blocks, {{}, 1});
  EXPECT_EQ(second.columns[2].values, (Values{0, 18, 44}));
  EXPECT_EQ(second.columns[2].unit, "kPa");
  EXPECT_EQ(place_of(blocks, {{}, 2}), "block");
  // A block ends at a text or an empty line between the rows where the strain starts again.
  for (const char* gap : {"Specimen 2\n", "\n"}) {
    const auto text = std::string("Strain (%),Stress (kPa)\n0,0\n5,21\n10,50\n") + gap + "0,0\n5,18\n";
    EXPECT_EQ(read_table(text).rows(), 3U) << gap;
    EXPECT_EQ(read_table(text, {{}, 1}).columns[0].unit, "%") << gap;
  }
  EXPECT_EQ(read_table("a,b\n0,0\n5,21\nEvent,pause\n10,50\n").rows(), 3U) << "the test goes on";
  EXPECT_EQ(read_table("a,b\n0,0\n\n5,21\n\n10,50\n").rows(), 3U) << "empty lines between all rows";
}

TEST(MeasuredTable, CountsLinesThatDoNotReadLikeRows) {
  const MeasuredTable table = read_table("a,b\n0,0\n1,ERR\n2,3\n4,5,6\n7,8\n");
  EXPECT_EQ(table.rows(), 3U);
  EXPECT_EQ(table.malformed_lines, 2U);
}

TEST(MeasuredText, IsDecodedFromWhatMachinesWrite) {
  const auto encoding = [](const std::string& bytes) { return decode_text(bytes).encoding; };
  EXPECT_EQ(encoding("Temp [\xB0"
                     "C]"),
            "windows-1252");
  EXPECT_EQ(decode_text("Temp [\xB0"
                        "C]")
                .text,
            "Temp [\xC2\xB0"
            "C]");
  EXPECT_EQ(decode_text("Pr\xFC"
                        "fgr\xF6\xDF"
                        "e \x80")
                .text,
            "Pr\xC3\xBC"
            "fgr\xC3\xB6\xC3\x9F"
            "e \xE2\x82\xAC");
  EXPECT_EQ(decode_text("\xD3\xA6\xB1\xE4(%)").text, "\xE5\xBA\x94\xE5\x8F\x98(%)") << "GBK";
  EXPECT_EQ(decode_text(std::string("\xFF\xFE"
                                    "a\0"
                                    "\xB5\0",
                                    6))
                .text,
            "a\xC2\xB5");
  EXPECT_EQ(decode_text(std::string("\xFE\xFF"
                                    "\0a",
                                    4))
                .text,
            "a");
  EXPECT_EQ(decode_text(std::string("1\0"
                                    ",\0"
                                    "2\0",
                                    6))
                .encoding,
            "utf-16")
      << "without a mark";
  EXPECT_EQ(decode_text("\xEF\xBB\xBF"
                        "a")
                .text,
            "a");
  EXPECT_EQ(encoding("\xCF\x83 [MPa]"), "utf-8");
  EXPECT_EQ(encoding("a\xED\xA0\x80"), "windows-1252") << "a surrogate is no UTF-8";
  EXPECT_TRUE(is_utf8(decode_text("\xD3\xA6\xB1\xE4\xFF\xFF").text));
}

/// The chosen columns of a table, and "said" if there is a note; the places of the error if the choice fails.
std::string chosen(const char* text, Task task = Task::stress_strain, const ColumnChoice& x = {},
                   const ColumnChoice& y = {}) {
  return text_or_places([&] {
    const auto columns = choose_columns(read_table(text), task, x, y);
    return std::to_string(columns.x) + "," + std::to_string(columns.y) + (columns.note.empty() ? "" : " said");
  });
}

TEST(MeasuredColumns, AreFoundByTitlesAndUnits) {
  const char* const named = "Time,Load (N),Extension (mm),Strain\n0,1,2,3\n1,2,3,4\n";
  EXPECT_EQ(chosen(named), "3,1");
  EXPECT_EQ(chosen(named, Task::stress_strain, "strain"), "3,1");
  EXPECT_EQ(chosen(named, Task::stress_strain, 2), "2,1");
  EXPECT_EQ(chosen(named, Task::stress_strain, 0, "LOAD"), "0,1");
  EXPECT_EQ(chosen(named, Task::stress_strain, 0, "load (n)"), "0,1") << "with its unit";
  EXPECT_EQ(chosen("Time (s),Load (N),Displacement (mm),Stress (MPa),Strain (%)\n0,0,0,0,0\n1,2,1,0.1,2\n"), "4,3");
  EXPECT_EQ(chosen("Time (s),Position (mm),Load (N)\n0,0,0\n1,1,2\n"), "1,2");
  EXPECT_EQ(chosen("\xE6\x97\xB6\xE9\x97\xB4(s);\xE5\x8A\x9B(N);\xE5\x8F\x98\xE5\xBD\xA2(mm)\n0;0;0\n1;2;3\n"), "2,1")
      << "Chinese";
  EXPECT_EQ(chosen("Aika (s);Venym\xC3\xA4 (%);J\xC3\xA4nnitys (MPa)\n0;0;0\n1;2;3\n"), "1,2") << "by units alone";
  EXPECT_EQ(chosen("1;2\n3;4\n"), "0,1 said") << "two columns";
  EXPECT_EQ(chosen("Venym\xC3\xA4;J\xC3\xA4nnitys\n0;0\n1;2\n"), "0,1 said") << "two columns of an unknown language";
  EXPECT_EQ(chosen("Strain 1 (%),Stress 1 (MPa),Strain 2 (%),Stress 2 (MPa)\n0,0,0,0\n1,2,1,3\n"), "0,1 said");
  EXPECT_EQ(
      chosen("Strain 1 (%),Stress 1 (MPa),Strain 2 (%),Stress 2 (MPa)\n0,0,0,0\n1,2,1,3\n", Task::stress_strain, 2),
      "2,3 said")
      << "the stress beside it";
  EXPECT_EQ(chosen("\xCE\xB5 [%];\xCF\x83 [MPa]\n0;0\n1;2\n"), "0,1");
  EXPECT_EQ(chosen("angle (deg)\tPoisson's ratio\n0\t1\n2\t3\n", Task::poisson), "0,1");
  EXPECT_EQ(chosen("Winkel [rad];E-Modul [MPa]\n0;1\n2;3\n", Task::stiffness), "0,1");
}

TEST(MeasuredColumns, AreNeverTimesIndicesOrOtherThings) {
  EXPECT_EQ(chosen("Time (s),Force (N)\n0,0\n1,2\n"), "columns/x");
  EXPECT_EQ(chosen("sec,N\n0,0\n1,2\n"), "columns/x");
  EXPECT_EQ(chosen("Index,Stress (MPa)\n0,0\n1,2\n"), "columns/x");
  EXPECT_EQ(chosen(",Strain (%),Stress (MPa)\n0,0,0\n1,1,2\n"), "1,2") << "an index without a title";
  EXPECT_EQ(chosen("0,1,2\n1,2,3\n"), "columns/x columns/y") << "three columns without titles";
  EXPECT_EQ(chosen("Time (s),Strain rate (%),Stress (MPa)\n0,0,0\n1,2,3\n"), "columns/x");
  EXPECT_EQ(chosen("Transverse strain (%),Stress (MPa)\n0,0\n1,2\n"), "columns/x");
  EXPECT_EQ(chosen("Humidity (%),Extension (mm),Load (N)\n0,0,0\n1,2,3\n"), "1,2");
  EXPECT_EQ(chosen("Width (mm),Extension (mm),Load (N)\n0,0,0\n1,2,3\n"), "1,2");
  EXPECT_EQ(chosen("True strain (%),True stress (MPa)\n0,0\n1,2\n"), "columns/x columns/y");
  EXPECT_EQ(chosen("True strain (%),Stress (MPa)\n0,0\n1,2\n", Task::stress_strain, 0), "0,1 said");
  EXPECT_EQ(chosen("Foo (%),Bar (%),Baz (MPa)\n0,0,0\n1,2,3\n"), "columns/x") << "two of a kind";
  EXPECT_EQ(chosen("1,2,3\n2,3,4\n", Task::stress_strain, 3), "columns/x");
  EXPECT_EQ(chosen("1,2,3\n2,3,4\n", Task::stress_strain, -1), "columns/x");
  EXPECT_EQ(chosen("1,2,3\n2,3,4\n", Task::stress_strain, 0, "stress"), "columns/y");
}

TEST(MeasuredTable, RefusesTextWithoutRows) {
  for (const char* text : {"", "hello\nworld\n", "1\n2\n3\n", "a,b\nc,d\n", "1,2,x\nx,1,2\n1,x,2\n"}) {
    const Error error = expect_error<MeasurementFault>("design.unreadable_table", [&] { read_table(text); });
    EXPECT_EQ(places(error), std::vector<std::string>{"text"}) << text;
  }
}

TEST(MeasuredTable, RefusesMoreRowsThanItsLimit) {
  std::string text;
  for (int i = 0; i < 1'000'001; ++i) text += "1,2\n";
  EXPECT_THROW(read_table(text), Error);
  text.resize(text.size() - 4);
  EXPECT_EQ(read_table(text).rows(), 1'000'000U);
}

TEST(MeasuredTable, RefusesMoreColumnsThanItsLimit) {
  std::string line = "1";
  for (int i = 1; i < 256; ++i) line += ",1";
  EXPECT_EQ(read_table(line).columns.size(), 256U);
  EXPECT_THROW(read_table(line + ",1"), Error);
}

}  // namespace
}  // namespace supple::design
