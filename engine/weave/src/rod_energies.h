#pragma once

#include <memory>
#include <vector>

#include "chart.h"
#include "rest_shape.h"
#include "rod_elements.h"

namespace supple::weave {

/// E = EA / 2 sum_e (l_e - L_e)^2 / L_e over the edges: deformed length l, rest length L (mm); N mm. For a uniformly
/// stretched strand it does not depend on the number of edges.
class StretchEnergy : public Energy {
 public:
  explicit StretchEnergy(const RodModel& model);
  std::string_view name() const override { return "stretch"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;

 private:
  struct Element {
    const Edge* edge;
    RestLength rest;
    ElementRows rows;
  };
  const RodModel& model_;
  std::vector<Element> elements_;
};

/// A free turn lies between two edges, and a jointed one between an edge and a joint.
enum class TurnKind { free, jointed };

/// E = EI / 2 sum_i ((k1_i - K_i)^2 + k2_i^2) / L_i over the turns of one kind, N mm. k1 and k2 are the integrated
/// curvatures 2 tan(angle / 2) about the two material directors. K is the integrated rest curvature about the director
/// that is normal to the rest plane. L is half the sum of the rest lengths of the turn's edges (mm). This is the
/// bending energy of discrete elastic rods [Bergou2008, section 4.2] with the nominal stiffness. A turn at a joint is
/// distributed over half of its one edge.
class PlanarBendEnergy : public Energy {
 public:
  PlanarBendEnergy(const RodModel& model, TurnKind kind);
  std::string_view name() const override { return kind_ == TurnKind::free ? "bend" : "joint_bend"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;

 private:
  struct Element {
    const Turn* turn;
    Eigen::Vector2d tangent;  ///< unit tangent of the rest curve at the joint
    RestTurn rest;
    ElementRows rows;
  };
  const RodModel& model_;
  TurnKind kind_;
  std::vector<Element> elements_;
};

/// The elements of bending and twisting in space. Both measure angles in the state's chart.
class SpatialTurns {
 public:
  SpatialTurns(const RodModel& model, TurnKind kind);

 protected:
  struct Element {
    std::size_t index;
    const Turn* turn;
    Eigen::Matrix3d frame;  ///< frame of the strand's rest curve at the turn; see rest_frame
    RestTurn rest;
    ElementRows rows;
  };
  const RodModel& model_;
  TurnKind kind_;
  std::vector<Element> elements_;
};

/// See PlanarBendEnergy. The material directors are the chart's reference directors rotated by the edges' angles.
class SpatialBendEnergy : public Energy, private SpatialTurns {
 public:
  using SpatialTurns::SpatialTurns;
  std::string_view name() const override { return kind_ == TurnKind::free ? "bend" : "joint_bend"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
};

/// E = GJ / 2 sum_i (m_i - M_i)^2 / L_i: twist m = difference of the edges' angles plus the twist of the reference
/// directors [Bergou2010], rest twist M, lengths L as in bending; N mm.
class TwistEnergy : public Energy, private SpatialTurns {
 public:
  using SpatialTurns::SpatialTurns;
  std::string_view name() const override { return kind_ == TurnKind::free ? "twist" : "joint_twist"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
};

}  // namespace supple::weave
