#include "supple/design/measured_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "supple/base/error.h"

namespace supple::design {
namespace {

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

TEST(MeasuredTable, AnswersInUtf8WhateverTheTextIsWrittenIn) {
  EXPECT_EQ(read_table("Dehnung [\xB5\x65],b\n1,2\n2,3\n").columns[0].unit,
            "\xC2\xB5"
            "e")
      << "Latin-1";
  EXPECT_EQ(read_table("\xCF\x83 [MPa],b\n1,2\n2,3\n").columns[0].name, "\xCF\x83") << "UTF-8";
  EXPECT_EQ(read_table("a\xED\xA0\x80,b\n1,2\n2,3\n").columns[0].name, "a\xC3\xAD\xC2\xA0\xC2\x80") << "a surrogate";
}

TEST(MeasuredTable, ChoosesColumnsByName) {
  using Pair = std::pair<std::size_t, std::size_t>;
  const MeasuredTable named = read_table("Time,Load (N),Extension (mm),Strain\n0,1,2,3\n1,2,3,4\n");
  EXPECT_EQ(choose_columns(named, {}, {}), Pair(2, 1));
  EXPECT_EQ(choose_columns(named, "strain", {}), Pair(3, 1));
  EXPECT_EQ(choose_columns(named, 0, "EXTENSION"), Pair(0, 2));
  EXPECT_EQ(choose_columns(named, {}, 2), Pair(3, 2)) << "the other column about a length";
  const MeasuredTable bare = read_table("0,1,2\n1,2,3\n");
  EXPECT_EQ(choose_columns(bare, {}, {}), Pair(0, 1));
  EXPECT_EQ(choose_columns(bare, 2, {}), Pair(2, 0));
  EXPECT_EQ(choose_columns(bare, {}, 0), Pair(1, 0));
  for (const auto& [x, y, place] : {std::tuple<ColumnChoice, ColumnChoice, const char*>{3, {}, "columns/x"},
                                    {-1, {}, "columns/x"},
                                    {{}, "stress", "columns/y"}}) {
    try {
      choose_columns(bare, x, y);
      ADD_FAILURE() << place;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "design.invalid_measurement");
      EXPECT_EQ(error.details().at(0).where, place);
    }
  }
}

TEST(MeasuredTable, RefusesTextWithoutRows) {
  for (const char* text : {"", "hello\nworld\n", "1\n2\n3\n", "a,b\nc,d\n"}) {
    try {
      read_table(text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "design.unreadable_table");
      EXPECT_EQ(error.details().at(0).where, "text");
    }
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
