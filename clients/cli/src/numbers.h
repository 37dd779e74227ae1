#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple::cli {

/// Numbers separated by commas, such as "0.1,-2,3e-4"; nothing if one of them is malformed or not finite.
std::optional<std::vector<double>> numbers_in(std::string_view text);

/// Numbers separated by commas. Throws Failure(usage) that quotes the text and names `what`.
std::vector<double> parse_numbers(const std::string& text, const char* what);

/// One number. Throws Failure(usage) that quotes the text and names `what`.
double parse_number(const std::string& text, const char* what);

/// Numbers separated by commas, or "first:last:n" for n of them at equal distances, both ends included. Throws
/// Failure(usage) that quotes the text and names `what`.
std::vector<double> parse_series(const std::string& text, const char* what);

/// The number as an index that counts from 0. Throws Failure(usage) that quotes `text` and names `what`, such as
/// "point".
std::int64_t index_of(double number, const std::string& text, const char* what);

/// Indices separated by commas. Throws as index_of does.
std::vector<std::int64_t> parse_indices(const std::string& text, const char* what);

/// The integer that the whole text is, or nothing.
std::optional<std::int64_t> integer_in(std::string_view text);

}  // namespace supple::cli
