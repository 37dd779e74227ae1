#pragma once

#include <memory>
#include <vector>

#include "chart.h"
#include "rest_shape.h"
#include "rod_elements.h"

namespace supple::weave {

/// E = EA / 2 sum_e (l_e - L_e)^2 / L_e over the edges: deformed length l, rest length L (mm); N mm. The same however
/// finely a uniformly stretched strand is cut.
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

enum class TurnKind { free, jointed };

/// E = EI / 2 sum_i ((k1_i - K_i)^2 + k2_i^2) / L_i over the turns of one kind: integrated curvatures k = 2 tan(angle /
/// 2) about the two material directors, rest turn K about the one that is normal to the rest plane, L half the rest
/// lengths of the turn's edges (mm); N mm. Discrete elastic rods' bending energy (Bergou et al. 2008, section 4.2) of
/// the nominal stiffness. A joint's half of a turn is spread over half of its one edge.
class PlanarBendEnergy : public Energy {
 public:
  PlanarBendEnergy(const RodModel& model, TurnKind kind);
  std::string_view name() const override { return kind_ == TurnKind::free ? "bend" : "joint_bend"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;

 private:
  struct Element {
    const Turn* turn;
    Eigen::Vector2d tangent;  ///< of the joint at rest
    RestTurn rest;
    ElementRows rows;
  };
  const RodModel& model_;
  TurnKind kind_;
  std::vector<Element> elements_;
};

/// What bending and twisting in space share: turns seen from the state's chart.
class SpatialTurns {
 public:
  SpatialTurns(const RodModel& model, TurnKind kind);

 protected:
  struct Element {
    std::size_t index;
    const Turn* turn;
    Eigen::Matrix3d frame;  ///< of the strand at the joint, at rest
    RestTurn rest;
    ElementRows rows;
  };
  const RodModel& model_;
  TurnKind kind_;
  std::vector<Element> elements_;
};

/// See PlanarBendEnergy; the material directors are the chart's reference directors turned by the edges' angles.
class SpatialBendEnergy : public Energy, private SpatialTurns {
 public:
  using SpatialTurns::SpatialTurns;
  std::string_view name() const override { return kind_ == TurnKind::free ? "bend" : "joint_bend"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
};

/// E = GJ / 2 sum_i (m_i - M_i)^2 / L_i: twist m = difference of the edges' angles plus the reference directors' twist
/// (Bergou et al. 2010), rest twist M, lengths L as in bending; N mm.
class TwistEnergy : public Energy, private SpatialTurns {
 public:
  using SpatialTurns::SpatialTurns;
  std::string_view name() const override { return kind_ == TurnKind::free ? "twist" : "joint_twist"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
};

}  // namespace supple::weave
