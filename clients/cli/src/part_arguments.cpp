#include "part_arguments.h"

#include "angles.h"
#include "failure.h"
#include "idle_options.h"
#include "numbers.h"
#include "part_request.h"
#include "units.h"

namespace supple::cli {
namespace {

nlohmann::json sized_outline(const PartArguments& arguments) {
  if (!arguments.coupon.empty()) return outline_of_size("coupon", arguments.coupon, "--coupon");
  if (!arguments.block.empty()) return outline_of_size("block", arguments.block, "--block");
  return outline_of_size("rectangle", arguments.rectangle, "--rectangle");
}

/// The shape of an outline that the request has, such as "coupon"; null if it has another one.
nlohmann::json* shape_in(nlohmann::json& request, const char* name) {
  const auto outline = request.find("outline");
  if (outline == request.end() || !outline->is_object()) return nullptr;
  const auto shape = outline->find(name);
  return shape == outline->end() || !shape->is_object() ? nullptr : &*shape;
}

/// Sets the lengths of solid ends and refuses what has no effect on this part.
void finish_outline(const CLI::App& command, const PartArguments& arguments, nlohmann::json& request) {
  nlohmann::json* const coupon = shape_in(request, "coupon");
  nlohmann::json* const block = shape_in(request, "block");
  const auto regions = request.find("regions");
  const bool has_regions = regions != request.end() && !regions->empty();
  const bool has_rest = request.at("outline") != nlohmann::json{{"regions", true}};
  constexpr const char* no_rest = "where the part is the union of its regions, which have structures of their own";
  refuse_idle_options(command, {{"--grip", coupon != nullptr, "without --coupon"},
                                {"--plate", block != nullptr, "without --block"},
                                {"--seam", has_regions, "without regions"},
                                {"family", has_rest, no_rest},
                                {"--parameters", has_rest, no_rest},
                                {"--from", has_rest, no_rest},
                                {"--beam-width", has_rest, no_rest},
                                {"--orientation", has_rest, no_rest}});
  if (coupon != nullptr && arguments.grip >= 0) (*coupon)["grip_length"] = arguments.grip;
  if (block != nullptr && arguments.plate >= 0) (*block)["plate"] = arguments.plate;
}

void add_outline_options(CLI::App& command, PartArguments& arguments) {
  auto* const coupon =
      command
          .add_option("--coupon", arguments.coupon,
                      "Tensile coupon: width x length between its grips in mm, for example 20x60 or 20mmx6cm")
          ->transform(quantity(Dimension::length));
  auto* const block =
      command.add_option("--block", arguments.block, "Compression block: width x height between its plates in mm")
          ->transform(quantity(Dimension::length));
  auto* const rectangle = command.add_option("--rectangle", arguments.rectangle, "Sheet: width x height in mm")
                              ->transform(quantity(Dimension::length));
  coupon->excludes(block)->excludes(rectangle);
  block->excludes(rectangle);
  command
      .add_option("--outline", arguments.outline,
                  "Drawing, an SVG or DXF file: its closed curves, or FILE#NAME for those of an id or layer; where "
                  "every curve is a region, the part is their union")
      ->excludes(coupon)
      ->excludes(block)
      ->excludes(rectangle);
  command
      .add_option("--region", arguments.regions,
                  "Closed curves of the drawing with a structure of their own: NAME=FAMILY[,WIDTH[,ANGLE]]")
      ->expected(1)
      ->take_all();
  add_drawing_options(command, arguments.drawing);
  command.add_option("--grip", arguments.grip, "Length of each solid grip of a coupon in mm (15)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
  command.add_option("--plate", arguments.plate, "Thickness of each solid plate of a block in mm (1)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
}

}  // namespace

nlohmann::json part_request(const CLI::App& command, const PartArguments& arguments, Session& session) {
  nlohmann::json request = nlohmann::json::object();
  if (!arguments.request_file.empty()) request = object_in_file(arguments.request_file);
  const bool has_size = !arguments.coupon.empty() || !arguments.block.empty() || !arguments.rectangle.empty();
  if (has_size) request["outline"] = sized_outline(arguments);
  if (!arguments.outline.empty()) request.erase("outline");  // that of the drawing takes its place
  if (request.value("axis", nlohmann::json()).is_null()) request.erase("axis");
  if (!arguments.axis.empty()) request["axis"] = parse_angle(arguments.axis, "--axis");
  if (!arguments.design_file.empty()) request.erase("direction");  // it belongs to the structure that is replaced
  if (!arguments.direction.empty()) request["direction"] = parse_angle(arguments.direction, "--direction");
  if (!arguments.design_file.empty()) use_design(object_in_file(arguments.design_file), arguments.design_file, request);
  if (!arguments.family.empty()) request["structure"] = {{"family", arguments.family}};
  if (!arguments.parameters.empty())
    request["structure"]["parameters"] = parse_numbers(arguments.parameters, "list of parameters");
  if (arguments.outline.empty() && (!arguments.regions.empty() || arguments.drawing.any()))
    throw Failure(
        ExitCode::usage,
        "--region, --unit, --resolution, --width and --tolerance are about a drawing: give it with --outline");
  const bool has_structure =
      request.contains("structure") || (!arguments.outline.empty() && !arguments.regions.empty());
  if (!has_structure || !(request.contains("outline") || !arguments.outline.empty())) {
    throw Failure(
        ExitCode::usage,
        "no part: give a family or a design and --outline, --coupon, --block or --rectangle, or a file with --request");
  }
  if (!arguments.outline.empty()) {
    const auto [file, name] = drawing_choice(arguments.outline);
    use_drawing(read_drawing(session, file, arguments.drawing), name, arguments.regions, request);
    if (!request.contains("structure")) {
      throw Failure(ExitCode::usage,
                    "no part: curves of the drawing belong to no region; give a family or a design that fills them");
    }
  }
  finish_outline(command, arguments, request);
  const auto set = [&request](const char* name, double value, double least) {
    if (value >= least) request[name] = value;
  };
  if (arguments.beam_width > 0) request["beam_width"] = arguments.beam_width;
  if (!arguments.orientation.empty()) request["orientation"] = parse_angle(arguments.orientation, "--orientation");
  set("frame", arguments.frame, 0);
  set("seam", arguments.seam, 0);
  set("smallest_wall", arguments.smallest_wall, 0);
  if (arguments.thickness > 0) request["thickness"] = arguments.thickness;
  if (arguments.density > 0) request["material"] = {{"density", arguments.density}};
  if (arguments.whole) request["rim"] = "whole";
  return request;
}

void add_part_options(CLI::App& command, PartArguments& arguments) {
  command.add_option("family", arguments.family, "Family of the tiling, see supple families");
  command.add_option("-p,--parameters", arguments.parameters,
                     "Parameters, separated by commas (the family's defaults)");
  add_outline_options(command, arguments);
  command.add_option("--request", arguments.request_file,
                     "A request as JSON: polygons, regions; options given besides take their fields' place");
  command
      .add_option("--beam-width", arguments.beam_width,
                  "Width of the beams in mm, with which the structure scales (0.3)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command.add_option("--orientation", arguments.orientation,
                     "Angle by which the tiling is turned, for example 30deg (0)");
  command.add_option(
      "--direction", arguments.direction,
      "Direction of the design along which the part is loaded: it comes to lie along y in a coupon or a block, and "
      "along --axis otherwise (none: nothing is turned)");
  command.add_option("--axis", arguments.axis,
                     "Direction in a drawing or a sheet along which the part will be loaded, for example 90deg (none)");
  command
      .add_option("--from,--design", arguments.design_file,
                  "A design as supple design --json prints it: its structure, width of beams, density, orientation "
                  "and, if it is loaded along one direction, that direction")
      ->excludes("family")
      ->excludes("--parameters");
  command.add_option("--frame", arguments.frame, "Width of a solid rim in mm (0)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
  command.add_option("--seam", arguments.seam, "Width of solid strips between regions in mm (the beams')")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--smallest-wall", arguments.smallest_wall,
                  "Narrower walls are left out and necks widened to it, mm (two thirds of the beams)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
  command.add_option("--thickness", arguments.thickness, "Thickness in mm (1)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command.add_option("--density", arguments.density, "Density of the material in g/cm^3 (1.2)")
      ->transform(quantity(Dimension::density))
      ->check(CLI::PositiveNumber);
  command.add_flag("--whole", arguments.whole, "Keep only whole tiles instead of cutting them at the outline");
}

}  // namespace supple::cli
