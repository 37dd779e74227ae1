#include "supple/json/part_simulations.h"

#include <variant>

#include "answer_parts.h"
#include "part_fields.h"
#include "request_parts.h"
#include "simulation_fields.h"
#include "supple/microscale/part_files.h"
#include "supple/microscale/part_strain.h"
#include "supple/microscale/vtu.h"

namespace supple::json {
namespace {

using microscale::Clamp;
using microscale::PartState;
using microscale::Plate;
using microscale::Support;

// The ranges of api/openapi.yaml.
constexpr std::size_t max_part_supports = 100;
constexpr double max_support_length = 2000;  // mm; of gaps and displacements
constexpr double max_box_coordinate = 4000;  // mm
constexpr double min_part_strain = -0.9;
constexpr double max_part_strain = 4;
constexpr double min_pressure_length = 0.01;  // mm

/// The strain at the end of the path to which a coupon is stretched, and with the other sign a block is pressed.
constexpr double default_strain = 0.2;
/// The boxes of default clamps are larger than the grips by this much, mm, because grips without a length are lines
/// and the coordinates of parts are rounded.
constexpr double clamp_margin = 1e-6;

void read_displacement(Fields& fields, Eigen::Vector2d& displacement) {
  if (const auto* value = fields.optional("displacement"))
    read_components(*value, fields.at("displacement"), fields.faults(), displacement, -max_support_length,
                    max_support_length);
}

Plate read_plate(Fields& fields) {
  Plate plate;
  fields.required("side");
  fields.choice("side", plate.side, side_names);
  fields.number("gap", plate.gap, 0, max_support_length);
  fields.choice("friction", plate.friction, friction_names);
  read_displacement(fields, plate.displacement);
  return plate;
}

Clamp read_clamp(Fields& fields) {
  Clamp clamp;
  if (const auto* corners = fields.array("box", true, 2, 2, "")) {
    const auto read = [&](std::size_t k, Eigen::Vector2d& corner) {
      read_components((*corners)[k], fields.at("box") + "/" + std::to_string(k), fields.faults(), corner,
                      -max_box_coordinate, max_box_coordinate);
    };
    read(0, clamp.lower);
    read(1, clamp.upper);
  }
  read_displacement(fields, clamp.displacement);
  return clamp;
}

Support read_part_support(const Document& value, const std::string& pointer, Faults& faults) {
  enum class Kind { plate, clamp };
  Fields fields(value, pointer, faults);
  Kind kind = Kind::plate;
  fields.required("kind");
  fields.choice("kind", kind, names_of<Kind>({{Kind::plate, "plate"}, {Kind::clamp, "clamp"}}));
  Support support = kind == Kind::plate ? Support(read_plate(fields)) : Support(read_clamp(fields));
  fields.finish();
  return support;
}

/// The supports of a coupon or a block, of which the upper one moves along y so that the structure between the solid
/// ends has this strain.
std::vector<Support> default_supports(const PartRequest& part, bool is_block, double strain) {
  const tiling::Polygon& outline = part.design.outline.at(0);
  const Eigen::Vector2d upper = outline.at(2);
  const double end = part.design.solids.empty() ? 0 : part.design.solids.at(0).at(2).y();
  const Eigen::Vector2d displacement(0, strain * (upper.y() - 2 * end));
  if (is_block) {
    Plate bottom, top;
    top.side = microscale::Side::top;
    top.displacement = displacement;
    return {bottom, top};
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(clamp_margin);
  const Clamp lower_grip{-margin, Eigen::Vector2d(upper.x(), end) + margin, Eigen::Vector2d::Zero()};
  const Clamp upper_grip{Eigen::Vector2d(0, upper.y() - end) - margin, upper + margin, displacement};
  return {lower_grip, upper_grip};
}

/// Reads the supports, or takes those that a coupon or a block has by default. The part has been read.
void read_supports(Fields& fields, PartSimulationRequest& request) {
  const bool is_block = !request.part.solid_names.empty() && request.part.solid_names.front() == "lower_plate";
  const bool has_ends = !request.part.solid_names.empty();
  if (fields.present("supports")) {
    if (const auto* entries = fields.array("supports", true, 1, max_part_supports, "")) {
      for (std::size_t i = 0; i < entries->size(); ++i)
        request.supports.push_back(
            read_part_support((*entries)[i], fields.at("supports") + "/" + std::to_string(i), fields.faults()));
    }
    if (fields.optional("strain"))
      fields.faults().add(fields.at("strain"), R"(is for what supports a coupon or a block without "supports")");
    return;
  }
  double strain = is_block ? -default_strain : default_strain;
  fields.number("strain", strain, min_part_strain, max_part_strain);
  if (!has_ends) {
    // The fault of an outline that could not be read is told already.
    if (!request.part.design.outline.empty() || request.part.design.outline_of_regions)
      fields.faults().add(fields.at("supports"), R"(is required: only a "coupon" and a "block" have some by default)");
    return;
  }
  if (is_block && strain > 0)
    fields.faults().add(fields.at("strain"), "must not be positive for a block, since plates push and never pull");
  if (request.part.design.outline.empty()) return;
  request.has_default_supports = true;
  request.supports = default_supports(request.part, is_block, strain);
}

void read_part_options(Fields& fields, const Limits& limits, PartSimulationRequest& request) {
  microscale::PartSimulationOptions& options = request.options;
  read_material(fields, options.material);
  fields.integer("states", options.states, 1, static_cast<int>(limits.max_states));
  fields.choice("deformed", request.deformed, deformed_part_names);
  fields.boolean("svg", request.svg);
  nested(fields, "accuracy", [&](Fields& accuracy) {
    read_mesh_sizes(accuracy, request.mesh);
    read_path_accuracy(accuracy, options);
    accuracy.number("pressure_length", options.pressure_length, min_pressure_length, max_support_length);
  });
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("contact", options.contact, switch_names);
    effects.choice("buckling", options.buckling, switch_names);
    effects.choice("error_estimate", request.error_estimate, switch_names);
  });
  options.thickness = request.part.design.thickness;
  options.deformed_nodes = request.svg || request.deformed != DeformedPart::none;
}

/// The parts of an answer that are the same in all states, and whether states have pictures.
struct DeformedWriter {
  const PartSimulationRequest& request;
  const tiling::PeriodicMesh& mesh;
  microscale::PictureFrame frame{};

  void write(JsonWriter& out, const PartState& state) const {
    if (request.deformed == DeformedPart::obj) out.field("obj", microscale::write_part_obj(mesh, state.displacements));
    if (request.deformed == DeformedPart::vtu)
      out.field("vtu", microscale::write_part_vtu(mesh, state.displacements, request.options.material));
    if (request.deformed == DeformedPart::json) {
      out.key("deformed").begin_object().key("points");
      write_rows(out, (mesh.nodes + state.displacements).transpose().eval());
      out.key("strains").numbers(microscale::triangle_strains(mesh, state.displacements)).end_object();
    }
    if (request.svg) out.field("svg", microscale::write_part_svg(mesh, state.displacements, frame));
  }
};

void write_support(JsonWriter& out, const Support& support) {
  out.begin_object();
  if (const auto* plate = std::get_if<Plate>(&support)) {
    out.field("kind", "plate").field("side", side_names.name_of(plate->side)).field("gap", plate->gap);
    out.field("friction", friction_names.name_of(plate->friction)).key("displacement").numbers(plate->displacement);
  } else {
    const Clamp& clamp = std::get<Clamp>(support);
    out.field("kind", "clamp").key("box").begin_array().numbers(clamp.lower).numbers(clamp.upper).end_array();
    out.key("displacement").numbers(clamp.displacement);
  }
  out.end_object();
}

void write_support_state(JsonWriter& out, const microscale::SupportState& support, double pressure_length) {
  out.begin_object().key("force").numbers(support.force).key("displacement").numbers(support.displacement);
  out.field("touching", support.touching).key("pressure");
  if (support.pressure) {
    out.begin_object().field("length", pressure_length).key("positions").numbers(support.pressure->positions);
    out.key("values").numbers(support.pressure->values).end_object();
  } else {
    out.null();
  }
  out.end_object();
}

/// `deformed` is null where the state is written without its displacements.
void write_part_state(JsonWriter& out, const PartSimulationRequest& request, const PartState& state,
                      const DeformedWriter* deformed) {
  out.begin_object().field("share", state.fraction).field("stopped", microscale::to_string(state.stopped));
  write_number_or_null(out, "residual", state.residual);
  out.field("iterations", state.iterations).field("load_steps", state.load_steps).key("supports").begin_array();
  for (const auto& support : state.supports) write_support_state(out, support, request.options.pressure_length);
  out.end_array().field("energy", state.energy).field("stable", state.stable).field("branch", state.branch);
  out.field("contacts", state.contacts).field("largest_strain", state.largest_strain);
  if (deformed) deformed->write(out, state);
  out.end_object();
}

void write_rest_mesh(JsonWriter& out, const tiling::PeriodicMesh& mesh) {
  out.key("mesh").begin_object().key("points");
  write_rows(out, mesh.nodes.transpose().eval());
  out.key("triangles").begin_array();
  for (const auto& triangle : mesh.triangles) write_indices(out, triangle);
  out.end_array().end_object();
}

void write_part_accuracy(JsonWriter& out, const PartSimulationRequest& request,
                         const PartSimulationOutcome& simulated) {
  double residual = 0;
  for (const PartState& state : simulated.result.states) {
    // Unlike std::max, this keeps a value that is not a number.
    if (!(state.residual <= residual)) residual = state.residual;
  }
  out.key("accuracy").begin_object().field("tolerance", request.options.tolerance);
  write_number_or_null(out, "residual", residual);
  out.key("discretization_error");
  if (const auto& error = simulated.mesh_error) {
    out.begin_object().field("force", error->force).field("energy", error->energy).end_object();
  } else {
    out.null();
  }
  out.field("mesh_size", request.mesh.mesh_size)
      .field("corner_size", request.mesh.corner_size)
      .field("nodes", simulated.result.nodes)
      .field("triangles", simulated.mesh.triangles.size())
      .field("unknowns", simulated.result.unknowns)
      .end_object();
}

}  // namespace

PartSimulationRequest parse_part_simulation(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation) {
  return read_request<PartSimulationRequest>(body, limits, cancellation,
                                             [&](Fields& fields, PartSimulationRequest& request) {
                                               if (const auto* value = fields.required("part")) {
                                                 Fields part(*value, fields.at("part"), fields.faults());
                                                 read_part(part, limits, request.part);
                                                 part.finish();
                                               }
                                               read_supports(fields, request);
                                               request.mesh.max_nodes = limits.max_part_nodes;
                                               read_part_options(fields, limits, request);
                                             });
}

std::string write_part_simulation(const PartSimulationRequest& request, const PartSimulationOutcome& simulated,
                                  const Bill& bill) {
  const auto& states = simulated.result.states;
  DeformedWriter deformed{request, simulated.mesh};
  if (request.svg) deformed.frame = microscale::picture_frame(simulated.mesh, states);
  JsonWriter out;
  out.begin_object().key("part").begin_object();
  write_solid(out, simulated.part);
  write_missing_solids(out, request.part, simulated.part);
  out.field("message", part_message(request.part, simulated.part)).end_object();
  out.key("supports").begin_array();
  for (const Support& support : request.supports) write_support(out, support);
  out.end_array().key("states").begin_array();
  for (const PartState& state : states) write_part_state(out, request, state, &deformed);
  out.end_array();
  if (request.deformed == DeformedPart::json) write_rest_mesh(out, simulated.mesh);
  out.field("message", simulated.result.message).field("fixed_translation", simulated.result.fixed_translation);
  write_part_accuracy(out, request, simulated);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_partial_part_simulation(const PartSimulationRequest& request, int number, const PartState& state) {
  JsonWriter out;
  out.begin_object().field("number", number).field("states", request.options.states).key("state");
  write_part_state(out, request, state, nullptr);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
