#include "supple/routes/routes.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "handlers.h"
#include "supple/json/answers.h"

namespace supple::routes {

http::Router make_router(Services& services) {
  http::Router router;
  add_mesh_routes(router, services);
  add_geodesics_route(router, services);
  add_geodesic_field_route(router, services);
  add_karcher_mean_route(router, services);
  add_embedded_system_route(router, services);
  add_voronoi_routes(router, services);
  add_exponential_map_route(router, services);
  add_structure_routes(router, services);
  add_simulation_route(router, services);
  add_model_routes(router, services);
  add_design_routes(router, services);
  add_measured_curve_route(router, services);
  add_outline_route(router, services);
  add_family_routes(router, services);
  add_family_check_routes(router, services);
  add_family_atlas_routes(router, services);
  add_training_routes(router, services);
  add_part_route(router, services);
  add_part_simulation_route(router, services);
  add_weave_routes(router, services);
  add_weave_toolpath_routes(router, services);
  add_job_routes(router, services);
  add_session_routes(router, services);
  add_service_routes(router, services);
  if (!services.web.empty()) add_web_routes(router, services.web);
  return router;
}

http::Response problem_response(const problem::Problem& problem) {
  http::Response response;
  response.status = problem::status_of(problem);
  response.content_type = "application/problem+json";
  response.body = json::write_problem(problem);
  if (response.status == 401) response.set_header("WWW-Authenticate", "Bearer realm=\"supple\"");
  if (!problem.allowed_methods.empty()) response.set_header("Allow", problem.allowed_methods);
  if (problem.retry_after) response.set_header("Retry-After", std::to_string(*problem.retry_after));
  return response;
}

void require_ready(const Services& services) {
  if (services.stopping) throw Error("server.shutting_down", "The server is shutting down.");
  if (!services.ready) {
    const auto* const why = "The server is starting: its store is not open or its models are not read yet.";
    throw problem::ProblemError({"server.not_ready", why, {}, {}, 1});
  }
}

void require_json(const http::Request& request) {
  const auto type = http::media_type(request.header("Content-Type"));
  if (type == "application/json") return;
  // A request without a type is refused too: a page of another site may send it without asking.
  throw Error("http.unsupported_media_type", "This request takes a body of Content-Type application/json, not " +
                                                 (type.empty() ? "one without a type" : type.substr(0, 80)) + ".");
}

http::PiecewiseBody body_of(store::OpenContent content) {
  const auto bytes = content.size();
  return {bytes, [content = std::move(content)](std::uint64_t offset, char* to, std::size_t count) {
            content.read(offset, to, count);
          }};
}

http::Response json_response(std::string body, int status) {
  http::Response response;
  response.status = status;
  response.content_type = "application/json";
  response.body = std::move(body);
  return response;
}

Page read_page(const http::Request& request, std::initializer_list<std::string_view> more) {
  Page page;
  for (const auto& [name, value] : request.query) {
    if (name == "limit") {
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), page.limit);
      if (error != std::errc() || end != value.data() + value.size() || page.limit < 1 || page.limit > 1000) {
        throw Error("request.invalid_parameter", "The query parameter limit takes an integer from 1 to 1000.");
      }
    } else if (name == "after") {
      page.after = value;
    } else if (std::find(more.begin(), more.end(), name) == more.end()) {
      throw Error("request.invalid_parameter", "There is no query parameter " + name + " here.");
    }
  }
  return page;
}

}  // namespace supple::routes
