// Feeds arbitrary bytes to the request parsers. The first byte, from 0 to E in the seeds, chooses the parser; the
// others are the body. A parser must return a request within the limits or throw an Error, and the problem document for
// a client must be valid JSON in UTF-8.

#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "supple/json/answers.h"
#include "supple/json/embedded_system_requests.h"
#include "supple/json/family_checks.h"
#include "supple/json/family_definitions.h"
#include "supple/json/model_requests.h"
#include "supple/json/part_simulations.h"
#include "supple/json/requests.h"
#include "supple/json/structure_requests.h"
#include "supple/json/trainings.h"
#include "supple/json/voronoi_requests.h"
#include "supple/json/weave_requests.h"
#include "supple/json/weave_toolpath_requests.h"
#include "supple/tiling/isohedral_types.h"

namespace {

using namespace supple;

constexpr surface::MeshLimits mesh_limits{.vertices = 50, .faces = 50};

json::Limits limits() {
  json::Limits result;
  result.max_values = 2000;
  result.max_pairs = 20;
  result.max_points = 20;
  result.max_springs = 20;
  result.max_path_points = 40;
  result.max_states = 20;
  result.max_strains = 20;
  result.max_strands = 20;
  result.max_strand_points = 50;
  result.max_gcode_lines = 20;
  result.max_deadline = 100;
  return result;
}

void require(bool condition) {
  if (!condition) std::abort();
}

void check_point(const json::PointSpec& point) {
  require(point.index >= 0);
  require(point.barycentric.allFinite());
  if (point.position) require(point.position->allFinite());
}

void check_deadline(double deadline) { require(deadline > 0 && deadline <= limits().max_deadline); }

void check_structure(const json::StructureSpec& structure) {
  require(!structure.family.empty() && structure.family.size() <= 32);
  if (!structure.parameters) return;
  require(structure.parameters->size() <= limits().max_parameters);
  for (const double parameter : *structure.parameters) require(std::isfinite(parameter));
}

/// A definition that was read is written so that it is read as the same again, and its check ends without an error.
void check_family(const tiling::FamilyDefinition& definition) {
  require(!definition.id.empty() && definition.id.size() <= 32);
  require(json::parse_family_definition(json::write_family_definition(definition), json::Limits()) == definition);
  tiling::check_definition(definition);
}

void check_design(const std::vector<double>& parameters) {
  require(!parameters.empty() && parameters.size() <= neural::max_parameters);
  for (const double parameter : parameters) require(std::isfinite(parameter));
}

void check_mesh(const tiling::MeshOptions& mesh) {
  require(mesh.mesh_size >= 0.01 && mesh.mesh_size <= 2 && mesh.corner_size > 0 && mesh.corner_size <= 1);
  require(mesh.max_nodes == limits().max_mesh_nodes);
}

void check_load(const microscale::Load& load) {
  const int states = microscale::size(load);
  require(states > 0 && states <= static_cast<int>(limits().max_states));
  if (const auto* strain = std::get_if<microscale::GreenStrainLoad>(&load)) {
    for (const auto& state : strain->strains) require(state.allFinite());
  } else if (const auto* uniaxial = std::get_if<microscale::UniaxialLoad>(&load)) {
    require(std::isfinite(uniaxial->direction));
    for (const double stretch : uniaxial->stretches) require(stretch > 0 && std::isfinite(stretch));
  } else {
    const auto& biaxial = std::get<microscale::BiaxialLoad>(load);
    require(std::isfinite(biaxial.direction));
    for (const auto& stretches : biaxial.stretches) require(stretches.allFinite() && stretches.minCoeff() > 0);
  }
}

void check_layout(const json::LayoutSpec& layout) {
  require(!layout.strands.empty() && layout.strands.size() <= limits().max_strands);
  std::size_t points = 0;
  for (const auto& strand : layout.strands) {
    points += strand.points.size();
    require(strand.translation.allFinite());
    for (const auto& point : strand.points) require(point.allFinite());
  }
  require(points <= limits().max_strand_points);
  if (layout.lattice) require(layout.lattice->allFinite());
  if (!layout.crossings) return;
  for (const auto& members : *layout.crossings) {
    require(members.size() >= 2);
    for (const auto& member : members) require(member.strand >= 0 && member.coordinate >= 0);
  }
}

void check_weave(const json::WeaveSpec& weave) {
  require(weave.radius > 0 && std::isfinite(weave.radius) && weave.material.youngs_modulus > 0);
  require(!weave.sliding_fraction || (*weave.sliding_fraction > 0 && *weave.sliding_fraction <= 1));
  for (const auto& change : weave.overrides) {
    require(change.crossing >= 0);
    for (const int member : change.slides) require(member >= 0);
    require(!change.range.forward || *change.range.forward >= 0);
  }
  if (const auto* layout = std::get_if<json::LayoutSpec>(&weave.source)) check_layout(*layout);
}

void check_sites(const json::SitesSpec& sites) {
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&sites)) {
    require(!given->empty() && given->size() <= limits().max_points);
    for (const auto& point : *given) check_point(point);
  } else {
    const auto count = std::get<json::RandomSites>(sites).count;
    require(count >= 1 && static_cast<std::size_t>(count) <= limits().max_points);
  }
}

void check_network(const json::EmbeddedSystemRequest& request) {
  if (const auto* points = std::get_if<std::vector<json::PointSpec>>(&request.points)) {
    require(!points->empty() && points->size() <= limits().max_points);
    for (const auto& point : *points) check_point(point);
  } else if (const auto* disks = std::get_if<embedded::PoissonDiskPoints>(&request.points)) {
    require(disks->radius > 0 && std::isfinite(disks->radius));
  } else {
    require(std::get<embedded::PointsInFaces>(request.points).barycentric.allFinite());
  }
  const auto check_spring = [](double rest_length, double weight) {
    require(rest_length >= 0 && std::isfinite(rest_length) && weight >= 0 && std::isfinite(weight));
  };
  if (const auto* springs = std::get_if<std::vector<embedded::Spring>>(&request.springs)) {
    require(springs->size() <= limits().max_springs);
    for (const auto& spring : *springs) {
      require(spring.from >= 0 && spring.to >= 0);
      check_spring(spring.rest_length, spring.weight);
    }
  } else {
    const auto& builder = std::get<embedded::NeighbourSprings>(request.springs);
    check_spring(builder.rest_length, builder.weight);
  }
  for (const auto point : request.fixed_points) require(point >= 0);
  if (const auto* triangles = std::get_if<0>(&request.triangles)) {
    require(triangles->size() <= limits().max_springs);
    for (const auto& corners : *triangles)
      for (const auto corner : corners) require(corner >= 0);
  }
  const auto& material = request.material;
  for (const double size : {material.youngs_modulus, material.thickness, request.rest_scale})
    require(size > 0 && std::isfinite(size));
  require(material.poisson_ratio > -1 && material.poisson_ratio < 0.5);
  const auto& options = request.options;
  require(options.tolerance > 0 && options.tolerance <= 1 && options.max_iterations >= 1);
  require(options.mollifier_length > 0 && options.mollifier_length <= 0.5);
}

/// Checks that the engine permits the options, since requests have the same ranges.
void check_options(const weave::EquilibriumOptions& options) {
  try {
    weave::validate(options);
  } catch (const Error&) {
    require(false);
  }
}

/// Checks the ranges of a printer profile. The engine may still refuse relations between fields, and bytes of a text.
void check_printer(const weave::PrinterProfile& printer) {
  require(printer.bed.minCoeff() > 0 && printer.strand_width > 0 && printer.filament_diameter > 0);
  require(printer.travel_speed > 0 && printer.lift.run > 0 && printer.startup_gcode.size() <= 20'000);
}

void check_part_simulation(const json::PartSimulationRequest& request) {
  check_structure(request.part.filling.structure);
  for (const auto& region : request.part.regions) check_structure(region.filling.structure);
  require(!request.supports.empty() && request.supports.size() <= 100);
  for (const auto& support : request.supports) {
    if (const auto* plate = std::get_if<microscale::Plate>(&support)) {
      require(plate->gap >= 0 && plate->displacement.allFinite());
    } else {
      const auto& clamp = std::get<microscale::Clamp>(support);
      require(clamp.lower.allFinite() && clamp.upper.allFinite() && clamp.displacement.allFinite());
    }
  }
  const auto& options = request.options;
  require(options.states >= 1 && static_cast<std::size_t>(options.states) <= limits().max_states);
  require(options.thickness > 0 && options.pressure_length > 0 && options.tolerance > 0 && options.max_load_step > 0);
  require(request.mesh.mesh_size > 0 && request.mesh.corner_size > 0 && request.mesh.corner_size <= 1);
}

void parse(unsigned which, std::string_view body) {
  switch (which % 22) {
    case 0: {
      const auto request = json::parse_geodesics(body, limits());
      require(request.mesh.size() == 64 && !request.pairs.empty() && request.pairs.size() <= limits().max_pairs);
      require(request.derivatives >= 0 && request.derivatives <= 2);
      require(request.mollifier_length > 0 && request.mollifier_length <= 0.5);
      for (const auto& pair : request.pairs) {
        check_point(pair.from);
        check_point(pair.to);
        for (const auto& point : pair.known_path) check_point(point);
      }
      return check_deadline(request.deadline);
    }
    case 1: {
      const auto request = json::parse_geodesic_field(body, limits());
      require(!request.sources.empty() && request.sources.size() <= limits().max_points);
      require(request.relative_error >= 0 && request.relative_error <= 1 && request.max_distance > 0);
      for (const auto& point : request.sources) check_point(point);
      return check_deadline(request.deadline);
    }
    case 2: {
      const auto request = json::parse_karcher_mean(body, limits());
      require(!request.points.empty() && request.points.size() <= limits().max_points);
      require(request.tolerance > 0 && request.tolerance <= 1 && request.max_iterations >= 1);
      for (const double weight : request.weights) require(std::isfinite(weight));
      for (const auto& point : request.points) check_point(point);
      return check_deadline(request.deadline);
    }
    case 3: {
      const auto request = json::parse_exponential_map(body, limits());
      require(request.tangent.size() == 2 || request.tangent.size() == 3);
      for (const double coordinate : request.tangent) require(std::isfinite(coordinate));
      check_point(request.start);
      return check_deadline(request.deadline);
    }
    case 4: {
      const auto upload = json::parse_mesh_arrays(body, limits(), mesh_limits, {});
      const auto& soup = upload.soup;
      if (upload.repair && upload.repair->weld_tolerance)
        require(*upload.repair->weld_tolerance >= 0 && *upload.repair->weld_tolerance <= 0.01);
      require(soup.positions.size() <= 50 && soup.faces.size() <= 50);
      for (const auto& position : soup.positions) require(position.allFinite());
      for (const auto& face : soup.faces) {
        for (const auto vertex : face) require(vertex >= 0);
      }
      return;
    }
    case 5: {
      const auto request = json::parse_structure(body, limits());
      check_structure(request.structure);
      require(request.files.first >= 1 && request.files.first <= 100);
      require(request.files.second >= 1 && request.files.second <= 100);
      require(request.files.height > 0 && request.files.height <= 1000);
      if (request.mesh) check_mesh(*request.mesh);
      return check_deadline(request.deadline);
    }
    case 7: {
      const auto request = json::parse_evaluation(body, limits());
      require(!request.designs.empty() && request.designs.size() <= limits().max_strains);
      for (const auto& design : request.designs) check_design(design);
      require(request.strains.cols() > 0 && request.strains.allFinite());
      require(request.strains.cols() <= static_cast<Eigen::Index>(limits().max_strains));
      require(request.order >= neural::Order::energy && request.order <= neural::Order::tangent);
      return check_deadline(request.deadline);
    }
    case 8: {
      const auto request = json::parse_uniaxial(body, limits());
      check_design(request.parameters);
      require(std::isfinite(request.direction));
      require(!request.green_strains.empty() && request.green_strains.size() <= limits().max_states);
      for (const double strain : request.green_strains) require(strain > -0.5 && std::isfinite(strain));
      require(request.options.tolerance > 0 && request.options.max_iterations > 0);
      return check_deadline(request.deadline);
    }
    case 9: {
      const auto request = json::parse_weave_layout(body, limits());
      check_weave(request.weave);
      return check_deadline(request.deadline);
    }
    case 10: {
      const auto request = json::parse_weave_homogenization(body, limits());
      check_weave(request.weave);
      check_options(request.options.equilibrium);
      require(!request.options.directions.empty() && request.options.strain != 0);
      for (const double direction : request.options.directions) require(std::isfinite(direction));
      for (const int index : request.options.deformed)
        require(index >= 0 && static_cast<std::size_t>(index) < request.options.directions.size());
      return check_deadline(request.deadline);
    }
    case 11: {
      const auto request = json::parse_weave_simulation(body, limits());
      check_weave(request.weave);
      check_options(request.options);
      require(!request.supports.empty() && request.states >= 1);
      for (const auto& support : request.supports) require(support.support.displacement.allFinite());
      for (const auto& force : request.forces) require(force.force.allFinite());
      return check_deadline(request.deadline);
    }
    case 12: {
      const auto request = json::parse_weave_toolpath(body, limits());
      check_weave(request.weave);
      check_printer(request.printer);
      const auto& options = request.options;
      require(options.overruns.size() == request.overrun_strands.size() && options.grips.size() <= 100);
      for (const auto& grip : options.grips) require(grip.from.allFinite() && grip.to.allFinite() && grip.width >= 0);
      for (const int strand : options.order) require(strand >= 0);
      require(options.chord_error > 0 && (!options.origin || options.origin->allFinite()));
      return check_deadline(request.deadline);
    }
    case 13: {
      const auto request = json::parse_gcode_report(body, limits());
      require(request.limits.bed.allFinite() && request.limits.filament_diameter > 0);
      return check_deadline(request.deadline);
    }
    case 14: {
      const auto request = json::parse_embedded_system(body, limits());
      check_network(request);
      return check_deadline(request.deadline);
    }
    case 15: {
      const auto request = json::parse_voronoi_diagram(body, limits());
      check_sites(request.sites);
      require(request.options.relative_error > 0 && request.options.relative_error <= 1);
      require(request.panel_scale > 0 && std::isfinite(request.panel_scale));
      return check_deadline(request.deadline);
    }
    case 16: {
      const auto request = json::parse_voronoi_optimization(body, limits());
      check_sites(request.sites);
      const auto& weights = request.options.weights;
      for (const double weight :
           {weights.edge_length, weights.planarity, weights.regularity, weights.centroidal, weights.equal_area})
        require(weight >= 0 && std::isfinite(weight));
      for (const auto site : request.options.fixed_sites) require(site >= 0);
      require(request.options.tolerance > 0 && request.options.max_iterations > 0);
      require(request.options.edge_length >= 0 && std::isfinite(request.options.edge_length));
      return check_deadline(request.deadline);
    }
    case 17: {
      const auto request = json::parse_weave_deformation(body, limits());
      check_weave(request.weave);
      check_options(request.options);
      require(!request.gradients.empty());
      for (const auto& gradient : request.gradients) require(gradient.determinant() > 0);
      for (const int index : request.deformed)
        require(index >= 0 && static_cast<std::size_t>(index) < request.gradients.size());
      return check_deadline(request.deadline);
    }
    case 18: {
      const auto request = json::parse_family_upload(body, limits());
      if (request.definition) {
        check_family(*request.definition);
      } else {
        require(tiling::find_isohedral_type(request.drawing.isohedral_type) != nullptr && !request.drawing.id.empty());
        require(request.drawing.reach > 0 && std::isfinite(request.drawing.reach));
      }
      return check_deadline(request.deadline);
    }
    case 19: {
      const auto request = json::parse_family_check(body, limits());
      check_family(request.definition);
      return check_deadline(request.deadline);
    }
    case 20: {
      const auto request = json::parse_training(body, limits());
      require(!request.family.empty() && request.core_seconds >= 60 && request.core_seconds <= 1e7);
      require(request.error >= 0 && request.error <= 0.5 && request.seed >= 1);
      return check_deadline(request.deadline);
    }
    case 21: {
      const auto request = json::parse_part_simulation(body, limits());
      check_part_simulation(request);
      return check_deadline(request.deadline);
    }
    default: {
      const auto request = json::parse_simulation(body, limits());
      check_structure(request.structure);
      check_load(request.load);
      check_mesh(request.options.mesh);
      require(request.options.material.youngs_modulus > 0 && request.options.material.poisson_ratio < 0.5);
      require(request.options.tolerance > 0 && request.options.max_iterations > 0);
      return check_deadline(request.deadline);
    }
  }
}

void check_problem(const problem::Problem& problem) {
  // The library's parser is strict: it refuses bytes that are not UTF-8 and numbers that are not finite.
  const auto document = nlohmann::json::parse(json::write_problem(problem));
  require(document.at("status").get<int>() >= 400 && document.at("status").get<int>() < 500);
  require(!document.at("detail").get<std::string>().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    parse(data[0] - static_cast<unsigned>('0'), {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const Error&) {
    check_problem(problem::problem_of(std::current_exception()));
  }
  return 0;
}
