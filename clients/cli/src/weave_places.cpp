#include "weave_places.h"

#include <fmt/format.h>

#include "failure.h"
#include "numbers.h"

namespace supple::cli {
namespace {

[[noreturn]] void refuse(const std::string& text) {
  throw Failure(ExitCode::usage,
                fmt::format("'{}' is no place: write c12 for a crossing, 3@5.2 for 5.2 mm along strand 3, 3:start or "
                            "3:end for its ends, or a box xmin,ymin,xmax,ymax",
                            text));
}

}  // namespace

nlohmann::json parse_place(const std::string& text) {
  const std::string_view view(text);
  if (view.starts_with('c')) {
    const auto crossing = integer_in(view.substr(1));
    if (!crossing) refuse(text);
    return {{"crossing", *crossing}};
  }
  if (const std::size_t at = view.find('@'); at != std::string_view::npos) {
    const auto strand = integer_in(view.substr(0, at));
    const auto coordinate = numbers_in(view.substr(at + 1));
    if (!strand || !coordinate || coordinate->size() != 1) refuse(text);
    return {{"strand", *strand}, {"coordinate", coordinate->front()}};
  }
  if (const std::size_t colon = view.find(':'); colon != std::string_view::npos) {
    const auto strand = integer_in(view.substr(0, colon));
    const std::string_view end = view.substr(colon + 1);
    if (!strand || (end != "start" && end != "end")) refuse(text);
    return {{"strand", *strand}, {"share", end == "start" ? 0 : 1}};
  }
  const auto corners = numbers_in(view);
  if (!corners || corners->size() != 4) refuse(text);
  const auto& c = *corners;
  return {{"box", {{c[0], c[1]}, {c[2], c[3]}}}};
}

PlacedVector parse_placed_vector(const std::string& text, const char* what, Dimension dimension) {
  const std::size_t equals = text.find('=');
  auto vector = equals == std::string::npos ? std::nullopt
                                            : quantities_in(std::string_view(text).substr(equals + 1), {dimension});
  if (!vector || vector->size() < 2 || vector->size() > 3)
    throw Failure(ExitCode::usage,
                  fmt::format("'{}' is no {}: write PLACE=x,y or PLACE=x,y,z, for example c12=0,-1.5", text, what));
  vector->resize(3, 0);
  return {parse_place(text.substr(0, equals)), *vector};
}

}  // namespace supple::cli
