#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "session.h"

namespace supple::cli {

/// The options that say how a drawing is read.
struct DrawingArguments {
  std::string unit;
  double resolution = 0;
  double width = 0;
  double tolerance = 0;

  bool any() const { return !unit.empty() || resolution > 0 || width > 0 || tolerance > 0; }
};

void add_drawing_options(CLI::App& command, DrawingArguments& arguments);

/// The server's answer for the text of an SVG or DXF file; its warnings go to standard error. Throws Failure.
nlohmann::json read_drawing(Session& session, const std::string& file, const DrawingArguments& arguments);

/// A drawing and the name of the curves in it: "FILE", or "FILE#NAME" if no file has that whole name.
struct DrawingChoice {
  std::string file, name;
};
DrawingChoice drawing_choice(const std::string& text);

/// Puts the outline and the regions of a drawing into a request for a part. A region is NAME=FAMILY[,WIDTH[,ANGLE]].
/// The outline consists of the polygons with the name `outline_name`, or of all that belong to no region; where there
/// are none, it is the union of the regions, and the part needs no other structure. Throws
/// Failure(usage), which lists the names in the drawing if a name is unknown.
void use_drawing(const nlohmann::json& drawing, const std::string& outline_name,
                 const std::vector<std::string>& regions, nlohmann::json& request);

}  // namespace supple::cli
