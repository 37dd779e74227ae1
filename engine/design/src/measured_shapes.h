#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "supple/base/cancellation.h"
#include "supple/design/measured_table.h"

// How the lines of a file are divided into cells, and which of them are numbers.
namespace supple::design {

inline constexpr std::size_t lines_between_checks = 4096;

struct TableFormat {
  char delimiter = ',';
  char decimal = '.';
  /// A plain blank may separate thousands only where cells are not separated by blanks, or by commas.
  bool blanks() const { return delimiter == ';' || delimiter == '\t'; }
};

/// What a cell holds: 'N' a number, 'E' nothing, 'M' a mark for no number, 'T' another text.
char cell_kind(std::string_view cell, TableFormat format);

/// The kinds of a line's cells in their order.
std::string shape_of(std::string_view line, TableFormat format);

std::size_t count_kind(std::string_view shape, char kind);

/// The delimiter, and the decimal separator that the request or all numbers of the file tell. Throws as read_table.
TableFormat format_of(std::span<const std::string_view> lines, std::optional<char> decimal,
                      const CancellationToken& cancellation);

[[noreturn]] void refuse_table(const std::string& message);

}  // namespace supple::design
