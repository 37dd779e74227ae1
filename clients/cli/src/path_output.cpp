#include "path_output.h"

#include <fmt/format.h>

#include <iterator>

namespace supple::cli {

std::string paths_as_obj(const nlohmann::json& paths) {
  std::string text = "# paths on the surface, one polyline each\n";
  auto out = std::back_inserter(text);
  std::int64_t next_index = 1;  // OBJ counts from 1
  for (const auto& path : paths) {
    if (path.size() < 2) continue;
    for (const auto& point : path) {
      const auto& p = point.at("position");
      fmt::format_to(out, "v {} {} {}\n", p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>());
    }
    text += 'l';
    for (std::size_t i = 0; i < path.size(); ++i) fmt::format_to(out, " {}", next_index++);
    text += '\n';
  }
  return text;
}

}  // namespace supple::cli
