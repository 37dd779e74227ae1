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

/// The number that a whole cell is; none if it is no number or not finite. `decimal` is '.' or ','. Complete groups of
/// thousands may be separated by the other one of the two, by non-breaking blanks, by apostrophes, and, if
/// `blank_thousands`, by plain blanks. Typographic minus signs and full-width digits count as plain ones.
std::optional<WrittenNumber> number_in(std::string_view cell, char decimal, bool blank_thousands);

/// What a cell says about the decimal separator of its file.
enum class DecimalEvidence : std::uint8_t {
  none,       ///< it is no number, or the same number with either separator
  point,      ///< it is a number only with a decimal point
  comma,      ///< it is a number only with a decimal comma
  ambiguous,  ///< it is a different number with each separator, as "1,234"
};
DecimalEvidence decimal_evidence(std::string_view cell, bool blank_thousands);

/// Whether a cell is a common mark for a missing number, e.g. "nan", "-" or "n/a".
bool is_missing_mark(std::string_view cell);

}  // namespace supple::design
