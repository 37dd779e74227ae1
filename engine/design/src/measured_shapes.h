#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/design/measured_table.h"

// How the lines of a file are divided into cells, and which of these are numbers.
namespace supple::design {

/// Number of lines between two checks for a stop request.
inline constexpr std::size_t lines_between_checks = 4096;

struct TableFormat {
  char delimiter = ',';
  char decimal = '.';
  /// Whether a plain blank may separate thousands. It may not if blanks or commas separate the cells.
  bool blank_thousands() const { return delimiter == ';' || delimiter == '\t'; }
};

/// The kind of a cell: 'N' a number, 'E' empty, 'M' a mark for a missing number, 'T' other text.
char cell_kind(std::string_view cell, TableFormat format);

/// The kinds of a line's cells in their order.
std::string shape_of(std::string_view line, TableFormat format);

std::size_t count_kind(std::string_view shape, char kind);

/// The delimiter, and the decimal separator that the request or the numbers of the file determine. Throws what
/// read_table throws.
TableFormat format_of(std::span<const std::string_view> lines, std::optional<char> decimal,
                      const CancellationToken& cancellation);

[[noreturn]] void refuse_table(const std::string& message);

}  // namespace supple::design
