#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <span>
#include <string_view>

#include "supple/base/error.h"
#include "supple/design/measured_table.h"

namespace supple::design {
namespace {

using Column = MeasuredTable::Column;

// Words by which a header tells what a column holds, in lower case; German instruments are common.
constexpr std::array<std::string_view, 11> x_words{"strain",     "stretch",    "extension", "displacement",
                                                   "elongation", "angle",      "direction", "dehnung",
                                                   "weg",        "verformung", "winkel"};
constexpr std::array<std::string_view, 9> y_words{"stress",  "force", "load",     "modulus", "stiffness",
                                                  "poisson", "kraft", "spannung", "modul"};

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The first column but `other` whose name holds one of the words.
std::optional<std::size_t> column_about(const std::vector<Column>& columns, std::span<const std::string_view> words,
                                        std::optional<std::size_t> other) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (c == other) continue;
    const std::string name = lower_case(columns[c].name);
    const auto contains = [&name](std::string_view word) { return name.find(word) != std::string::npos; };
    if (std::any_of(words.begin(), words.end(), contains)) return c;
  }
  return std::nullopt;
}

std::string list_of(const std::vector<Column>& columns) {
  std::string list;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    list.append(list.empty() ? "" : ", ").append(std::to_string(c));
    if (!columns[c].name.empty()) list.append(" \"").append(columns[c].name).append("\"");
  }
  return list;
}

/// The column that a choice names, if it names one.
std::optional<std::size_t> column_of(const ColumnChoice& choice, const std::vector<Column>& columns,
                                     const std::string& place) {
  std::optional<std::size_t> found;
  if (const auto* index = std::get_if<int>(&choice)) {
    if (*index >= 0 && static_cast<std::size_t>(*index) < columns.size()) found = static_cast<std::size_t>(*index);
  } else if (const auto* name = std::get_if<std::string>(&choice)) {
    for (std::size_t c = 0; c < columns.size() && !found; ++c) {
      if (lower_case(columns[c].name) == lower_case(*name)) found = c;
    }
  } else {
    return std::nullopt;
  }
  if (!found) {
    const std::string text = "must be one of the table's columns " + list_of(columns);
    throw Error("design.invalid_measurement", place + ": " + text + ".", {{place, text}});
  }
  return found;
}

}  // namespace

std::pair<std::size_t, std::size_t> choose_columns(const MeasuredTable& table, const ColumnChoice& x,
                                                   const ColumnChoice& y) {
  auto at_x = column_of(x, table.columns, "columns/x");
  auto at_y = column_of(y, table.columns, "columns/y");
  if (!at_x) at_x = column_about(table.columns, x_words, at_y);
  if (!at_y) at_y = column_about(table.columns, y_words, at_x);
  // What no header tells apart: the first column, and the one after it.
  if (!at_x) at_x = at_y == std::size_t{0} ? 1 : 0;
  if (!at_y) at_y = *at_x + 1 < table.columns.size() ? *at_x + 1 : 0;
  return {*at_x, *at_y};
}

}  // namespace supple::design
