#pragma once

#include <string>

namespace supple {

/// A number for a sentence: six significant digits at most, without trailing zeros, and with an exponent where that is
/// shorter ("0.3", "12000", "1e-09", "1e+30").
std::string number_text(double value);

}  // namespace supple
