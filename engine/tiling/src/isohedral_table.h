#pragma once

#include <span>
#include <string_view>

namespace supple::tiling {

/// One row of the table of isohedral types, as isohedral_types.cpp reads it.
struct IsohedralRow {
  int number;
  int parameters;
  int placements;
  /// For each edge its class (J, S, U or I), the letter of its shape, and "t" and "m" if it is turned and mirrored.
  std::string_view edges;
  std::span<const double> numbers;
};

std::span<const IsohedralRow> isohedral_rows();

}  // namespace supple::tiling
