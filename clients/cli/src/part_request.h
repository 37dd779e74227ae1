#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "session.h"

// Parts: their outlines by size, their structures from designs, and their files.
namespace supple::cli {

/// The files of a part that are wanted: their names, "-" for the terminal, empty for none.
struct PartFiles {
  std::string step;
  std::string stl;
  std::string three_mf;
  std::string dxf;
  std::string svg;
};

/// An outline from its kind (coupon, block or rectangle) and its size in mm, such as "20x60". Throws Failure(usage),
/// which names the option.
nlohmann::json outline_of_size(const std::string& kind, const std::string& size, const char* option);

/// The same from "KIND:SIZE", such as "coupon:20x60".
nlohmann::json parse_sized_outline(const std::string& text, const char* option);

/// Sets the structure of a part from a design of an answer of /v1/designs: family, parameters, width of the beams,
/// orientation and density. If the part has an axis of load, being a coupon or a block or with an `axis`, and no
/// direction yet, its direction is that of the design's load; where the design has no single one, a notice says along
/// which direction the part is loaded. Other parts take no direction. `source` names the design in messages. Throws
/// Failure(local_file) if it is no design, or if its direction is missing.
void use_design(const nlohmann::json& design, const std::string& source, nlohmann::json& request);

/// Writes the files of a part. Returns whether one of them went to the terminal.
bool write_part(Session& session, const nlohmann::json& request, const PartFiles& files);

/// The name of the `index`-th of `count` files for each file that is wanted.
PartFiles numbered_files(const PartFiles& files, std::size_t index, std::size_t count);

/// Describes a part. The request tells the axis of its load and what lies between its solid ends.
void print_part(const nlohmann::json& request, const nlohmann::json& answer);

}  // namespace supple::cli
