#include "style.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace supple::cli {
namespace {

bool shows_colors(std::FILE* stream) {
  const char* const no_color = std::getenv("NO_COLOR");
  if (no_color != nullptr && *no_color != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return false;
  return isatty(fileno(stream)) == 1;
}

/// Codes of ECMA-48 (Select Graphic Rendition) for the sixteen standard colours, which follow the palette of the user's
/// terminal.
const char* code_of(Style style) {
  switch (style) {
    case Style::error:
      return "1;31";
    case Style::warning:
      return "33";
    case Style::success:
      return "32";
    case Style::emphasis:
      return "1";
  }
  return "0";
}

}  // namespace

std::string styled(const std::string& text, Style style, std::FILE* stream) {
  return shows_colors(stream) ? fmt::format("\033[{}m{}\033[0m", code_of(style), text) : text;
}

void print_failure(const std::string& message) {
  fmt::print(stderr, "{} {}\n", styled("supple:", Style::error, stderr), message);
}

void print_notice(const std::string& message) {
  fmt::print(stderr, "{} {}\n", styled("supple:", Style::warning, stderr), message);
}

}  // namespace supple::cli
