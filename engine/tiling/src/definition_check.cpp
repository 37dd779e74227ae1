#include "supple/tiling/definition_check.h"

#include "box_survey.h"
#include "defined_outline.h"
#include "definition_fields.h"
#include "polygon.h"
#include "tiling_cover.h"

namespace supple::tiling {
namespace {

constexpr std::size_t max_findings = 20;
constexpr int cover_samples = 64;

std::optional<DefinitionFinding> cover_finding(const FamilyDefinition& definition,
                                               const std::vector<double>& parameters, const Execution& execution) {
  const auto fault = cover_fault(tiling_at(definition, parameters), edge_starts(definition), execution);
  if (!fault) return std::nullopt;
  std::string where = "tile";
  if (fault->edge) where += (definition.tile.edges.empty() ? "/vertices/" : "/edges/") + std::to_string(*fault->edge);
  return DefinitionFinding{fault->flaw, where, fault->message, parameters, fault->point};
}

/// What is wrong with the tile at the default parameters, or else with how its copies cover the plane somewhere.
std::optional<DefinitionFinding> drawn_fault(const FamilyDefinition& definition, const Execution& execution) {
  const StageTimer timer(execution.cost, "drawing");
  const auto samples = box_samples(definition, definition.parameters.empty() ? 0 : cover_samples);
  const std::vector<double>& defaults = samples.front();
  if (auto crossing = crossing_at(definition, defaults)) return crossing;
  if (area(tiling_at(definition, defaults).tiles[0]) <= 0)
    return DefinitionFinding{DefinitionFlaw::field, "tile/vertices", "must be counterclockwise", defaults, {}};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    execution.checkpoint(0.5 * static_cast<double>(k) / static_cast<double>(samples.size()), "drawing");
    if (auto fault = cover_finding(definition, samples[k], execution)) return fault;
  }
  return std::nullopt;
}

void keep_first(std::vector<DefinitionFinding>& findings) {
  if (findings.size() > max_findings) findings.resize(max_findings);
}

}  // namespace

DefinitionReport check_definition(const FamilyDefinition& definition, const Execution& execution) {
  DefinitionReport report{.faults = field_faults(definition), .warnings = {}};
  if (report.good()) {
    if (auto fault = drawn_fault(definition, execution)) report.faults.push_back(std::move(*fault));
  }
  const bool surveys = report.good();
  if (surveys) {
    const StageTimer timer(execution.cost, "survey");
    report.warnings = survey_box(definition, execution);
  }
  if (execution.cost) {
    execution.cost->add_effect("survey", surveys,
                               surveys ? "the definition has no faults" : "the definition has faults");
  }
  keep_first(report.faults);
  keep_first(report.warnings);
  return report;
}

}  // namespace supple::tiling
