#pragma once

#include <cstdio>
#include <string>

namespace supple::cli {

/// The meaning of a text, which determines its colour.
enum class Style { error, warning, success, emphasis };

/// The text in the colour of its meaning if `stream` is a terminal, otherwise the text itself. The text has no colour
/// either if the environment variable NO_COLOR has any value or TERM is "dumb".
std::string styled(const std::string& text, Style style, std::FILE* stream = stdout);

/// Prints on standard error, after the program's name, why a command failed.
void print_failure(const std::string& message);

/// Prints a warning on standard error, after the program's name; the command goes on.
void print_notice(const std::string& message);

}  // namespace supple::cli
