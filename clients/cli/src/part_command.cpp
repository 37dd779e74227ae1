#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "angles.h"
#include "commands.h"
#include "drawing_arguments.h"
#include "failure.h"
#include "numbers.h"
#include "session.h"

namespace supple::cli {
namespace {

struct PartArguments {
  std::string family;
  std::string parameters;
  std::string request_file;
  std::string design_file;
  std::string coupon;
  std::string block;
  std::string rectangle;
  std::string outline;
  std::vector<std::string> regions;
  DrawingArguments drawing;
  double grip = -1;
  double plate = -1;
  double beam_width = 0;
  std::string orientation;
  std::string direction;
  std::string axis;
  double frame = -1;
  double seam = -1;
  double smallest_wall = -1;
  double thickness = 0;
  double density = 0;
  bool whole = false;
  std::string step_file;
  std::string stl_file;
  std::string three_mf_file;
  std::string dxf_file;
  std::string svg_file;
};

/// Two lengths in mm, such as "20x60".
std::pair<double, double> parse_size(const std::string& text, const char* option) {
  const std::size_t cross = text.find('x');
  const auto first = numbers_in(std::string_view(text).substr(0, cross));
  const auto second = cross == std::string::npos ? std::nullopt : numbers_in(std::string_view(text).substr(cross + 1));
  if (!first || !second || first->size() != 1 || second->size() != 1)
    throw Failure(ExitCode::usage,
                  fmt::format("{}: '{}' is no size: write two lengths in mm, for example 20x60", option, text));
  return {first->front(), second->front()};
}

nlohmann::json outline_of(const PartArguments& arguments) {
  if (!arguments.coupon.empty()) {
    const auto [width, length] = parse_size(arguments.coupon, "--coupon");
    nlohmann::json coupon = {{"width", width}, {"length", length}};
    if (arguments.grip >= 0) coupon["grip_length"] = arguments.grip;
    return {{"coupon", coupon}};
  }
  if (!arguments.block.empty()) {
    const auto [width, height] = parse_size(arguments.block, "--block");
    nlohmann::json block = {{"width", width}, {"height", height}};
    if (arguments.plate >= 0) block["plate"] = arguments.plate;
    return {{"block", block}};
  }
  const auto [width, height] = parse_size(arguments.rectangle, "--rectangle");
  return {{"rectangle", {width, height}}};
}

nlohmann::json object_in(const std::string& file) {
  auto object = nlohmann::json::parse(read_file(file), nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw Failure(ExitCode::local_file, fmt::format("{} holds no JSON object", file));
  return object;
}

/// The only direction along which a design is loaded; null if its profiles are over directions or have several ones.
nlohmann::json load_direction(const nlohmann::json& design) {
  nlohmann::json direction = design.at("profile").value("direction", nlohmann::json());
  for (const auto& further : design.at("also")) {
    if (further.value("direction", nlohmann::json()) != direction) return nullptr;
  }
  return direction;
}

/// Sets the structure from a file with the output of `supple design --json`. If the part has an axis of load, the
/// direction of the design's load lies along it.
void use_design(const std::string& file, bool has_load_axis, nlohmann::json& request) {
  const nlohmann::json design = object_in(file);
  try {
    request["structure"] = {{"family", design.at("family")}, {"parameters", design.at("parameters")}};
    request["beam_width"] = design.at("structure").at("beam_width");
    request["orientation"] = design.at("orientation");
    request["material"] = {{"density", design.at("material").at("density")}};
    if (const auto direction = load_direction(design); has_load_axis && !direction.is_null())
      request["direction"] = direction;
  } catch (const nlohmann::json::exception&) {
    throw Failure(ExitCode::local_file, fmt::format("{} holds no design: write one by supple design --json", file));
  }
}

nlohmann::json request_of(const PartArguments& arguments, Session& session) {
  nlohmann::json request = nlohmann::json::object();
  if (!arguments.request_file.empty()) request = object_in(arguments.request_file);
  if (!arguments.axis.empty()) request["axis"] = parse_angle(arguments.axis, "--axis");
  if (!arguments.design_file.empty()) {
    const bool has_axis = !arguments.coupon.empty() || !arguments.block.empty() || request.contains("axis");
    use_design(arguments.design_file, has_axis, request);
  }
  if (!arguments.family.empty()) request["structure"] = {{"family", arguments.family}};
  if (!arguments.parameters.empty())
    request["structure"]["parameters"] = parse_numbers(arguments.parameters, "list of parameters");
  const bool has_size = !arguments.coupon.empty() || !arguments.block.empty() || !arguments.rectangle.empty();
  if (has_size) request["outline"] = outline_of(arguments);
  if (arguments.outline.empty() && (!arguments.regions.empty() || arguments.drawing.any()))
    throw Failure(ExitCode::usage,
                  "--region, --unit, --width and --tolerance are about a drawing: give it with --outline");
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
  const auto set = [&request](const char* name, double value, double least) {
    if (value >= least) request[name] = value;
  };
  if (arguments.beam_width > 0) request["beam_width"] = arguments.beam_width;
  if (!arguments.orientation.empty()) request["orientation"] = parse_angle(arguments.orientation, "--orientation");
  if (!arguments.direction.empty()) request["direction"] = parse_angle(arguments.direction, "--direction");
  set("frame", arguments.frame, 0);
  set("seam", arguments.seam, 0);
  set("smallest_wall", arguments.smallest_wall, 0);
  if (arguments.thickness > 0) request["thickness"] = arguments.thickness;
  if (arguments.density > 0) request["material"] = {{"density", arguments.density}};
  if (arguments.whole) request["rim"] = "whole";
  return request;
}

/// The size of the structure of a coupon or a block, which has solid ends; empty for other outlines.
std::string size_between_ends(const nlohmann::json& outline) {
  const auto words = [](const nlohmann::json& shape, const char* length, const char* ends) {
    return fmt::format("; {:.6g} x {:.6g} mm between the {}", shape.at("width").get<double>(),
                       shape.at(length).get<double>(), ends);
  };
  if (outline.contains("coupon")) return words(outline.at("coupon"), "length", "grips");
  if (outline.contains("block")) return words(outline.at("block"), "height", "plates");
  return {};
}

/// Tells which direction of the design lies along the load, and how the structure was turned for that.
void print_load(const nlohmann::json& request, const nlohmann::json& answer) {
  const auto& direction = answer.at("tested_direction");
  if (direction.is_null()) return;
  constexpr double degrees = 180 / std::numbers::pi;
  const std::string axis = request.contains("axis") ? fmt::format("the part's axis of {:.4g} degrees",
                                                                  degrees * request["axis"].get<double>())
                                                    : "y";
  fmt::print("load     along the direction {:.6g} rad ({:.4g} degrees) of the design, which lies along {}\n",
             direction.get<double>(), degrees * direction.get<double>(), axis);
  const double turned = answer.at("orientation").get<double>() - request.value("orientation", 0.0);
  if (request.contains("direction") && std::abs(turned) > 1e-9) {
    fmt::print("         turned by {:.4g} degrees so that the design's load runs along the part\n", degrees * turned);
  }
}

void print_part(const nlohmann::json& request, const nlohmann::json& answer) {
  const auto number = [&answer](const char* name) { return answer.at(name).get<double>(); };
  const auto& size = answer.at("size");
  const auto& checks = answer.at("checks");
  fmt::print("size     {:.6g} x {:.6g} x {:.6g} mm{}\n", size.at(0).get<double>(), size.at(1).get<double>(),
             size.at(2).get<double>(), size_between_ends(request.at("outline")));
  fmt::print("solid    {:.6g} mm^2, {:.3g} of the outline\n", number("solid_area"), number("relative_density"));
  fmt::print("mass     {:.4g} g, {:.6g} mm^3\n", number("mass"), number("volume"));
  fmt::print("walls    {:.3g} mm^2 narrower than {:.3g} mm were left out\n", checks.at("trimmed_area").get<double>(),
             checks.at("smallest_wall").get<double>());
  const auto& neck = checks.at("smallest_neck");
  fmt::print("necks    {}; {} were widened, {} cut\n",
             neck.is_null() ? "none" : fmt::format("at least {:.3g} mm", neck.get<double>()),
             checks.at("widened_necks").get<int>(), checks.at("cut_necks").get<int>());
  print_load(request, answer);
  fmt::print("pieces   one; {} without connection to it were left out\n", checks.at("crumbs").get<int>());
  const auto message = answer.at("message").get<std::string>();
  if (!message.empty()) fmt::print("note     {}\n", message);
}

void run(const GlobalOptions& options, const PartArguments& arguments) {
  Session session(options);
  const nlohmann::json request = request_of(arguments, session);
  bool on_terminal = false;
  for (const auto& [file, media_type] :
       {std::pair(&arguments.stl_file, "model/stl"), std::pair(&arguments.three_mf_file, "model/3mf"),
        std::pair(&arguments.step_file, "model/step"), std::pair(&arguments.dxf_file, "image/vnd.dxf"),
        std::pair(&arguments.svg_file, "image/svg+xml")}) {
    if (file->empty()) continue;
    write_file(*file, session.compute("/v1/parts", request, media_type).body);
    on_terminal |= *file == "-";
  }
  if (on_terminal) return;
  const nlohmann::json answer = session.compute("/v1/parts", request).json();
  session.json() ? print_json(answer) : print_part(request, answer);
}

}  // namespace

void add_part_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<PartArguments>();
  CLI::App* command =
      program.add_subcommand("part", "A coupon, a block or any outline filled with a structure, as files");
  command->add_option("family", arguments->family, "Family of the tiling, see supple families");
  command->add_option("-p,--parameters", arguments->parameters,
                      "Parameters, separated by commas (the family's defaults)");
  auto* const coupon = command->add_option("--coupon", arguments->coupon,
                                           "Tensile coupon: width x length between its grips in mm, for example 20x60");
  auto* const block =
      command->add_option("--block", arguments->block, "Compression block: width x height between its plates in mm");
  auto* const rectangle = command->add_option("--rectangle", arguments->rectangle, "Sheet: width x height in mm");
  coupon->excludes(block)->excludes(rectangle);
  block->excludes(rectangle);
  command
      ->add_option("--outline", arguments->outline,
                   "Drawing, an SVG or DXF file: its closed curves, or FILE#NAME for those of an id or layer; where "
                   "every curve is a region, the part is their union")
      ->excludes(coupon)
      ->excludes(block)
      ->excludes(rectangle);
  command
      ->add_option("--region", arguments->regions,
                   "Closed curves of the drawing with a structure of their own: NAME=FAMILY[,WIDTH[,ANGLE]]")
      ->expected(1)
      ->take_all();
  add_drawing_options(*command, arguments->drawing);
  command->add_option("--grip", arguments->grip, "Length of each solid grip of a coupon in mm (15)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--plate", arguments->plate, "Thickness of each solid plate of a block in mm (1)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--request", arguments->request_file,
                      "A request as JSON: polygons, regions; options given besides take their fields' place");
  command
      ->add_option("--beam-width", arguments->beam_width,
                   "Width of the beams in mm, with which the structure scales (0.3)")
      ->check(CLI::PositiveNumber);
  command->add_option("--orientation", arguments->orientation,
                      "Angle by which the tiling is turned, for example 30deg (0)");
  command->add_option(
      "--direction", arguments->direction,
      "Direction of the design along which the part is loaded: it comes to lie along y in a coupon or a block, and "
      "along --axis otherwise (90deg)");
  command->add_option(
      "--axis", arguments->axis,
      "Direction in a drawing or a sheet along which the part will be loaded, for example 90deg (none)");
  command
      ->add_option("--design", arguments->design_file,
                   "A design as supple design --json prints it: its structure, walls, density, orientation and, if it "
                   "is loaded along one direction, that direction")
      ->excludes("family")
      ->excludes("--parameters");
  command->add_option("--frame", arguments->frame, "Width of a solid rim in mm (0)")->check(CLI::NonNegativeNumber);
  command->add_option("--seam", arguments->seam, "Width of solid strips between regions in mm (the beams')")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--smallest-wall", arguments->smallest_wall,
                   "Narrower walls are left out and necks widened to it, mm (two thirds of the beams)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--thickness", arguments->thickness, "Thickness in mm (1)")->check(CLI::PositiveNumber);
  command->add_option("--density", arguments->density, "Density of the material in g/cm^3 (1.2)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--whole", arguments->whole, "Keep only whole tiles instead of cutting them at the outline");
  command->add_option("--step", arguments->step_file, "Write a STEP file, - for the terminal");
  command->add_option("--stl", arguments->stl_file, "Write a binary STL file, - for the terminal");
  command->add_option("--3mf", arguments->three_mf_file, "Write a 3MF file, - for the terminal");
  command->add_option("--dxf", arguments->dxf_file, "Write a DXF file, - for the terminal");
  command->add_option("--svg", arguments->svg_file, "Write an SVG file, - for the terminal");
  command->footer(
      "Examples:\n  supple part IH21 --coupon 20x60 --beam-width 0.8 --thickness 4 --stl coupon.stl\n"
      "  supple part IH22 --outline sole.svg --region heel=IH29,0.5 --region forefoot=IH21,0.5,0.5rad --stl sole.stl\n"
      "  supple part --request sole.json --3mf sole.3mf\n"
      "  supple part --design design.json --coupon 20x60 --stl coupon.stl");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
