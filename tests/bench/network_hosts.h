#pragma once

#include <string>
#include <vector>

#include "network_bench.h"
#include "supple/embedded/host.h"

/// The studies of networks on shells and solids that give way, in the order of their page.
namespace supple::bench {

/// A network and what carries it.
struct HostScene {
  Scene scene;
  embedded::Host host;

  /// The relaxation that ends once |grad E| <= gradient.
  embedded::RelaxationOptions options(double gradient) const;
};

/// Of the sphere that thesis fig. 3.7 inflates: its bounding box has a diagonal of 1, as all meshes of these studies.
extern const double sphere_radius;
surface::TriangleMesh sphere(int subdivisions);
/// Made of the thesis's rubber: thickness 0.003, E 1e4, nu 0.48, volume weight 1e3.
embedded::ShellHost thesis_shell(double volume_scale);
/// Springs of weight `weight` / (their number) and this share of their length on the mesh at rest, the first vertex of
/// the shell fixed. `fixed_every` > 0: every so manieth point stays, else the first.
HostScene shell_scene(const std::string& name, surface::TriangleMesh mesh, const std::vector<Eigen::Vector3d>& points,
                      double rest_share, double weight, std::size_t fixed_every, double volume_scale);
/// Points all over the sphere, 17 for 0.2.
std::vector<Eigen::Vector3d> points_on_sphere(double distance);
/// The rabbit for the bunny of thesis fig. 3.1: E 10 and 1,000 in the top 15 %, nu 0.49, the lowest 10 % fixed, springs
/// of rest length 0 between neighbours of 48 points, every sixth of which stays. `element_size` is in mean edges.
HostScene rabbit_scene(int n, double spacing, double element_size);

/// Unknowns of points and of nodes.
double unknowns_of(const HostScene& scene, const embedded::Relaxation& relaxed);
/// Of the springs.
double total_length(const embedded::Relaxation& relaxed);

void measure_host_scenes(Report& report, const NetworkSettings& settings);
void measure_host_steps(Report& report, const NetworkSettings& settings);
void measure_host_accuracy(Report& report, const NetworkSettings& settings);
void measure_host_effects(Report& report, const NetworkSettings& settings);

}  // namespace supple::bench
