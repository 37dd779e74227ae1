#include "supple/json/requests.h"

#include <algorithm>

#include "document.h"
#include "request_parts.h"
#include "supple/problem/problem.h"

namespace supple::json {
namespace {

void read_pairs(Fields& fields, std::vector<GeodesicsRequest::Pair>& pairs, const Limits& limits) {
  const auto* entries = fields.array("pairs", true, 1, limits.max_pairs, "--max-pairs");
  if (!entries) return;
  pairs.resize(entries->size());
  std::size_t path_points = 0;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto pointer = fields.at("pairs") + "/" + std::to_string(i);
    Fields pair((*entries)[i], pointer, fields.faults());
    pair.point("from", pairs[i].from, true);
    pair.point("to", pairs[i].to, true);
    if (pair.present("known_path")) {
      pair.points("known_path", pairs[i].known_path, 2, limits.max_path_points - path_points, "");
      path_points += pairs[i].known_path.size();
    } else {
      pair.optional("known_path");
    }
    pair.finish();
  }
}

void read_repair(Fields& fields, std::optional<surface::RepairOptions>& repair) {
  surface::RepairOptions options;
  const auto* entries = fields.array("repair", false, 1, repair_names.names().size(), "");
  for (std::size_t i = 0; entries && i < entries->size(); ++i) {
    const auto& entry = (*entries)[i];
    const auto* text = entry.get_ptr<const std::string*>();
    const auto found = text ? repair_names.find(*text) : std::nullopt;
    const auto at = fields.at("repair") + "/" + std::to_string(i);
    if (found) {
      options.ask(*found);
    } else if (text && *text == surface::automatic_repair_name) {
      options.automatic = true;
      if (entries->size() > 1) fields.faults().add(at, R"("automatic" stands alone: it takes what is needed)");
    } else {
      std::vector<std::string_view> names{surface::automatic_repair_name};
      names.insert(names.end(), repair_names.names().begin(), repair_names.names().end());
      fields.faults().add(at, must_be_one_of(names));
    }
  }
  if (fields.present("weld_tolerance")) {
    if (!fields.faults().any() && !options.has(surface::Repair::weld))
      fields.faults().add(fields.at("weld_tolerance"), R"(takes effect with the repair "weld" only)");
    double tolerance = 0;
    fields.number("weld_tolerance", tolerance, 0, surface::RepairOptions::max_weld_tolerance);
    options.weld_tolerance = tolerance;
  }
  if (entries) repair = options;
}

}  // namespace

GeodesicsRequest parse_geodesics(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<GeodesicsRequest>(body, limits, cancellation, [&](Fields& fields, GeodesicsRequest& request) {
    fields.mesh_id(request.mesh);
    read_pairs(fields, request.pairs, limits);
    fields.integer("derivatives", request.derivatives, 0, 2);
    fields.boolean("paths", request.paths);
    nested(fields, "accuracy",
           [&](Fields& accuracy) { accuracy.number("mollifier_length", request.mollifier_length, 0, 0.5, true); });
    nested(fields, "effects", [&](Fields& effects) { effects.choice("mollifier", request.mollifier, switch_names); });
  });
}

GeodesicFieldRequest parse_geodesic_field(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation) {
  return read_request<GeodesicFieldRequest>(
      body, limits, cancellation, [&](Fields& fields, GeodesicFieldRequest& request) {
        fields.mesh_id(request.mesh);
        fields.points("sources", request.sources, 1, limits.max_points, "--max-points");
        nested(fields, "accuracy", [&](Fields& accuracy) {
          accuracy.choice("method", request.method, field_method_names);
          accuracy.number("relative_error", request.relative_error, 0, 1);
          if (request.method == surface::FieldMethod::edge_graph && request.relative_error > 0) {
            fields.faults().add(accuracy.at("relative_error"),
                                "is a guarantee that the method \"edge_graph\" cannot give");
          }
        });
        fields.number("max_distance", request.max_distance, min_length, max_length);
      });
}

KarcherMeanRequest parse_karcher_mean(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation) {
  return read_request<KarcherMeanRequest>(body, limits, cancellation, [&](Fields& fields, KarcherMeanRequest& request) {
    fields.mesh_id(request.mesh);
    fields.points("points", request.points, 1, limits.max_points, "--max-points");
    fields.numbers("weights", request.weights, false, 1, limits.max_points);
    fields.number("tolerance", request.tolerance, 0, 1, true);
    fields.integer("max_iterations", request.max_iterations, 1, 100'000);
    fields.integer("starts", request.starts, 1, 1000);
    if (fields.present("start")) {
      request.start.emplace();
      fields.point("start", *request.start, true);
    } else {
      fields.optional("start");
    }
    fields.choice("method", request.method, minimization_method_names);
    nested(fields, "effects",
           [&](Fields& effects) { effects.choice("kept_fields", request.kept_fields, switch_names); });
  });
}

ExponentialMapRequest parse_exponential_map(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation) {
  return read_request<ExponentialMapRequest>(body, limits, cancellation,
                                             [&](Fields& fields, ExponentialMapRequest& request) {
                                               fields.mesh_id(request.mesh);
                                               fields.point("start", request.start, true);
                                               fields.numbers("tangent", request.tangent, true, 2, 3);
                                               fields.boolean("trace", request.trace);
                                             });
}

MeshUpload parse_mesh_arrays(std::string_view body, const Limits& limits, const surface::MeshLimits& mesh_limits,
                             const CancellationToken& cancellation) {
  const auto document = parse_document(body, limits, cancellation);
  MeshUpload upload;
  auto& soup = upload.soup;
  Faults faults(cancellation);
  Fields fields(document, "", faults);
  const auto check_count = [](const Document* array, std::int64_t limit, const char* what, const char* setting) {
    if (array && static_cast<std::int64_t>(array->size()) > limit) {
      problem::throw_limit("mesh.too_large", what, static_cast<double>(limit), static_cast<double>(array->size()),
                           setting);
    }
  };
  constexpr auto unlimited = std::numeric_limits<std::size_t>::max();
  const auto* vertices = fields.array("vertices", true, 0, unlimited, "");
  const auto* faces = fields.array("faces", true, 0, unlimited, "");
  check_count(vertices, mesh_limits.vertices, "The number of vertices", "--max-vertices");
  check_count(faces, mesh_limits.faces, "The number of faces", "--max-faces");
  const auto is_triple = [](const Document& value, auto is_entry) {
    return value.is_array() && value.size() == 3 && std::all_of(value.begin(), value.end(), is_entry);
  };
  if (vertices) {
    soup.positions.reserve(vertices->size());
    for (const auto& vertex : *vertices) {
      faults.check_for_stop();
      if (is_triple(vertex, [](const Document& x) { return x.is_number(); })) {
        soup.positions.emplace_back(vertex[0].get<double>(), vertex[1].get<double>(), vertex[2].get<double>());
      } else {
        faults.add("/vertices/" + std::to_string(&vertex - &vertices->front()), "must be an array of 3 numbers");
      }
    }
  }
  if (faces) {
    const auto is_index = [](const Document& i) {
      return i.is_number_unsigned() && i.get<std::uint64_t>() <= std::numeric_limits<std::int32_t>::max();
    };
    soup.faces.reserve(faces->size());
    for (const auto& face : *faces) {
      faults.check_for_stop();
      if (is_triple(face, is_index)) {
        soup.faces.push_back({face[0].get<std::int32_t>(), face[1].get<std::int32_t>(), face[2].get<std::int32_t>()});
      } else {
        faults.add("/faces/" + std::to_string(&face - &faces->front()),
                   "must be an array of 3 integers from 0 to 2147483647");
      }
    }
  }
  read_repair(fields, upload.repair);
  fields.finish();
  faults.throw_if_any();
  return upload;
}

}  // namespace supple::json
