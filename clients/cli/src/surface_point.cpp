#include "surface_point.h"

#include <fmt/format.h>

#include <string_view>

#include "failure.h"
#include "numbers.h"

namespace supple::cli {
namespace {

[[noreturn]] void reject(const std::string& text) {
  throw Failure(ExitCode::usage,
                fmt::format("'{}' is not a surface point: write v17 for a vertex, 12:0.2,0.3,0.5 for a face and its "
                            "barycentric coordinates, or @1,2.5,-3 for the point nearest to a point in space",
                            text));
}

std::int64_t read_index(std::string_view part, const std::string& whole) {
  const auto index = integer_in(part);
  if (!index || *index < 0) reject(whole);
  return *index;
}

}  // namespace

nlohmann::json parse_surface_point(const std::string& text) {
  const std::string_view view = text;
  if (view.starts_with('v')) return {{"vertex", read_index(view.substr(1), text)}};
  if (view.starts_with('@')) {
    const auto position = numbers_in(view.substr(1));
    if (!position || position->size() != 3) reject(text);
    return {{"position", *position}};
  }
  const std::size_t colon = view.find(':');
  if (colon == std::string_view::npos) reject(text);
  auto barycentric = numbers_in(view.substr(colon + 1));
  if (!barycentric || barycentric->size() < 2 || barycentric->size() > 3) reject(text);
  if (barycentric->size() == 2) barycentric->push_back(1 - (*barycentric)[0] - (*barycentric)[1]);
  return {{"face", read_index(view.substr(0, colon), text)}, {"barycentric", *barycentric}};
}

std::string describe_surface_point(const nlohmann::json& point) {
  if (point.contains("vertex")) return fmt::format("vertex {}", point.at("vertex").get<std::int64_t>());
  if (!point.contains("face")) {
    const auto& p = point.at("position");
    return fmt::format("the point nearest to ({:.9g}, {:.9g}, {:.9g})", p.at(0).get<double>(), p.at(1).get<double>(),
                       p.at(2).get<double>());
  }
  const auto& b = point.at("barycentric");
  return fmt::format("face {} ({:.9g}, {:.9g}, {:.9g})", point.at("face").get<std::int64_t>(), b.at(0).get<double>(),
                     b.at(1).get<double>(), b.at(2).get<double>());
}

void print_points_in_space(const nlohmann::json& answer) {
  if (!answer.contains("points_in_space")) return;
  for (const auto& placed : answer.at("points_in_space")) {
    fmt::print("point in space  {} lies {:.6g} from the surface, nearest to {}\n",
               placed.at("pointer").get<std::string>(), placed.at("distance").get<double>(),
               describe_surface_point(placed));
  }
}

}  // namespace supple::cli
