#include "supple/json/embedded_system_requests.h"

#include <variant>

#include "request_parts.h"

namespace supple::json {
namespace {

constexpr int max_relaxation_iterations = 100'000;
constexpr std::size_t max_solid_regions = 1000;
constexpr std::size_t max_positions = 1000;

/// Calls read(fields) for the object that stands in place of an array.
template <class Read>
void read_builder(Fields& fields, std::string_view name, Read read) {
  Fields builder(*fields.required(name), fields.at(name), fields.faults());
  builder.required("kind");
  read(builder);
  builder.finish();
}

void read_network_points(Fields& fields, const Limits& limits, EmbeddedSystemRequest& request) {
  if (!is_builder(fields, "points")) {
    return fields.points("points", request.points.emplace<0>(), 1, limits.max_points, "--max-points");
  }
  read_builder(fields, "points", [&](Fields& builder) {
    enum class Kind { none, per_face, poisson_disk } kind = Kind::none;
    builder.choice("kind", kind, names_of<Kind>({{Kind::per_face, "per_face"}, {Kind::poisson_disk, "poisson_disk"}}));
    if (kind != Kind::poisson_disk) {
      // The field is known also where the kind is faulty, so that only the kind is reported.
      const auto* value = kind == Kind::none ? builder.optional("barycentric") : builder.required("barycentric");
      if (value) {
        read_components(*value, builder.at("barycentric"), builder.faults(),
                        request.points.emplace<embedded::PointsInFaces>().barycentric, -max_dimensionless,
                        max_dimensionless);
      }
    }
    if (kind != Kind::per_face) {
      embedded::PoissonDiskPoints points;
      if (kind == Kind::poisson_disk) builder.required("radius");
      builder.number("radius", points.radius, min_length, max_length);
      int seed = 1;
      builder.integer("seed", seed, 0, max_index);
      points.seed = static_cast<std::uint64_t>(seed);
      request.points = points;
    }
  });
}

void read_spring_constants(Fields& fields, double& rest_length, double& weight) {
  fields.number("rest_length", rest_length, 0, max_length);
  fields.number("weight", weight, 0, max_factor);
}

embedded::Spring read_spring(const Document& value, const std::string& pointer, Faults& faults) {
  embedded::Spring spring;
  Fields fields(value, pointer, faults);
  if (const auto* ends = fields.required("between")) {
    const auto at = fields.at("between");
    if (!ends->is_array() || ends->size() != 2) {
      faults.add(at, "must be an array of the indices of 2 points");
    } else {
      spring.from = read_array_index((*ends)[0], at + "/0", faults);
      spring.to = read_array_index((*ends)[1], at + "/1", faults);
    }
  }
  read_spring_constants(fields, spring.rest_length, spring.weight);
  fields.finish();
  return spring;
}

void read_springs(Fields& fields, const Limits& limits, EmbeddedSystemRequest& request) {
  if (is_builder(fields, "springs")) {
    return read_builder(fields, "springs", [&](Fields& fields_of_builder) {
      auto& builder = request.springs.emplace<embedded::NeighbourSprings>();
      using Kind = embedded::NeighbourSprings::Kind;
      fields_of_builder.choice(
          "kind", builder.kind,
          names_of<Kind>({{Kind::adjacent_faces, "adjacent_faces"}, {Kind::voronoi_dual, "voronoi_dual"}}));
      read_spring_constants(fields_of_builder, builder.rest_length, builder.weight);
    });
  }
  const auto* entries = fields.array("springs", true, 0, limits.max_springs, "--max-springs");
  if (!entries) return;
  auto& springs = request.springs.emplace<0>();
  springs.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    springs.push_back(read_spring((*entries)[i], fields.at("springs") + "/" + std::to_string(i), fields.faults()));
  }
}

void read_triangles(Fields& fields, const Limits& limits, EmbeddedSystemRequest& request) {
  if (is_builder(fields, "triangles")) {
    return read_builder(fields, "triangles", [&](Fields& builder) {
      enum class Kind { voronoi_dual } kind = Kind::voronoi_dual;
      builder.choice("kind", kind, names_of<Kind>({{Kind::voronoi_dual, "voronoi_dual"}}));
      request.triangles.emplace<embedded::DualTriangles>();
    });
  }
  const auto* entries = fields.array("triangles", false, 0, limits.max_springs, "--max-springs");
  if (!entries) return;
  auto& triangles = request.triangles.emplace<0>();
  triangles.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto& entry = (*entries)[i];
    const auto at = fields.at("triangles") + "/" + std::to_string(i);
    if (!entry.is_array() || entry.size() != 3) {
      fields.faults().add(at, "must be an array of the indices of 3 points");
      continue;
    }
    auto& corners = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = read_array_index(entry[k], at + "/" + std::to_string(k), fields.faults());
  }
}

void read_membrane(Fields& fields, EmbeddedSystemRequest& request) {
  nested(fields, "membrane", [&](Fields& membrane) {
    membrane.number("youngs_modulus", request.material.youngs_modulus, min_factor, max_factor);
    membrane.number("poisson_ratio", request.material.poisson_ratio, -0.99, 0.4999);
    membrane.number("thickness", request.material.thickness, min_length, max_length);
    membrane.number("rest_scale", request.rest_scale, min_factor, max_factor);
  });
}

void read_moved_vertices(Fields& fields, const Limits& limits, std::vector<embedded::MovedVertex>& moved) {
  const auto* entries = fields.array("moved_vertices", false, 0, limits.max_points, "--max-points");
  if (!entries) return;
  moved.reserve(entries->size());
  for (std::size_t i = 0; i < entries->size(); ++i) {
    Fields entry((*entries)[i], fields.at("moved_vertices") + "/" + std::to_string(i), fields.faults());
    embedded::MovedVertex& read = moved.emplace_back();
    if (const auto* vertex = entry.required("vertex"))
      read.vertex = read_array_index(*vertex, entry.at("vertex"), entry.faults());
    const auto* positions = entry.array("positions", true, 1, max_positions, "");
    for (std::size_t k = 0; positions && k < positions->size(); ++k)
      read_components((*positions)[k], entry.at("positions") + "/" + std::to_string(k), entry.faults(),
                      read.positions.emplace_back(Eigen::Vector3d::Zero()), -max_length, max_length);
    entry.finish();
  }
}

void read_vector(Fields& fields, std::string_view name, Eigen::Vector3d& vector, double largest) {
  if (const auto* value = fields.optional(name))
    read_components(*value, fields.at(name), fields.faults(), vector, -largest, largest);
}

void read_shell(Fields& fields, const Limits& limits, embedded::ShellHost& shell) {
  fields.required("thickness");
  fields.required("youngs_modulus");
  fields.number("thickness", shell.thickness, min_length, max_length);
  fields.number("youngs_modulus", shell.youngs_modulus, min_factor, max_factor);
  shell.poisson_ratio = 0.3;
  fields.number("poisson_ratio", shell.poisson_ratio, -0.99, 0.4999);
  fields.number("volume_weight", shell.volume_weight, 0, max_factor);
  fields.number("volume_scale", shell.volume_scale, min_factor, max_factor);
  read_indices(fields, "fixed_vertices", limits, shell.fixed_vertices);
  read_moved_vertices(fields, limits, shell.moved_vertices);
}

void read_solid(Fields& fields, const Limits& limits, embedded::SolidHost& solid) {
  fields.required("youngs_modulus");
  fields.number("youngs_modulus", solid.youngs_modulus, min_factor, max_factor);
  solid.poisson_ratio = 0.3;
  fields.number("poisson_ratio", solid.poisson_ratio, -0.99, 0.4999);
  fields.number("element_size", solid.element_size, min_length, max_length);
  read_vector(fields, "gravity", solid.gravity, max_factor);
  read_indices(fields, "fixed_vertices", limits, solid.fixed_vertices);
  read_moved_vertices(fields, limits, solid.moved_vertices);
  const auto* regions = fields.array("regions", false, 0, max_solid_regions, "");
  for (std::size_t i = 0; regions && i < regions->size(); ++i) {
    Fields region((*regions)[i], fields.at("regions") + "/" + std::to_string(i), fields.faults());
    embedded::SolidRegion& read = solid.regions.emplace_back();
    for (const auto* name : {"lower", "upper", "youngs_modulus"}) region.required(name);
    read_vector(region, "lower", read.lower, max_length);
    read_vector(region, "upper", read.upper, max_length);
    region.number("youngs_modulus", read.youngs_modulus, min_factor, max_factor);
    region.finish();
  }
}

void read_moving(Fields& fields, embedded::MovingHost& moving) {
  const auto* sets = fields.array("positions", true, 1, max_positions, "");
  for (std::size_t k = 0; sets && k < sets->size(); ++k) {
    const auto at = fields.at("positions") + "/" + std::to_string(k);
    const auto& set = (*sets)[k];
    if (!set.is_array()) {
      fields.faults().add(at, "must be an array of the places of all vertices");
      continue;
    }
    auto& places = moving.positions.emplace_back(set.size());
    for (std::size_t i = 0; i < set.size(); ++i)
      read_components(set[i], at + "/" + std::to_string(i), fields.faults(), places[i], -max_length, max_length);
  }
}

void read_host(Fields& fields, const Limits& limits, embedded::RelaxationOptions& options) {
  nested(fields, "host", [&](Fields& host) {
    host.required("kind");
    enum class Kind { rigid, shell, solid, moving } kind = Kind::rigid;
    host.choice(
        "kind", kind,
        names_of<Kind>(
            {{Kind::rigid, "rigid"}, {Kind::shell, "shell"}, {Kind::solid, "solid"}, {Kind::moving, "moving"}}));
    if (kind == Kind::shell) read_shell(host, limits, options.host.emplace<embedded::ShellHost>());
    if (kind == Kind::solid) read_solid(host, limits, options.host.emplace<embedded::SolidHost>());
    if (kind == Kind::moving) read_moving(host, options.host.emplace<embedded::MovingHost>());
  });
}

void read_relaxation_options(Fields& fields, embedded::RelaxationOptions& options) {
  fields.choice("method", options.method, relaxation_method_names);
  fields.choice("spring_length", options.spring_length, spring_length_names);
  nested(fields, "accuracy", [&](Fields& accuracy) {
    accuracy.number("tolerance", options.tolerance, 0, 1, true);
    accuracy.number("mollifier_length", options.mollifier_length, 0, 0.5, true);
  });
  fields.integer("max_iterations", options.max_iterations, 1, max_relaxation_iterations);
  fields.boolean("paths", options.paths);
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("mollifier", options.mollifier, switch_names);
    effects.choice("kept_strips", options.kept_strips, switch_names);
    // This switch takes effect on a shell only.
    Switch bending = Switch::automatic;
    effects.choice("bending", bending, switch_names);
    if (auto* shell = std::get_if<embedded::ShellHost>(&options.host)) shell->bending = bending != Switch::off;
  });
}

}  // namespace

EmbeddedSystemRequest parse_embedded_system(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation) {
  return read_request<EmbeddedSystemRequest>(body, limits, cancellation,
                                             [&](Fields& fields, EmbeddedSystemRequest& request) {
                                               fields.mesh_id(request.mesh);
                                               read_network_points(fields, limits, request);
                                               read_springs(fields, limits, request);
                                               read_triangles(fields, limits, request);
                                               read_membrane(fields, request);
                                               read_indices(fields, "fixed_points", limits, request.fixed_points);
                                               read_host(fields, limits, request.options);
                                               read_relaxation_options(fields, request.options);
                                             });
}

}  // namespace supple::json
