#pragma once

#include <memory>
#include <string>
#include <vector>

#include "report.h"
#include "supple/embedded/relaxation.h"

/// The studies of networks on surfaces, in the order of the page. Each adds its tables to the report.
namespace supple::bench {

struct NetworkSettings {
  /// Small meshes and few repetitions: shows that the program works, not what the numbers are.
  bool brief = false;
};

/// A network on a mesh of its own.
struct Scene {
  std::string name;
  std::shared_ptr<const surface::TriangleMesh> mesh;
  embedded::Network network;
};

/// One point in each face, and springs from it to those of the three neighbours: each pair has two, as in the scenes of
/// the thesis (3 springs for each face). Weights are 1 / (number of springs).
Scene face_scene(std::string name, surface::TriangleMesh mesh, const Eigen::Vector3d& barycentric);
/// The scenes of thesis fig. 3.4, near vertices and on edges, on closed meshes made here.
std::vector<Scene> face_scenes(const NetworkSettings& settings);

void measure_steps(Report& report, const NetworkSettings& settings);
void measure_scenes(Report& report, const NetworkSettings& settings);
void measure_methods(Report& report, const NetworkSettings& settings);
void measure_accuracy_of_networks(Report& report, const NetworkSettings& settings);
void measure_straight_springs(Report& report, const NetworkSettings& settings);
void measure_mollified_networks(Report& report, const NetworkSettings& settings);
void draw_kinds_of_vertices(Report& report, const NetworkSettings& settings);

}  // namespace supple::bench
