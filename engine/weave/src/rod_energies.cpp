#include "rod_energies.h"

#include <array>
#include <cmath>
#include <numbers>

namespace supple::weave {
namespace {

using numerics::inverse;

constexpr int rest_slots = SliderSlots::max_sliders;

bool is_of_kind(const Turn& turn, TurnKind kind) { return (turn.joint >= 0) == (kind == TurnKind::jointed); }

/// The gradient and the lower triangle of the Hessian of an element by its slots: first the n slots of its shape, then
/// the sliders.
template <int n>
struct Local {
  static constexpr int size = n + rest_slots;
  std::array<double, size> gradient{};
  std::array<double, size*(size + 1) / 2> hessian{};
  double& at(int i, int j) { return hessian[i * (i + 1) / 2 + j]; }
  double operator()(std::size_t i, std::size_t j) const { return hessian[i * (i + 1) / 2 + j]; }
};

/// Adds the derivatives of w / (2 L) sum_k (f_k - R_k)^2 to `local` and returns the value. The features f depend on the
/// shape, and the rest values R and L on the sliders. A null pointer in `rests` means that the rest value is constant.
template <int n, std::size_t count>
SUPPLE_INLINE double quadratic_energy(double weight, const std::array<Jet<n>, count>& features,
                                      const std::array<const RestJet*, count>& rests,
                                      const std::array<double, count>& constants, const RestJet& length, int sliders,
                                      Local<n>& local) {
  const double inverse_length = 1 / length.value;
  const double w = weight * inverse_length;
  double value = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Jet<n>& f = features[k];
    const double deviation = f.value - (rests[k] ? rests[k]->value : constants[k]);
    value += 0.5 * w * deviation * deviation;
    int entry = 0;
    for (int i = 0; i < n; ++i) {
      local.gradient[i] += w * deviation * f.first[i];
      const double scaled = w * f.first[i];
      for (int j = 0; j <= i; ++j, ++entry)
        local.hessian[entry] += w * deviation * f.second[entry] + scaled * f.first[j];
    }
    for (int u = 0; u < sliders; ++u) {
      const double du = rests[k] ? rests[k]->first[u] : 0;
      local.gradient[n + u] -= w * deviation * du + 0.5 * w * inverse_length * deviation * deviation * length.first[u];
      for (int i = 0; i < n; ++i)
        local.at(n + u, i) -= w * f.first[i] * (du + inverse_length * deviation * length.first[u]);
      for (int v = 0; v <= u; ++v) {
        const double dv = rests[k] ? rests[k]->first[v] : 0;
        const double second = rests[k] ? rests[k]->hessian(u, v) : 0;
        local.at(n + u, n + v) += w * (du * dv - deviation * second) +
                                  w * inverse_length * deviation * (du * length.first[v] + dv * length.first[u]) +
                                  0.5 * w * inverse_length * deviation * deviation *
                                      (2 * inverse_length * length.first[u] * length.first[v] - length.hessian(u, v));
      }
    }
  }
  return value;
}

}  // namespace

StretchEnergy::StretchEnergy(const RodModel& model) : model_(model) {
  elements_.reserve(model.edges().size());
  Links links;
  for (const Edge& edge : model.edges()) {
    model.check_for_stop();
    RestLength rest(model, edge);
    links.clear();
    link_edge(model, edge, 0, links);
    rest.slots().link(model, model.dimension(), links);
    elements_.push_back({&edge, rest, ElementRows(links)});
  }
}

void StretchEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  const int n = model_.dimension();
  const auto evaluate = [&](const Element& element, ElementContribution& contribution) {
    const Eigen::Vector3d e = model_.edge_vector(*element.edge, x);
    const RestJet rest = element.rest.at(model_, x, order);
    const double stiffness = model_.stiffness(element.edge->strand).stretch;
    const double l = e.norm();
    const double rest_length = rest.value;
    const double strain = (l - rest_length) / rest_length;
    contribution.value = 0.5 * stiffness * strain * strain * rest_length;
    if (order < 1) return;
    const Eigen::Vector3d t = e / l;
    const double slope_by_rest = -0.5 * stiffness * strain * (2 + strain);  // dE / dL = -EA / 2 (l^2 / L^2 - 1)
    std::array<double, 3 + rest_slots> gradient{};
    for (int c = 0; c < n; ++c) gradient[c] = stiffness * strain * t[c];
    for (int u = 0; u < rest_slots; ++u) gradient[n + u] = slope_by_rest * rest.first[u];
    const double across = stiffness * strain / l;
    const double along = stiffness / rest_length - across;
    const double mixed = -stiffness * l / (rest_length * rest_length);
    const double curvature_by_rest = stiffness * l * l / (rest_length * rest_length * rest_length);
    const auto hessian = [&](std::size_t slot, std::size_t other) {
      const int i = static_cast<int>(slot);
      const int j = static_cast<int>(other);
      if (i < n) return along * t[i] * t[j] + (i == j ? across : 0);
      if (j < n) return mixed * t[j] * rest.first[i - n];
      return curvature_by_rest * rest.first[i - n] * rest.first[j - n] + slope_by_rest * rest.hessian(i - n, j - n);
    };
    element.rows.contract(order, gradient, hessian, contribution);
  };
  add_rod_elements(elements_, order, evaluate, sum);
}

PlanarBendEnergy::PlanarBendEnergy(const RodModel& model, TurnKind kind) : model_(model), kind_(kind) {
  elements_.reserve(model.turns().size());
  Links links;
  for (const Turn& turn : model.turns()) {
    if (!is_of_kind(turn, kind)) continue;
    model.check_for_stop();
    RestTurn rest(model, turn);
    links.clear();
    for (const auto& [edge, slot] : {std::pair(turn.in, 0), std::pair(turn.out, 2)}) {
      if (edge >= 0) {
        link_edge(model, model.edges()[static_cast<std::size_t>(edge)], slot, links);
      } else {
        link_joint(model, turn.joint, slot, links);
      }
    }
    rest.slots().link(model, 4, links);
    elements_.push_back({&turn, rest_frame(model, turn).col(0).head<2>(), rest, ElementRows(links)});
  }
}

namespace {

/// A vector along an edge, or along the strand at a joint, in the plane.
Eigen::Vector2d planar_direction(const RodModel& model, int edge, const Turn& turn, const Eigen::Vector2d& tangent,
                                 const Eigen::VectorXd& x) {
  if (edge >= 0) return model.edge_vector(model.edges()[static_cast<std::size_t>(edge)], x).head<2>();
  const double angle = x[model.joint(turn.joint)];
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return {tangent[0] * c - tangent[1] * s, tangent[0] * s + tangent[1] * c};
}

/// Adds `sign` times the derivatives of a direction's angle to `angle`, from the slot `first` on. The variables of an
/// edge e are its components, and that of a joint is its rotation.
void add_angle(const Eigen::Vector2d& e, bool is_edge, double sign, int first, Jet<4>& angle) {
  if (!is_edge) {
    angle.first[first] += sign;
    return;
  }
  const double inverse_square = 1 / e.squaredNorm();
  const Eigen::Vector2d across = inverse_square * Eigen::Vector2d(-e[1], e[0]);
  angle.first[first] += sign * across[0];
  angle.first[first + 1] += sign * across[1];
  const auto second = [&](int i, int j) -> double& { return angle.second[i * (i + 1) / 2 + j]; };
  // Second derivatives by x and x, x and y, y and y.
  second(first, first) -= sign * 2 * across[0] * across[1];
  second(first + 1, first) += sign * (across[0] * across[0] - across[1] * across[1]);
  second(first + 1, first + 1) += sign * 2 * across[0] * across[1];
}

/// The bending energy of a planar turn and its derivatives.
double planar_bend(const RodModel& model, const Turn& turn, const Eigen::Vector2d& tangent, const RestTurnValue& rest,
                   int sliders, const Eigen::VectorXd& x, Local<4>& local) {
  const Eigen::Vector2d in = planar_direction(model, turn.in, turn, tangent, x);
  const Eigen::Vector2d out = planar_direction(model, turn.out, turn, tangent, x);
  const double k = integrated_curvature(in, out);
  Jet<4> angle;
  add_angle(in, turn.in >= 0, -1, 0, angle);
  add_angle(out, turn.out >= 0, 1, 2, angle);
  return quadratic_energy<4, 1>(model.stiffness(turn.strand).bend, {integrated_curvature(k, angle)}, {&rest.curvature},
                                {0}, rest.length, sliders, local);
}

}  // namespace

void PlanarBendEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  const auto evaluate = [&](const Element& element, ElementContribution& contribution) {
    const Turn& turn = *element.turn;
    const RestTurnValue rest = element.rest.at(model_, x, order);
    const double stiffness = model_.stiffness(turn.strand).bend;
    if (order < 1) {
      const double k = integrated_curvature(planar_direction(model_, turn.in, turn, element.tangent, x),
                                            planar_direction(model_, turn.out, turn, element.tangent, x));
      const double deviation = k - rest.curvature.value;
      contribution.value = 0.5 * stiffness / rest.length.value * deviation * deviation;
      return;
    }
    Local<4> local;
    const int sliders = element.rest.slots().count();
    contribution.value = planar_bend(model_, turn, element.tangent, rest, sliders, x, local);
    element.rows.contract(order, local.gradient, local, contribution);
  };
  add_rod_elements(elements_, order, evaluate, sum);
}

SpatialTurns::SpatialTurns(const RodModel& model, TurnKind kind) : model_(model), kind_(kind) {
  elements_.reserve(model.turns().size());
  Links links;
  for (std::size_t i = 0; i < model.turns().size(); ++i) {
    const Turn& turn = model.turns()[i];
    if (!is_of_kind(turn, kind)) continue;
    model.check_for_stop();
    RestTurn rest(model, turn);
    links.clear();
    for (const auto& [edge, slot] : {std::pair(turn.in, 0), std::pair(turn.out, 4)}) {
      if (edge >= 0) {
        link_edge(model, model.edges()[static_cast<std::size_t>(edge)], slot, links);
        links.push_back({model.angle(edge), slot + 3, 1});
      } else {
        link_joint(model, turn.joint, slot, links);
      }
    }
    rest.slots().link(model, 8, links);
    elements_.push_back({i, &turn, rest_frame(model, turn), rest, ElementRows(links)});
  }
}

namespace {

/// One side of a turn: its tangent, the reference directors d1 and d2, the angle from these to the material directors,
/// and the material directors m1 and m2.
template <typename T>
struct Side {
  Vector3<T> tangent;
  Vector3<T> d1;
  Vector3<T> d2;
  T angle;
  Vector3<T> m1;
  Vector3<T> m2;
};

template <typename T>
SUPPLE_INLINE T variable(double at, int index) {
  if constexpr (std::is_same_v<T, double>) {
    return at;
  } else {
    return T::variable(at, index);
  }
}

SUPPLE_INLINE Vector3<double> to_vector3(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// Parallel transport d - (d . t) / (1 + t0 . t) (t0 + t) of d from t0 to t; see `transport` of the chart.
template <typename T, typename S>
SUPPLE_INLINE Vector3<T> transported(const Vector3<S>& d, const Vector3<S>& from, const Vector3<T>& to) {
  const T along = dot(to, d) * inverse(1.0 + dot(to, from));
  return {d.x - along * (from.x + to.x), d.y - along * (from.y + to.y), d.z - along * (from.z + to.z)};
}

template <typename T>
SUPPLE_INLINE Side<T> edge_side(const RodModel& model, const Chart& chart, int edge, const Eigen::VectorXd& x) {
  using std::cos;
  using std::sin;
  const auto index = static_cast<std::size_t>(edge);
  const Eigen::Vector3d e = model.edge_vector(model.edges()[index], x);
  const Vector3<T> vector{variable<T>(e[0], 0), variable<T>(e[1], 1), variable<T>(e[2], 2)};
  Side<T> side;
  side.tangent = inverse(norm(vector)) * vector;
  side.d1 = transported(to_vector3(chart.director[index]), to_vector3(chart.tangent[index]), side.tangent);
  side.d2 = cross(side.tangent, side.d1);
  side.angle = variable<T>(x[model.angle(edge)], 3);
  const T c = cos(side.angle);
  const T n = sin(side.angle);
  side.m1 = c * side.d1 + n * side.d2;
  side.m2 = c * side.d2 - n * side.d1;
  return side;
}

/// v after Cayley's rotation by w, where `factor` is 1 / (1 + |w|^2 / 4).
template <typename T>
SUPPLE_INLINE Vector3<T> rotated(const Vector3<T>& w, const T& factor, const Vector3<double>& v) {
  const Vector3<T> once = cross(w, v);
  const Vector3<T> twice = cross(w, once);
  return {v.x + factor * (once.x + 0.5 * twice.x), v.y + factor * (once.y + 0.5 * twice.y),
          v.z + factor * (once.z + 0.5 * twice.z)};
}

template <typename T>
SUPPLE_INLINE Side<T> joint_side(const RodModel& model, const Chart& chart, int joint, const Eigen::Matrix3d& frame,
                                 const Eigen::VectorXd& x) {
  const Eigen::Matrix3d at = chart.joint[static_cast<std::size_t>(joint)] * frame;
  const int dof = model.joint(joint);
  const Vector3<T> w{variable<T>(x[dof], 0), variable<T>(x[dof + 1], 1), variable<T>(x[dof + 2], 2)};
  const T factor = inverse(1.0 + 0.25 * dot(w, w));
  Side<T> side;
  side.tangent = rotated(w, factor, to_vector3(at.col(0)));
  side.d1 = side.m1 = rotated(w, factor, to_vector3(at.col(1)));
  side.d2 = side.m2 = rotated(w, factor, to_vector3(at.col(2)));
  side.angle = T(0.0);
  return side;
}

/// Number of variables of one side of a turn, and jets of one side and of both.
constexpr int side_variables = 4;
using SideJet = Jet<side_variables>;
using TurnJet = Jet<2 * side_variables>;

/// A jet of one side as a jet of both sides. Its own variables begin with `first`.
SUPPLE_INLINE TurnJet widen(const SideJet& narrow, int first) {
  TurnJet wide(narrow.value);
  int entry = 0;
  for (int i = 0; i < side_variables; ++i) {
    wide.first[first + i] = narrow.first[i];
    for (int j = 0; j <= i; ++j, ++entry)
      wide.second[(first + i) * (first + i + 1) / 2 + first + j] = narrow.second[entry];
  }
  return wide;
}
SUPPLE_INLINE Vector3<TurnJet> widen(const Vector3<SideJet>& v, int first) {
  return {widen(v.x, first), widen(v.y, first), widen(v.z, first)};
}

/// One side of a turn. It depends on its own variables alone, so that jets are widened only after it has been computed.
template <typename T>
SUPPLE_INLINE Side<T> side(const RodModel& model, const Chart& chart, int edge, const Turn& turn,
                           const Eigen::Matrix3d& frame, int first, const Eigen::VectorXd& x) {
  if constexpr (std::is_same_v<T, double>) {
    return edge >= 0 ? edge_side<double>(model, chart, edge, x)
                     : joint_side<double>(model, chart, turn.joint, frame, x);
  } else {
    const Side<SideJet> own =
        edge >= 0 ? edge_side<SideJet>(model, chart, edge, x) : joint_side<SideJet>(model, chart, turn.joint, frame, x);
    return {widen(own.tangent, first), widen(own.d1, first), widen(own.d2, first),
            widen(own.angle, first),   widen(own.m1, first), widen(own.m2, first)};
  }
}

/// Integrated curvatures about the second material director and about minus the first one, averaged over the two sides.
template <typename T>
SUPPLE_INLINE std::array<T, 2> curvatures(const Side<T>& in, const Side<T>& out) {
  const Vector3<T> binormal = inverse(1.0 + dot(in.tangent, out.tangent)) * cross(in.tangent, out.tangent);
  return {dot(binormal, in.m2 + out.m2), -dot(binormal, in.m1 + out.m1)};
}

SUPPLE_INLINE double value_of(double x) { return x; }
template <int n>
SUPPLE_INLINE double value_of(const Jet<n>& x) {
  return x.value;
}

/// Twist of a turn, rad. The reference twist is known up to full turns, and the value nearest to `chart_twist` is
/// taken.
template <typename T>
SUPPLE_INLINE T twist(const Side<T>& in, const Side<T>& out, double chart_twist) {
  using std::atan2;
  const Vector3<T> director = transported(in.d1, in.tangent, out.tangent);
  const T reference = -atan2(dot(director, out.d2), dot(director, out.d1));
  const double full_turns = std::round((chart_twist - value_of(reference)) / (2 * std::numbers::pi));
  return reference + 2 * std::numbers::pi * full_turns + (out.angle - in.angle);
}

/// The bending and the twisting energy of a spatial turn and their derivatives.
SUPPLE_INLINE double spatial_bend(const RodModel& model, const Chart& chart, const Turn& turn,
                                  const Eigen::Matrix3d& frame, const RestTurnValue& rest, int sliders,
                                  const Eigen::VectorXd& x, Local<8>& local) {
  using J = TurnJet;
  const std::array<J, 2> k =
      curvatures(side<J>(model, chart, turn.in, turn, frame, 0, x), side<J>(model, chart, turn.out, turn, frame, 4, x));
  return quadratic_energy<8, 2>(model.stiffness(turn.strand).bend, k, {&rest.curvature, nullptr}, {0, 0}, rest.length,
                                sliders, local);
}
SUPPLE_AVX2 double spatial_bend_avx2(const RodModel& model, const Chart& chart, const Turn& turn,
                                     const Eigen::Matrix3d& frame, const RestTurnValue& rest, int sliders,
                                     const Eigen::VectorXd& x, Local<8>& local) {
  return spatial_bend(model, chart, turn, frame, rest, sliders, x, local);
}

SUPPLE_INLINE double spatial_twist(const RodModel& model, const Chart& chart, const Turn& turn,
                                   const Eigen::Matrix3d& frame, const RestTurnValue& rest, int sliders,
                                   double chart_twist, const Eigen::VectorXd& x, Local<8>& local) {
  using J = TurnJet;
  const J m = twist(side<J>(model, chart, turn.in, turn, frame, 0, x),
                    side<J>(model, chart, turn.out, turn, frame, 4, x), chart_twist);
  return quadratic_energy<8, 1>(model.stiffness(turn.strand).twist, {m}, {nullptr}, {turn.rest_twist}, rest.length,
                                sliders, local);
}
SUPPLE_AVX2 double spatial_twist_avx2(const RodModel& model, const Chart& chart, const Turn& turn,
                                      const Eigen::Matrix3d& frame, const RestTurnValue& rest, int sliders,
                                      double chart_twist, const Eigen::VectorXd& x, Local<8>& local) {
  return spatial_twist(model, chart, turn, frame, rest, sliders, chart_twist, x, local);
}

}  // namespace

void SpatialBendEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  const Chart& chart = state.chart();
  const auto evaluate = [&](const Element& element, ElementContribution& contribution) {
    const Turn& turn = *element.turn;
    const RestTurnValue rest = element.rest.at(model_, x, order);
    const double stiffness = model_.stiffness(turn.strand).bend;
    if (order < 1) {
      const auto [k1, k2] = curvatures(side<double>(model_, chart, turn.in, turn, element.frame, 0, x),
                                       side<double>(model_, chart, turn.out, turn, element.frame, 4, x));
      const double deviation = k1 - rest.curvature.value;
      contribution.value = 0.5 * stiffness / rest.length.value * (deviation * deviation + k2 * k2);
      return;
    }
    Local<8> local;
    const int sliders = element.rest.slots().count();
    contribution.value = has_avx2 ? spatial_bend_avx2(model_, chart, turn, element.frame, rest, sliders, x, local)
                                  : spatial_bend(model_, chart, turn, element.frame, rest, sliders, x, local);
    element.rows.contract(order, local.gradient, local, contribution);
  };
  add_rod_elements(elements_, order, evaluate, sum);
}

void TwistEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  const Chart& chart = state.chart();
  const auto evaluate = [&](const Element& element, ElementContribution& contribution) {
    const Turn& turn = *element.turn;
    const RestTurnValue rest = element.rest.at(model_, x, order);
    const double stiffness = model_.stiffness(turn.strand).twist;
    const double chart_twist = chart.twist[element.index];
    if (order < 1) {
      const double m = twist(side<double>(model_, chart, turn.in, turn, element.frame, 0, x),
                             side<double>(model_, chart, turn.out, turn, element.frame, 4, x), chart_twist);
      contribution.value = 0.5 * stiffness / rest.length.value * (m - turn.rest_twist) * (m - turn.rest_twist);
      return;
    }
    Local<8> local;
    const int sliders = element.rest.slots().count();
    contribution.value =
        has_avx2 ? spatial_twist_avx2(model_, chart, turn, element.frame, rest, sliders, chart_twist, x, local)
                 : spatial_twist(model_, chart, turn, element.frame, rest, sliders, chart_twist, x, local);
    element.rows.contract(order, local.gradient, local, contribution);
  };
  add_rod_elements(elements_, order, evaluate, sum);
}

}  // namespace supple::weave
