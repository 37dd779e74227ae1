#pragma once

#include <string>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/weave_requests.h"

/// The answers about weaves as JSON text; they throw like those of answers.h.
namespace supple::json {

/// `svg` is null where it was not asked for. It throws where a stop is requested, for an answer may have a million
/// crossings.
std::string write_weave_layout(const weave::Weave& weave, const std::vector<std::string>& warnings,
                               const std::string* svg, const Bill& bill, const Execution& execution = {});

/// Numbers of directions that did not converge are null where the contract says so.
std::string write_weave_homogenization(const WeaveHomogenizationRequest& request, const weave::Weave& weave,
                                       const std::vector<weave::DirectionalResponse>& responses, const Bill& bill);

/// `states` has an entry for each deformation gradient of the request.
std::string write_weave_deformation(const WeaveDeformationRequest& request, const weave::Weave& weave,
                                    const std::vector<weave::CellState>& states, const Bill& bill);

/// A point of a strand with a support. A support with a box has several.
struct SupportPoint {
  int support = 0;  ///< index of the support in the request
  int strand = 0;
  double coordinate = 0;  ///< mm
};

/// `places` has an entry for each support of the engine.
std::string write_weave_simulation(const WeaveSimulationRequest& request, const weave::Weave& weave,
                                   const std::vector<SupportPoint>& places, const weave::SimulationResult& result,
                                   const Bill& bill);

}  // namespace supple::json
