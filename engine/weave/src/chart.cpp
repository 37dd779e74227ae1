#include "chart.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>

namespace supple::weave {
namespace {

/// Tangent and reference director on one side of a Turn.
struct Side {
  Eigen::Vector3d tangent;
  Eigen::Vector3d director;
};

Side side(const RodModel& model, const Chart& chart, const Turn& turn, int edge) {
  if (edge >= 0) {
    const auto e = static_cast<std::size_t>(edge);
    return {chart.tangent[e], chart.director[e]};
  }
  const Eigen::Matrix3d frame = chart.joint[static_cast<std::size_t>(turn.joint)] * rest_frame(model, turn);
  return {frame.col(0), frame.col(1)};
}

double twist_between(const Side& in, const Side& out) {
  const Eigen::Vector3d transported = transport(in.director, in.tangent, out.tangent);
  return -std::atan2(transported.dot(out.tangent.cross(out.director)), transported.dot(out.director));
}

}  // namespace

Eigen::Vector3d transport(const Eigen::Vector3d& v, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return v - v.dot(to) / (1 + from.dot(to)) * (from + to);
}

Eigen::Matrix3d cayley(const Eigen::Vector3d& w) {
  Eigen::Matrix3d skew;
  skew << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return Eigen::Matrix3d::Identity() + 1 / (1 + w.squaredNorm() / 4) * (skew + 0.5 * skew * skew);
}

Eigen::Matrix3d rest_frame(const RodModel& model, const Turn& turn) {
  const Eigen::Vector2d t = model.curve(turn.strand).at(turn.at.start).first.normalized();
  Eigen::Matrix3d frame;
  frame << t[0], -t[1], 0, t[1], t[0], 0, 0, 0, 1;
  return frame;
}

Chart flat_chart(const RodModel& model, const Eigen::VectorXd& q, const std::vector<double>& joint_angles) {
  Chart chart;
  chart.tangent.reserve(model.edges().size());
  chart.director.reserve(model.edges().size());
  for (const Edge& edge : model.edges()) {
    const Eigen::Vector3d t = model.edge_vector(edge, q).normalized();
    chart.tangent.push_back(t);
    chart.director.push_back(Eigen::Vector3d::UnitZ().cross(t).normalized());
  }
  chart.joint.assign(static_cast<std::size_t>(model.joints()), Eigen::Matrix3d::Identity());
  for (std::size_t j = 0; j < joint_angles.size(); ++j)
    chart.joint[j] = Eigen::AngleAxisd(joint_angles[j], Eigen::Vector3d::UnitZ()).toRotationMatrix();
  chart.twist.assign(model.turns().size(), 0.0);
  return chart;
}

Chart rebase(const RodModel& model, const Chart& chart, Eigen::VectorXd& q) {
  Chart next;
  const std::size_t edges = model.edges().size();
  next.tangent.resize(edges);
  next.director.resize(edges);
  for (std::size_t e = 0; e < edges; ++e) {
    next.tangent[e] = model.edge_vector(model.edges()[e], q).normalized();
    const Eigen::Vector3d transported = transport(chart.director[e], chart.tangent[e], next.tangent[e]);
    // Orthonormalization removes the drift of many transports.
    next.director[e] = (transported - transported.dot(next.tangent[e]) * next.tangent[e]).normalized();
  }
  next.joint.reserve(chart.joint.size());
  for (int j = 0; j < model.joints(); ++j) {
    const Eigen::Quaterniond rotated(cayley(q.segment<3>(model.joint(j))) * chart.joint[static_cast<std::size_t>(j)]);
    next.joint.emplace_back(rotated.normalized().toRotationMatrix());
    q.segment<3>(model.joint(j)).setZero();
  }
  next.twist.reserve(model.turns().size());
  for (std::size_t i = 0; i < model.turns().size(); ++i) {
    const Turn& turn = model.turns()[i];
    const double angle = twist_between(side(model, next, turn, turn.in), side(model, next, turn, turn.out));
    next.twist.push_back(angle + 2 * std::numbers::pi * std::round((chart.twist[i] - angle) / (2 * std::numbers::pi)));
  }
  return next;
}

}  // namespace supple::weave
