#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "supple/http/router.h"
#include "supple/json/json_writer.h"
#include "supple/routes/services.h"

namespace supple::routes {

void add_mesh_routes(http::Router& router, Services& services);
void add_geodesics_route(http::Router& router, Services& services);
void add_geodesic_field_route(http::Router& router, Services& services);
void add_karcher_mean_route(http::Router& router, Services& services);
void add_embedded_system_route(http::Router& router, Services& services);
void add_voronoi_routes(http::Router& router, Services& services);
void add_exponential_map_route(http::Router& router, Services& services);
void add_structure_routes(http::Router& router, Services& services);
/// Families of one's own: adding, listing and removing them.
void add_family_routes(http::Router& router, Services& services);
void add_family_check_routes(http::Router& router, Services& services);
void add_family_atlas_routes(http::Router& router, Services& services);
/// Trainings of networks, and what they would take.
void add_training_routes(http::Router& router, Services& services);
void add_simulation_route(http::Router& router, Services& services);
void add_design_routes(http::Router& router, Services& services);
void add_part_route(http::Router& router, Services& services);
void add_part_simulation_route(http::Router& router, Services& services);
void add_measured_curve_route(http::Router& router, Services& services);
void add_outline_route(http::Router& router, Services& services);
void add_model_routes(http::Router& router, Services& services);
void add_weave_routes(http::Router& router, Services& services);
void add_weave_toolpath_routes(http::Router& router, Services& services);
void add_job_routes(http::Router& router, Services& services);
/// Sessions of browsers: signing in with a key, and out.
void add_session_routes(http::Router& router, Services& services);
void add_service_routes(http::Router& router, Services& services);
/// The files of a folder as they are now, each at its path, and index.html also at "/". The folder is read once, so
/// that no path can reach another file. Throws std::runtime_error if it cannot be read or has no index.html.
void add_web_routes(http::Router& router, const std::string& folder);

/// Throws "server.not_ready" until the store is open and the models are read, "server.shutting_down" at the end.
void require_ready(const Services& services);

/// Throws "http.unsupported_media_type" if the request's body is not application/json.
void require_json(const http::Request& request);

/// The body of an answer that is read from its file as it is sent.
http::PiecewiseBody body_of(store::OpenContent content);

http::Response json_response(std::string body, int status = 200);

/// The entries of a list that a request asks for: at most `limit` (1 to 1000, the default is 100), after the entry
/// `after`. Throws "request.invalid_parameter", also for parameters other than these and `more`.
struct Page {
  std::size_t limit = 100;
  std::string after;
};
Page read_page(const http::Request& request, std::initializer_list<std::string_view> more = {});

/// A page of a list: {NAME: [...], "next": ID}. `entries` has one entry more than the page, if there are so many, and
/// "next" tells then that there are more. write(entry) gives JSON, and id(entry) what `after` takes.
template <class Entry, class Write, class Id>
http::Response page_response(std::string_view name, const std::vector<Entry>& entries, const Page& page, Write write,
                             Id id) {
  const auto count = std::min(entries.size(), page.limit);
  json::JsonWriter out;
  out.begin_object().key(name).begin_array();
  for (std::size_t i = 0; i < count; ++i) out.raw(write(entries[i]));
  out.end_array();
  if (entries.size() > count) out.field("next", id(entries[count - 1]));
  out.end_object();
  return json_response(out.take());
}

/// The handler of a route that calls handler(services, request). `Context` is Services or const Services.
template <class Context>
http::Handler handler_with(Services& services, http::Response (*handler)(Context&, const http::Request&)) {
  return [&services, handler](const http::Request& request) { return handler(services, request); };
}

}  // namespace supple::routes
