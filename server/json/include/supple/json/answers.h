#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "supple/base/cost_ledger.h"
#include "supple/json/requests.h"
#include "supple/problem/problem.h"
#include "supple/surface/exponential_map.h"
#include "supple/surface/geodesic_field.h"
#include "supple/surface/karcher_mean.h"
#include "supple/surface/mesh_repair.h"
#include "supple/surface/mesh_report.h"

/// The answers of api/openapi.yaml as JSON text. Each function throws Error "computation.non_finite" rather than write
/// a number that is not finite; an unreachable distance is null.
namespace supple::json {

/// The cost of a computation.
struct Bill {
  double seconds = 0;  ///< wall clock
  CostLedger ledger;
};

/// Milliseconds since 1970 as RFC 3339 in UTC: "2026-02-03T04:05:06.789Z".
std::string time_text(std::int64_t milliseconds);

std::string write_problem(const problem::Problem& problem);
/// `repair` is null where the upload asked for none.
std::string write_mesh(const std::string& id, std::int64_t created, const surface::MeshReport& report,
                       const surface::RepairOutcome* repair = nullptr);
/// `ends` are the pairs' points in the faces that the derivatives refer to.
std::string write_geodesics(const GeodesicsRequest& request, const surface::TriangleMesh& mesh,
                            const std::vector<std::pair<surface::SurfacePoint, surface::SurfacePoint>>& ends,
                            const std::vector<surface::Geodesic>& results, const Bill& bill);
std::string write_geodesic_field(const GeodesicFieldRequest& request, const surface::GeodesicField& field,
                                 const Bill& bill);
std::string write_karcher_mean(const KarcherMeanRequest& request, const surface::TriangleMesh& mesh,
                               const surface::KarcherMean& mean, const Bill& bill);
/// `requested_length` is the length of the tangent vector within the start's face.
std::string write_exponential_map(const ExponentialMapRequest& request, const surface::TriangleMesh& mesh,
                                  const surface::ExponentialMap& map, double requested_length, const Bill& bill);

}  // namespace supple::json
