#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/base/part_of_execution.h"
#include "supple/design/design_fault.h"
#include "supple/design/material_bound.h"
#include "supple/design/verified_designs.h"
#include "supple/design/ways_out.h"
#include "supple/json/design_answers.h"
#include "supple/store/store_error.h"

namespace supple::routes {
namespace {

using Model = std::shared_ptr<const store::LoadedModel>;

/// Fraction of the progress after which ways out are sought: a search takes a tenth of their time, simulations take
/// more.
constexpr double search_before_ways_out = 0.1;
constexpr double simulation_before_ways_out = 0.8;

json::DesignModel name_of(const store::LoadedModel& model) {
  const auto& provenance = model.model.provenance;
  return {model.model.family, model.model.id, model.sha256, provenance.youngs_modulus, provenance.poisson_ratio};
}

/// The best model of each family, in the order of the models' ids.
std::vector<Model> models_by_family(const store::VisibleModels& store) {
  const auto all = store.models();
  std::vector<const neural::Model*> models;
  models.reserve(all.size());
  for (const Model& model : all) models.push_back(&model->model);
  std::vector<Model> best;
  for (const std::size_t i : neural::best_of_families(models)) best.push_back(all[i]);
  return best;
}

/// The model of a family. Throws "design.no_model" with a pointer to the field.
Model model_of_family(const Loader& loader, const std::string& family, const std::string& region) {
  const auto models = models_by_family(loader.models());
  const auto definition = loader.definition_of_added(family);
  std::string known;
  for (const auto& model : models) {
    // Another family may have the name that a client has given to one of its own.
    if (model->model.family == family && (definition.empty() || model->model.definition == definition)) return model;
    known += (known.empty() ? "" : ", ") + model->model.family;
  }
  const std::string there_are = "; there are models of: " + (known.empty() ? "none" : known) + ".";
  const std::string text =
      !definition.empty() ? "The family " + family +
                                ", which you have added, has no model yet, so that no design is found in it" + there_are
                          : "No model of the family " + family.substr(0, 100) + " is loaded" + there_are;
  throw Error("design.no_model", text, {{region + "/family", text}});
}

Model model_by_id(const store::VisibleModels& store, const std::string& id, const std::string& region) {
  return fault_of_field<store::ModelNotFound>(region + "/model", [&] { return store.get(id); });
}

/// A region with the models in whose parameters its design is searched.
struct Region {
  json::RegionSpec spec;
  std::vector<Model> models;
  std::string pointer;             ///< to its fields: "" or "/regions/3"
  std::vector<Model> others = {};  ///< models of other families, which may be ways out
};

std::vector<Model> models_of(const Loader& loader, const json::RegionSpec& spec, const std::string& region) {
  const auto store = loader.models();
  if (!spec.model.empty()) return {model_by_id(store, spec.model, region)};
  if (spec.family != "any") return {model_of_family(loader, spec.family, region)};
  if (spec.problem.initial || !spec.problem.fixed.empty()) {
    const std::string field = spec.problem.initial ? "initial" : "fixed";
    throw Error("design.needs_family",
                "The field " + field + " needs a family or a model: each has its own parameters.",
                {{region + "/" + field, "needs \"family\" or \"model\""}});
  }
  auto models = models_by_family(store);
  if (models.empty())
    throw Error("design.no_model", "No model is loaded.", {{region + "/family", "no model is loaded"}});
  return models;
}

/// Checks each target. Throws "design.invalid_target" with pointers.
void check_targets(const Region& region) {
  const auto& targets = region.spec.problem.targets;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    const PointerMap pointers(t == 0 ? region.pointer : region.pointer + "/also/" + std::to_string(t - 1));
    with_pointers<design::InvalidTarget>(pointers, [&] { design::sample_target(targets[t]); });
  }
}

/// A structure's response is proportional to Young's modulus. Another law or Poisson's ratio of its material changes it
/// in ways that a model does not know. Throws "design.other_material".
void check_material(const json::MaterialSpec& material, const neural::Model& model, const std::string& pointer) {
  /// Half of the last digit as it is printed: a Poisson's ratio is hardly known better.
  constexpr double rounding = 0.005;
  const double known = model.provenance.poisson_ratio;
  const auto refuse = [&](const char* field, const std::string& what) {
    const std::string text = what + " The model " + model.id +
                             " knows structures of a neo-Hookean material with Poisson's " + "ratio " +
                             plain_number(known) + ", whose response is proportional to Young's modulus alone. " +
                             "POST /v1/simulations simulates other materials.";
    throw Error("design.other_material", text, {{pointer + field, text}});
  };
  if (!material.is_neo_hookean) refuse("/law", "No model was trained for this law.");
  if (material.poisson_ratio && std::abs(*material.poisson_ratio - known) > rounding)
    refuse("/poisson_ratio", "No model was trained for Poisson's ratio " + plain_number(*material.poisson_ratio) + ".");
}

/// Checks the region's materials and hands their moduli to the search.
void prepare_materials(Region& region) {
  for (const auto& material : region.spec.materials) {
    for (const Model& model : region.models)
      check_material(material, model->model, region.pointer + "/" + material.where);
    if (material.has_modulus) region.spec.problem.moduli.push_back(material.youngs_modulus);
  }
}

/// The best models of the families that are not searched, as far as they know the region's materials. All families are
/// searched where the request names none.
std::vector<Model> models_of_other_families(const store::VisibleModels& store, const Region& region) {
  std::vector<Model> others;
  if (region.spec.model.empty() && region.spec.family == "any") return others;
  for (const Model& model : models_by_family(store)) {
    if (model->model.family == region.models.front()->model.family) continue;
    try {
      for (const auto& material : region.spec.materials) check_material(material, model->model, region.pointer);
      others.push_back(model);
    } catch (const Error&) {
      // The model does not know the material.
    }
  }
  return others;
}

std::vector<design::DesignSpace> spaces_of(const std::vector<Model>& models) {
  std::vector<design::DesignSpace> spaces;
  spaces.reserve(models.size());
  for (const Model& model : models)
    spaces.push_back(design::design_space(model->model, model->evaluator, model->candidates));
  return spaces;
}

/// Young's modulus of the stiffest solid that the request allows, MPa.
double max_modulus(const json::RegionSpec& spec, double model_modulus) {
  double modulus = spec.materials.empty() ? model_modulus : 0;
  for (const auto& material : spec.materials)
    modulus = std::max(modulus, material.has_modulus ? material.youngs_modulus.most : model_modulus);
  return modulus;
}

/// The region's targets, and the nearest that any material comes to them at rest.
json::BoundedTargets bounded_targets(const json::RegionSpec& spec, const json::DesignModel& model) {
  json::BoundedTargets bounded;
  for (const design::Target& target : spec.problem.targets) {
    bounded.targets.push_back(design::sample_target(target));
    bounded.weights.push_back(target.weight);
  }
  const double modulus = max_modulus(spec, model.youngs_modulus);
  bounded.bounds =
      design::material_bounds(bounded.targets, bounded.weights, design::solid_compliance(modulus, model.poisson_ratio));
  return bounded;
}

json::FoundDesigns search(const Region& region, const json::DesignRequest& request, const Execution& execution) {
  json::FoundDesigns found;
  found.spec = region.spec;
  const auto spaces = spaces_of(region.models);
  std::vector<design::FamilySimulation> simulations;
  for (const auto& model : region.models) {
    found.models.push_back(name_of(*model));
    if (request.needs_simulations()) simulations.push_back(design::simulation_of_model(model->model));
  }
  design::DesignSearch problem{region.spec.problem, request.options};
  if (request.simulates()) problem.verification = request.verification;
  problem.beam_width_sensitivity = request.beam_width_sensitivity;
  design::SearchObserver observer;
  if (execution.progress) {
    observer.on_progress = [&](const design::DesignProgress& news) {
      execution.progress->publish(json::write_partial_design(found.spec.name, found.models[news.space], news));
    };
    observer.on_round = [&](const design::Design& design, const design::PolishRound& round) {
      execution.progress->publish(json::write_partial_round(found.spec.name, found.models[design.space], round));
    };
  }
  auto designs = with_pointers<design::DesignFault>(PointerMap(region.pointer), [&] {
    return design::search_designs(spaces, simulations, problem, execution, observer);
  });
  found.ranking = std::move(designs.ranking);
  found.verification = std::move(designs.polished);
  found.discretization_error = std::move(designs.discretization_error);
  found.beam_width_sensitivity = std::move(designs.beam_width_sensitivity);
  found.bounded = bounded_targets(found.spec, found.models[found.ranking.front().design.space]);
  return found;
}

/// Adds ways out of a missed target to the designs that were found.
void add_ways_out(json::FoundDesigns& found, const Region& region, const json::DesignRequest& request,
                  const Execution& execution) {
  const design::Design& design = found.ranking.front().design;
  const auto own = spaces_of({region.models[design.space]});
  const auto others = spaces_of(region.others);
  for (const Model& model : region.others) found.other_models.push_back(name_of(*model));
  found.ways_out = design::find_ways_out({own.front(), others, region.spec.problem, request.options}, design,
                                         found.verification, execution);
}

/// Adds ways out to the designs of all regions. The bill says of each region why they were sought there or not.
void add_ways_out(std::vector<json::FoundDesigns>& found, const std::vector<Region>& regions,
                  const json::DesignRequest& request, const Execution& execution) {
  std::vector<std::string> reasons;
  std::string all;
  bool ran = false;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const double fraction = 1 / static_cast<double>(regions.size());
    const PartOfExecution part(execution, fraction * static_cast<double>(i), fraction);
    CostLedger bill;
    add_ways_out(found[i], regions[i], request, {execution.cancellation, part.execution().progress, &bill});
    const CostLedger::Effect effect = bill.effects().back();
    ran = ran || effect.ran;
    reasons.push_back(effect.why);
    const std::string& name = regions[i].spec.name;
    all += (all.empty() ? "" : "; ") + (name.empty() ? "region " + std::to_string(i + 1) : name) + ": " + effect.why;
    if (execution.cost) execution.cost->merge(bill);
  }
  const bool are_equal = std::adjacent_find(reasons.begin(), reasons.end(), std::not_equal_to<>()) == reasons.end();
  if (execution.cost && !are_equal) execution.cost->add_effect("ways_out", ran, all);
}

store::Result compute_design(const std::vector<Region>& regions, const json::DesignRequest& request,
                             metrics::Metrics& metrics, const Execution& outer) {
  std::vector<json::FoundDesigns> found;
  found.reserve(regions.size());
  const auto bill = billed(outer, [&](const Execution& execution) {
    const bool seeks_ways_out = request.seeks_ways_out();
    const double designs_fraction = !seeks_ways_out       ? 1
                                    : request.simulates() ? simulation_before_ways_out
                                                          : search_before_ways_out;
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const double fraction = designs_fraction / static_cast<double>(regions.size());
      const PartOfExecution part(execution, fraction * static_cast<double>(i), fraction);
      found.push_back(search(regions[i], request, part.execution()));
    }
    // The deadline may pass while ways out are sought; by then all regions have their designs.
    const PartOfExecution rest(execution, designs_fraction, 1 - designs_fraction);
    if (seeks_ways_out) add_ways_out(found, regions, request, rest.execution());
    if (!seeks_ways_out && execution.cost)
      execution.cost->add_effect(
          "ways_out", false,
          request.ways_out == Switch::off ? "the request turns it off" : "the request belongs to a session");
  });
  for (const auto& region : found)
    for (const auto& [design, simulated_error] : region.ranking)
      metrics.count_evaluations(region.models[design.space].id, design.evaluations);
  return json_result(json::write_design(request, found, bill));
}

PreparedComputation prepare_design(const EndpointRequest& asked, const Loader& loader) {
  auto request = std::make_shared<const json::DesignRequest>(
      json::parse_design(asked.body, loader.limits(), loader.cancellation()));
  auto regions = std::make_shared<std::vector<Region>>();
  for (std::size_t i = 0; i < request->regions.size(); ++i) {
    const auto pointer = request->several ? "/regions/" + std::to_string(i) : std::string();
    const auto& spec = request->regions[i];
    Region region{.spec = spec, .models = models_of(loader, spec, pointer), .pointer = pointer};
    check_targets(region);
    prepare_materials(region);
    if (request->seeks_ways_out()) region.others = models_of_other_families(loader.models(), region);
    regions->push_back(std::move(region));
  }
  return {.deadline = request->deadline,
          .session = request->session,
          .run = [request, regions, &metrics = loader.metrics()](const Execution& execution) {
            return compute_design(*regions, *request, metrics, execution);
          }};
}

store::Result compute_profile(const store::LoadedModel& model, const json::ProfileRequest& request,
                              metrics::Metrics& metrics, const Execution& outer) {
  design::Profile profile;
  const auto bill = billed(outer, [&](const Execution& execution) {
    profile = design::evaluate_profile(model.model, model.evaluator, request.parameters, request.samples,
                                       request.equilibrium_tolerance, execution);
    bill_error_bars(model.model, execution);
    const bool other_modulus = request.material && request.material->has_modulus;
    bill_requested(execution, "modulus", other_modulus);
    if (other_modulus)
      profile = design::scaled(std::move(profile), request.samples.task,
                               request.material->youngs_modulus.least / model.model.provenance.youngs_modulus);
    execution.checkpoint(1, "");
  });
  metrics.count_evaluations(model.model.id, profile.y.size());
  return json_result(json::write_profile(name_of(model), request, profile, bill));
}

PreparedComputation prepare_profile(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_profile(asked.body, loader.limits(), loader.cancellation());
  auto model = request.model.empty() ? model_of_family(loader, request.family, "")
                                     : model_by_id(loader.models(), request.model, "");
  if (request.material) check_material(*request.material, model->model, "/material");
  const auto expected = static_cast<std::size_t>(model->evaluator.shape().parameters);
  if (request.parameters.size() != expected) {
    const std::string text = "The family " + model->model.family + " has " + std::to_string(expected) +
                             " parameters, not " + std::to_string(request.parameters.size()) + ".";
    throw Error("design.parameter_count", text, {{"/parameters", text}});
  }
  return {.deadline = request.deadline,
          .run = [request = std::move(request), model = std::move(model), &metrics = loader.metrics()](
                     const Execution& execution) { return compute_profile(*model, request, metrics, execution); }};
}

}  // namespace

void add_design_routes(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "designs", .prepare = prepare_design});
  add_endpoint(router, services, {.kind = "profiles", .prepare = prepare_profile});
}

}  // namespace supple::routes
