#pragma once

#include <string>
#include <vector>

#include "network_bench.h"
#include "supple/embedded/host.h"

/// The studies of networks on deformable shells and solids. Each writes sections of hosts.md.
namespace supple::bench {

/// A network and what carries it.
struct HostScene {
  Scene scene;
  embedded::Host host;

  /// The relaxation that ends once |grad E| <= gradient.
  embedded::RelaxationOptions options(double gradient) const;
};

/// Radius of the sphere that [Thesis, fig. 3.7] inflates: its bounding box has a diagonal of 1, as all meshes of these
/// studies.
extern const double sphere_radius;
surface::TriangleMesh sphere(int subdivisions);
/// A shell with the thesis's values: thickness 0.003, E 1e4, nu 0.48, volume weight 1e3.
embedded::ShellHost thesis_shell(double volume_scale);
/// Springs of weight `weight` / (their number), whose rest length is this fraction of their length on the mesh at rest.
/// The first vertex of the shell is fixed; so is every `fixed_every`-th point, or the first alone if that is 0.
HostScene shell_scene(const std::string& name, surface::TriangleMesh mesh, const std::vector<Eigen::Vector3d>& points,
                      double rest_fraction, double weight, std::size_t fixed_every, double volume_scale);
/// Points all over the sphere at this distance: 17 points for 0.2.
std::vector<Eigen::Vector3d> points_on_sphere(double distance);
/// The rabbit for the bunny of [Thesis, fig. 3.1]: E 10, and 1,000 in the top 15 %; nu 0.49; the lowest 10 % fixed.
/// Springs of rest length 0 join neighbouring points, every sixth of which is fixed. `element_size` is in mean edges.
HostScene rabbit_scene(int n, double spacing, double element_size);

/// Number of unknowns of points and nodes.
double unknowns_of(const HostScene& scene, const embedded::Relaxation& relaxed);
/// Length of all springs together.
double total_length(const embedded::Relaxation& relaxed);

/// Writes the sections "accuracy" and "refinement".
void study_host_accuracy(const NetworkSettings& settings);
void study_host_effects(const NetworkSettings& settings);
/// Writes the sections "steps" and "size".
void study_host_steps(const NetworkSettings& settings);
void study_host_scenes(const NetworkSettings& settings);

}  // namespace supple::bench
