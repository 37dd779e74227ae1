#include <array>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include "mesh_cracks.h"
#include "supple/base/error.h"
#include "supple/surface/mesh_error.h"
#include "supple/surface/mesh_repair.h"

namespace supple::surface {
namespace {

/// The fault that TriangleMesh::build finds, or nothing. Throws faults that no repair removes.
std::optional<Error> fault_of(const TriangleSoup& soup, const Execution& execution) {
  try {
    TriangleMesh::build(soup.positions, soup.faces, {}, execution);
    return std::nullopt;
  } catch (const RepairableFault& fault) {
    return fault;
  }
}

bool has_cracks(const TriangleSoup& soup, const Execution& execution) {
  return find_cracks(soup.positions, soup.faces, MultipleEdges::separate, execution).vertices > 0;
}

/// A soup after repairs that leave no fault.
struct Repaired {
  TriangleSoup soup;
  RepairOutcome outcome;
};

/// Makes repairs one after the other, from `first` on, until there is no fault. Returns nothing if a fault remains.
std::optional<Repaired> try_repairs(const TriangleSoup& soup, std::size_t first, const MeshLimits& limits,
                                    const Execution& execution) {
  RepairOptions options;
  for (std::size_t step = first; step < repair_names.size(); ++step) {
    options.ask(static_cast<Repair>(step));
    Repaired repaired{soup, {}};
    try {
      repaired.outcome = repair_mesh(repaired.soup, options, limits, execution);
    } catch (const RepairableFault&) {
      return std::nullopt;
    } catch (const MeshSizeError&) {
      return std::nullopt;
    }
    if (repaired.outcome.made(static_cast<Repair>(step)) && !fault_of(repaired.soup, execution)) return repaired;
  }
  return std::nullopt;
}

/// The fault of a soup, and the result of the repairs that remove it.
struct Attempt {
  std::optional<Error> fault;
  std::optional<Repaired> repaired;  ///< empty if no repairs help, or if none are needed
};

Attempt attempt_repairs(const TriangleSoup& soup, std::optional<Error> fault, const MeshLimits& limits,
                        const Execution& execution) {
  Attempt attempt{std::move(fault), std::nullopt};
  if (!attempt.fault && !has_cracks(soup, execution)) return attempt;
  attempt.repaired = try_repairs(soup, 0, limits, execution);
  const bool without_weld = !attempt.repaired && attempt.fault;
  if (without_weld) attempt.repaired = try_repairs(soup, 1, limits, execution);
  return attempt;
}

/// The names of the repairs that were made, e.g. "weld,drop_degenerate".
std::string names_of(const RepairOutcome& outcome) {
  std::string names;
  for (std::size_t i = 0; i < repair_names.size(); ++i) {
    if (outcome.made(static_cast<Repair>(i))) names.append(names.empty() ? "" : ",").append(repair_names[i]);
  }
  return names;
}

/// The fault, with a clause added to its message.
Error with_advice(const Error& fault, const std::string& advice) {
  std::string sentence = fault.what();
  if (sentence.ends_with('.')) sentence.pop_back();
  return Error(fault.code(), sentence + "; " + advice + ".", fault.details());
}

constexpr const char* no_repair_helps = "no repair removes this fault";

}  // namespace

RepairOutcome repair_automatically(TriangleSoup& soup, const MeshLimits& limits, const Execution& execution) {
  Attempt attempt = attempt_repairs(soup, fault_of(soup, execution), limits, execution);
  if (attempt.repaired) {
    soup = std::move(attempt.repaired->soup);
    return std::move(attempt.repaired->outcome);
  }
  if (attempt.fault) throw with_advice(*attempt.fault, no_repair_helps);
  return repair_mesh(soup, {}, limits, execution);
}

TriangleMesh build_with_advice(const TriangleSoup& soup, const MeshLimits& limits, const Execution& execution) {
  try {
    // The soup is copied, because it is needed for repairs if there is a fault.
    return TriangleMesh::build(soup.positions, soup.faces, soup.warnings, execution);
  } catch (const RepairableFault& fault) {
    const auto repaired = attempt_repairs(soup, fault, limits, execution).repaired;
    throw with_advice(fault, repaired ? "uploaded with repair=" + names_of(repaired->outcome) + " the mesh is sound"
                                      : no_repair_helps);
  }
}

std::vector<std::string> crack_warnings(const TriangleMesh& mesh, const Execution& execution) {
  std::int32_t h = 0;
  while (h < mesh.halfedge_count() && mesh.twin(h) >= 0) ++h;
  if (h == mesh.halfedge_count()) return {};
  const Cracks cracks = find_cracks(mesh.positions(), mesh.faces(), MultipleEdges::separate, execution);
  if (cracks.vertices == 0) return {};
  const bool one = cracks.vertices == 1;
  std::string sentence = "The surface is open along cracks: " + std::to_string(cracks.vertices);
  if (cracks.gap > 0) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), cracks.gap, std::chars_format::general, 2).ptr;
    const std::string gap(digits.begin(), end);
    sentence += std::string(one ? " vertex differs" : " vertices differ") + " from " +
                (one ? "an earlier one" : "earlier ones") + " in the last digits, by up to " + gap + " mesh units";
  } else {
    sentence += std::string(one ? " vertex has" : " vertices have") + " the coordinates of " +
                (one ? "an earlier one" : "earlier ones");
  }
  const auto repaired = try_repairs({mesh.positions(), mesh.faces(), {}}, 0, {}, execution);
  const std::string names = repaired ? names_of(repaired->outcome) : "";
  sentence += names.empty() ? "; to join them would leave a surface that is not sound."
                            : "; uploaded with repair=" + names + " they are joined.";
  return {sentence};
}

}  // namespace supple::surface
