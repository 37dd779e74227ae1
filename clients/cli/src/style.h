#pragma once

#include <cstdio>
#include <string>

namespace supple::cli {

/// What a text means, from which its colour follows.
enum class Style { error, warning, success, emphasis };

/// The text in the colour of its meaning, where `stream` is a terminal that shows colours. Elsewhere the text itself,
/// and also where the environment's NO_COLOR is set to anything or TERM is "dumb".
std::string styled(const std::string& text, Style style, std::FILE* stream = stdout);

/// Says on standard error, after the program's name, what made a command fail.
void print_failure(const std::string& message);

/// Says on standard error, after the program's name, what a user should know although the command goes on.
void print_notice(const std::string& message);

}  // namespace supple::cli
