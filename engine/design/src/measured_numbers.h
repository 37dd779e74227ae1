#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

// Numbers as instruments and spreadsheets write them.
namespace supple::design {

struct WrittenNumber {
  double value = 0;
  bool has_percent = false;  ///< whether the cell ends with "%"
};

/// The number that a whole cell is. `decimal` is '.' or ','. Thousands may be separated by the other of the two, by
/// blanks, by blanks that do not break, or by apostrophes, where every group is complete; typographic minus signs and
/// full-width digits count as the plain ones. Nothing where it is none, or is not finite. `blanks`: whether a plain
/// blank may separate thousands.
std::optional<WrittenNumber> number_in(std::string_view cell, char decimal, bool blanks);

/// What a cell tells about the decimal separator of its file.
enum class DecimalEvidence : std::uint8_t {
  none,       ///< it is no number, or the same one with either separator
  point,      ///< it is a number with decimal points alone
  comma,      ///< it is a number with decimal commas alone
  ambiguous,  ///< it is a different number with each: "1,234"
};
DecimalEvidence decimal_evidence(std::string_view cell, bool blanks);

/// Whether a cell is a common way to write that there is no number: "nan", "-", "n/a".
bool is_missing_mark(std::string_view cell);

}  // namespace supple::design
