#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/microscale/part_simulation.h"
#include "supple/tiling/mesh.h"

// The states of a part as files, lengths in mm and forces in N. VTU files are those of vtu.h. `displacements` are those
// of the mesh's nodes, mm.
namespace supple::microscale {

/// What the pictures of a part's states have in common, so that they can be shown one after the other.
struct PictureFrame {
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corners of what is shown, mm
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();
  double full_strain = 0;  ///< strain from which on triangles have the last colour, > 0
};

/// The frame that shows the part in all of these states, which have the displacements of their nodes. Colours reach to
/// the strain that 99 of 100 triangles do not exceed in the state in which this is largest: at corners strains grow
/// without limit as meshes become finer. O(m n log n) for m states of n triangles.
PictureFrame picture_frame(const tiling::PeriodicMesh& mesh, const std::vector<PartState>& states);

/// The deformed part as SVG, true to scale, coloured by the largest |principal stretch - 1| of each triangle, with the
/// scale of colours below. A triangle takes about 60 bytes. O(n).
std::string write_part_svg(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements,
                           const PictureFrame& frame);

/// The deformed part as Wavefront OBJ. Each quadratic triangle is four triangles between its six nodes. Numbers read
/// back as the same doubles. O(n).
std::string write_part_obj(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements);

/// The states as a table (CSV), one line each, counted from 0: the share of the path, the displacement, force and
/// number of touching nodes of each support k (displacement_x_k, ..., touching_k), energy (N mm), largest_strain,
/// contacts, stable, branch, stopped, residual (empty if it is not finite), iterations and load_steps.
std::string write_part_csv(const std::vector<PartState>& states);

}  // namespace supple::microscale
