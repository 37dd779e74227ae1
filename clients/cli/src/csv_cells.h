#pragma once

#include <nlohmann/json.hpp>
#include <string>

// JSON values as cells of a CSV file.
namespace supple::cli {

/// The text of a cell with this value; null gives an empty cell.
inline std::string cell_text(const nlohmann::json& value) {
  if (value.is_null()) return {};
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Adds the entries of an array, each after a comma.
inline void append_cells(std::string& line, const nlohmann::json& values) {
  for (const auto& value : values) line += ',' + cell_text(value);
}

/// Adds the entries of a square matrix row by row, each after a comma; all are empty if the matrix is null.
inline void append_matrix(std::string& line, const nlohmann::json& rows, int size) {
  for (int i = 0; i < size; ++i) {
    for (int k = 0; k < size; ++k) line += ',' + (rows.is_null() ? "" : cell_text(rows.at(i).at(k)));
  }
}

}  // namespace supple::cli
