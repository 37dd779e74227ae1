#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/json/requests.h"
#include "supple/voronoi/diagram.h"
#include "supple/voronoi/optimization.h"

/// The requests of Voronoi diagrams as types; they are read like those of requests.h and throw the same. Whether sites
/// lie on the mesh is not checked here.
namespace supple::json {

inline constexpr auto diagram_method_names =
    names_of<voronoi::DiagramMethod>({{voronoi::DiagramMethod::exact, "exact"},
                                      {voronoi::DiagramMethod::bounded, "bounded"},
                                      {voronoi::DiagramMethod::edges, "edges"}});
inline constexpr auto optimization_method_names =
    names_of<voronoi::OptimizationMethod>({{voronoi::OptimizationMethod::automatic, "automatic"},
                                           {voronoi::OptimizationMethod::gauss_newton, "gauss_newton"},
                                           {voronoi::OptimizationMethod::lbfgs, "lbfgs"}});

struct RandomSites {
  std::int64_t count = 0;
  std::uint64_t seed = 1;
};

using SitesSpec = std::variant<std::vector<PointSpec>, RandomSites>;

/// What an answer says of a diagram besides its cells.
struct DiagramInclude {
  bool points = false;  ///< the borders' points as points of the surface
  bool pieces = false;  ///< the site of each vertex and of each part of a face
};

struct VoronoiDiagramRequest {
  std::string mesh;
  SitesSpec sites;
  voronoi::DiagramOptions options;
  DiagramInclude include;
  bool statistics = true;
  bool keep = false;       ///< the server keeps the diagram for a later one of almost the same sites
  double panel_scale = 1;  ///< millimetres per mesh unit
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
VoronoiDiagramRequest parse_voronoi_diagram(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation = {});

struct VoronoiOptimizationRequest {
  std::string mesh;
  SitesSpec sites;
  voronoi::OptimizationOptions options;  ///< without an observer
  DiagramInclude include;
  double panel_scale = 1;
  std::vector<PlacedPoint> points_in_space;
  double deadline = 0;
};
VoronoiOptimizationRequest parse_voronoi_optimization(std::string_view body, const Limits& limits,
                                                      const CancellationToken& cancellation = {});

}  // namespace supple::json
