#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/limits.h"
#include "supple/json/name_table.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/patterns.h"
#include "supple/weave/printed_samples.h"
#include "supple/weave/simulation.h"

/// The requests about weaves as types; they are read like those of requests.h and throw the same. Whether strands meet
/// and indices exist is not checked here. Lengths are in mm.
namespace supple::json {

inline constexpr auto ends_names = names_of<weave::Ends>(
    {{weave::Ends::open, "open"}, {weave::Ends::closed, "closed"}, {weave::Ends::periodic, "periodic"}});

struct StrandSpec {
  std::vector<Eigen::Vector2d> points;
  weave::Ends ends = weave::Ends::open;
  Eigen::Vector2d translation{0, 0};
  std::optional<double> radius;  ///< mm; the default is the radius of the weave
};

/// How far a member may slide. A limit that is not given follows from `WeaveSpec::sliding_fraction`.
struct SlidingRange {
  std::optional<double> backward;  ///< infinity for no limit
  std::optional<double> forward;
};

struct MemberSpec {
  int strand = 0;
  double coordinate = 0;
  Eigen::Vector2i shift{0, 0};
  bool slides = false;
  SlidingRange range;
};

struct LayoutSpec {
  std::vector<StrandSpec> strands;
  std::optional<std::vector<std::vector<MemberSpec>>> crossings;  ///< found by the engine where they are not given
  std::optional<Eigen::Matrix2d> lattice;
};

struct SheetSpec {
  int columns = 1;
  int rows = 1;
  int fused_border = 0;  ///< strands at the border whose crossings are fused; only of regular weaves
};

struct RegularSpec {
  weave::ConnectionBlock connections = weave::uniform_block(weave::Connection::fused);
  double pitch = 4;
  std::optional<SheetSpec> sheet;
};

/// Lengths that are not given are the engine's defaults, which differ between cell and sheet.
struct SquaresSpec {
  weave::SquareType type = weave::SquareType::all_fused;
  double side = 12;
  std::optional<double> overlap;
  std::optional<SheetSpec> sheet;
};

struct CirclesSpec {
  weave::CircleType type = weave::CircleType::all_fused;
  std::optional<double> radius;
  std::optional<double> distance;
  std::optional<SheetSpec> sheet;
};

struct RingsSpec {};

/// One of the sheets that have been printed and tested.
struct SampleSpec {
  weave::Sample sample = weave::Sample::fused_grid;
};

/// A crossing whose connections differ from those of the pattern.
struct CrossingOverride {
  int crossing = 0;
  std::vector<int> slides;  ///< indices of its members
  SlidingRange range;
};

/// The field "weave", the same in every request that has one.
struct WeaveSpec {
  std::variant<LayoutSpec, RegularSpec, SquaresSpec, CirclesSpec, RingsSpec, SampleSpec> source;
  double radius = 0.25;
  weave::Material material;
  std::vector<CrossingOverride> overrides;
  std::optional<double> sliding_fraction;
};

struct WeaveLayoutRequest {
  WeaveSpec weave;
  bool svg = false;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
WeaveLayoutRequest parse_weave_layout(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation = {});

struct WeaveHomogenizationRequest {
  WeaveSpec weave;
  weave::HomogenizationOptions options;
  double deadline = 0;
};
WeaveHomogenizationRequest parse_weave_homogenization(std::string_view body, const Limits& limits,
                                                      const CancellationToken& cancellation = {});

struct WeaveDeformationRequest {
  WeaveSpec weave;
  std::vector<Eigen::Matrix2d> gradients;
  std::vector<int> deformed;
  weave::EquilibriumOptions options;
  double deadline = 0;
};
WeaveDeformationRequest parse_weave_deformation(std::string_view body, const Limits& limits,
                                                const CancellationToken& cancellation = {});

/// The places at which a support or a force acts.
struct StrandCoordinate {
  int strand = 0;
  double coordinate = 0;
};
struct StrandFraction {
  int strand = 0;
  double share = 0;  ///< fraction of the strand's length
};
struct AtCrossing {
  int crossing = 0;
};
struct InBox {
  Eigen::Vector2d lower{0, 0};
  Eigen::Vector2d upper{0, 0};
};
using PlaceSpec = std::variant<StrandCoordinate, StrandFraction, AtCrossing, InBox>;

struct WeaveSupportSpec {
  PlaceSpec at;
  weave::Support support;  ///< the support without its place
};

struct WeaveForceSpec {
  PlaceSpec at;
  Eigen::Vector3d force{0, 0, 0};  ///< N; distributed over the places of a box
};

enum class DeformedStrands { none, json, obj, vtu };
inline constexpr auto deformed_strands_names = names_of<DeformedStrands>({{DeformedStrands::none, "none"},
                                                                          {DeformedStrands::json, "json"},
                                                                          {DeformedStrands::obj, "obj"},
                                                                          {DeformedStrands::vtu, "vtu"}});

struct WeaveSimulationRequest {
  WeaveSpec weave;
  std::vector<WeaveSupportSpec> supports;
  std::vector<WeaveForceSpec> forces;
  int states = 1;
  weave::EquilibriumOptions options;
  DeformedStrands deformed = DeformedStrands::json;
  double deadline = 0;
};
WeaveSimulationRequest parse_weave_simulation(std::string_view body, const Limits& limits,
                                              const CancellationToken& cancellation = {});

}  // namespace supple::json
