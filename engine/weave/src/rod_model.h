#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// The mean length of rod between crossings, in the unit of length in which weaves are computed (see natural_units.h).
inline constexpr double mean_rod_length = 4;

/// A place of a strand that must be a node because it is fixed or loaded.
struct Anchor {
  int strand = 0;
  double coordinate = 0;  ///< mm
  bool clamped = false;   ///< whether it gets a joint of its own, by which its direction can be fixed or turned
};

struct ModelOptions {
  bool spatial = false;  ///< three-dimensional, with twist; otherwise in the plane
  /// Number of pieces of rod between neighbouring crossings, ends and anchors of a strand. A curved strand that turns
  /// far gets more.
  int segments = 2;
  double max_segment_turn = 0.6;  ///< maximum turn of a curved strand within one piece, rad
  /// The macroscopic deformation gradient is F = sum_k f_k D_k with D = d d^T, d n^T, n d^T, n n^T. The unit vector d
  /// is at this angle from the x axis, rad, and n is normal to d.
  double direction = 0;
  /// Stops the construction of the model, and of the terms that are built for it.
  CancellationToken cancellation{};
};

/// The material coordinate of a node on its strand: start + sum of weights times the sliders' displacements, mm. A
/// sliding crossing has the weight 1 for its own slider. Nodes between two crossings divide the length between them in
/// constant ratios, so that no slider moves past another node.
struct MaterialCoordinate {
  double start = 0;
  std::array<int, 2> slider{-1, -1};
  std::array<double, 2> weight{0, 0};
};

struct Edge {
  int strand = 0;
  int tail = 0;                 ///< node where it begins
  int head = 0;                 ///< node where it ends
  Eigen::Vector2i shift{0, 0};  ///< lattice offset of the head's copy from the tail's
  MaterialCoordinate from;
  MaterialCoordinate to;
};

/// A turn: the bend and twist of a strand at a node, between two edges or between an edge and the direction of a rigid
/// joint.
struct Turn {
  int strand = 0;
  int in = -1;     ///< edge that ends at the node; -1 if the joint's direction takes its place
  int out = -1;    ///< edge that begins at the node; -1 if the joint's direction takes its place
  int joint = -1;  ///< -1 for none
  MaterialCoordinate at;
  double rest_twist = 0;            ///< rad
  bool naturally_straight = false;  ///< whether the rod is straight at rest and was bent into its curve
};

/// A strand that slides through a crossing.
struct Slider {
  int crossing = 0;
  int member = 0;
  int strand = 0;
  double start = 0;                                                    ///< coordinate at rest, mm
  double min_displacement = -std::numeric_limits<double>::infinity();  ///< mm
  double max_displacement = std::numeric_limits<double>::infinity();   ///< mm
};

/// Two neighbouring places of a strand of which at least one slides. `to` must stay ahead of `from`.
struct Gap {
  int strand = 0;
  MaterialCoordinate from;
  MaterialCoordinate to;
  bool at_end = false;  ///< one of the two is the strand's end, not a crossing
  /// The distance at which the strands that cross at the two places, or one of them and the end, touch; mm.
  double contact_distance = 0;
};

/// A weave that is discretized into nodes, edges and turns: an Eulerian-on-Lagrangian discretization [Cirio2014] of
/// discrete elastic rods [Bergou2008].
///
/// The degrees of freedom are, in this order:
/// - node positions (mm; 2 or 3 each);
/// - displacements of sliders (mm);
/// - in space, the edges' angles from the reference to the material directors (rad);
/// - joints (rad): 1 angle, or in space the 3 components of a rotation relative to the chart;
/// - for lattices, the 4 components f_k of the deformation gradient.
class RodModel {
 public:
  /// `weave` must be valid and outlive the model. O(nodes).
  RodModel(const Weave& weave, const std::vector<Anchor>& anchors, const ModelOptions& options);

  const Weave& weave() const { return *weave_; }
  bool spatial() const { return options_.spatial; }
  int dimension() const { return options_.spatial ? 3 : 2; }
  const ModelOptions& options() const { return options_; }
  /// Throws if the token of the options requests a stop.
  void check_for_stop() const { options_.cancellation.throw_if_requested(); }

  const std::vector<Eigen::Vector2d>& nodes() const { return nodes_; }  ///< rest positions
  const std::vector<Edge>& edges() const { return edges_; }
  std::vector<Turn>& turns() { return turns_; }
  const std::vector<Turn>& turns() const { return turns_; }
  const std::vector<Slider>& sliders() const { return sliders_; }
  const std::vector<Gap>& gaps() const { return gaps_; }
  int joints() const { return joints_; }
  int crossing_node(int crossing) const { return crossing_node_[static_cast<std::size_t>(crossing)]; }
  int anchor_node(std::size_t anchor) const { return anchor_node_[anchor]; }
  /// Index of the joint of a crossing or a clamped anchor; -1 for none.
  int crossing_joint(int crossing) const { return crossing_joint_[static_cast<std::size_t>(crossing)]; }
  int anchor_joint(std::size_t anchor) const { return anchor_joint_[anchor]; }
  /// One edge of each straight strand that nothing keeps from spinning about its own axis.
  const std::vector<int>& spinning_edges() const { return spinning_; }
  const Stiffness& stiffness(int strand) const { return stiffness_[static_cast<std::size_t>(strand)]; }
  const StrandCurve& curve(int strand) const { return weave_->strands[static_cast<std::size_t>(strand)].curve; }

  /// First degree of freedom of a node, a slider, an edge's angle, a joint, and the deformation gradient.
  int position(int node) const { return node * dimension(); }
  int slider(int index) const { return first_slider_ + index; }
  int angle(int edge) const { return first_angle_ + edge; }
  int joint(int index) const { return first_joint_ + index * (spatial() ? 3 : 1); }
  int strain() const { return strain_; }
  int size() const { return size_; }

  /// The degrees of freedom at rest.
  Eigen::VectorXd rest_state() const;
  /// The deformation gradient F for the strain components of q.
  Eigen::Matrix2d deformation_gradient(const Eigen::VectorXd& q) const;
  /// The four dyads D_k.
  const std::array<Eigen::Matrix2d, 4>& dyads() const { return dyads_; }
  /// The value of a material coordinate in the state q, mm.
  double coordinate(const MaterialCoordinate& c, const Eigen::VectorXd& q) const;
  /// Edge vector in the state q, mm; z is 0 in the plane.
  Eigen::Vector3d edge_vector(const Edge& edge, const Eigen::VectorXd& q) const;

 private:
  friend class ModelBuilder;
  const Weave* weave_;
  ModelOptions options_;
  std::vector<Stiffness> stiffness_;
  std::vector<Eigen::Vector2d> nodes_;
  std::vector<Edge> edges_;
  std::vector<Turn> turns_;
  std::vector<Slider> sliders_;
  std::vector<Gap> gaps_;
  std::vector<int> crossing_node_, crossing_joint_, anchor_node_, anchor_joint_, spinning_;
  std::array<Eigen::Matrix2d, 4> dyads_;
  int joints_ = 0;
  int first_slider_ = 0, first_angle_ = 0, first_joint_ = 0, strain_ = 0, size_ = 0;
};

}  // namespace supple::weave
