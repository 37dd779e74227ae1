#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/rest_shape.h"
#include "supple/microscale/material.h"
#include "supple/tiling/definition_check.h"
#include "supple/tiling/family.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::design {

inline constexpr int max_atlas_samples = 4096;

struct AtlasOptions {
  /// Points of the box, 1 to `max_atlas_samples`: the default parameters, and points of a Sobol sequence. More points
  /// find more of what the family can do; each takes 20 to 80 ms of one core.
  int samples = 256;
  /// Length of a triangle's side divided by the beam width, as tiling::MeshOptions::mesh_size.
  double mesh_size = 1;
  /// Samples that are solved a second time, on a mesh of half this size, so that the error of the first is known.
  int error_samples = 8;
  /// Whether tilings whose tiles cross themselves are solved, too.
  bool crossings = false;
  int max_nodes = 100'000;  ///< of one cell's mesh; samples that need more are not solved
  microscale::Material material{};
};

/// What is at one point of the box. The order is that of the checks.
enum class AtlasPlace {
  good,      ///< solved, and neither of the following
  sliver,    ///< solved; a corner, a side or a strait is a sliver, as DefinitionFlaw::sliver
  crossing,  ///< a tile crosses itself, which is solved if the options say so, or is turned inside out
  closed,    ///< no structure: beams close all holes of a tile, or the tile nearly vanishes
  unsolved,  ///< no stiffness: no mesh was made, it was too large, or the structure is a mechanism
};

struct AtlasSample {
  std::vector<double> parameters;
  AtlasPlace place = AtlasPlace::good;
  std::optional<Compliance> compliance;  ///< at rest, 1/MPa; none if it was not solved
  double relative_density = 0;           ///< fraction of the cell that is solid; 0 if there is no structure
  std::optional<double> error;  ///< relative difference of the stiffness from that on the second mesh, Frobenius norm
};

/// The nearest that a family comes to a reference profile at its samples.
struct AtlasProfile {
  std::string name;  ///< as ReferenceProfile::name
  std::size_t sample = 0;
  ProfileDistance distance;
};

/// A map of what a family of tilings can do at rest.
struct FamilyAtlas {
  std::string family;
  std::vector<tiling::Parameter> bounds;
  double mesh_size = 0;
  bool crossings = false;  ///< as in the options
  std::vector<AtlasSample> samples;
  std::vector<AtlasProfile> profiles;  ///< in the order of reference_profiles(); empty if nothing was solved
  /// Where in the box tiles begin to cross themselves, its slivers, and where tiles leave gaps because they are turned
  /// inside out, as `check_definition` finds them.
  std::vector<tiling::DefinitionFinding> warnings;
  /// Why it has fewer samples than asked for: the deadline, or a limit of memory.
  StopReason stopped = StopReason::none;

  std::size_t count(AtlasPlace place) const;
};

/// Samples a family's box: what cannot be built, what crosses or is a sliver, and the stiffness at rest of the rest,
/// each by one mesh and three linear solves. If the deadline or a limit of memory stops it, it answers with what it
/// has; the samples that were done are as evenly spread as all are. Throws "atlas.invalid_option", and
/// "atlas.faulty_definition" if the definition has faults near its default parameters, which its details locate. Equal
/// input gives equal samples (see tiling::mesh_structure).
///
/// A sample takes 20 to 80 ms of one core and little memory, that of one cell's mesh for each thread. Bills the stages
/// "meshing" and "stiffness", and the effects "crossings", "second_mesh" and "survey".
FamilyAtlas make_atlas(const tiling::Family& family, const AtlasOptions& options, const Execution& execution = {});

/// What a family adds to others, by their atlases.
struct AtlasComparison {
  struct Profile {
    std::string family;  ///< the other family that comes nearest to the reference profile
    ProfileDistance distance;
  };
  std::vector<Profile> profiles;  ///< one for each of the atlas's profiles; empty if no other family has any
  /// Distances of shapes (RestShape) of this family's samples from the nearest sample of all others: the median, the
  /// largest one, and the sample with it.
  double median_distance = 0;
  double largest_distance = 0;
  std::size_t farthest_sample = 0;
  double new_fraction = 0;  ///< fraction of the solved samples that are farther than `new_distance` from all others
  /// The family whose samples are all nearest, if the largest distance from them is at most `same_distance`: this one
  /// is the other one renamed, or a part of it.
  std::optional<std::string> same_as;
};

inline constexpr double new_distance = 0.1;
inline constexpr double same_distance = 1e-3;

/// Compares with other families; an atlas of the same family among them is left out. None if there is nothing to
/// compare. O(samples * samples of all others), some tens of milliseconds for eight families.
std::optional<AtlasComparison> compare(const FamilyAtlas& atlas, std::span<const FamilyAtlas* const> others);

/// The family of an isohedral type that its atlas is of: straight edges, parameters within 0.35 of their defaults, and
/// the relative beam width, from 0.05 to 0.2 of the mean side of the default tile, as one more parameter.
tiling::FamilyDefinition atlas_definition(const tiling::IsohedralType& type);

}  // namespace supple::design
