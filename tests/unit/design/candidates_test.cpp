#include "supple/design/candidates.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "test_space.h"

namespace supple::design {
namespace {

const std::vector<ProfileSamples> stress_at_two_strains{
    {.task = Task::stress_strain, .direction = 0.3, .strain = 0.1, .x = {0.05, 0.1}}};

std::shared_ptr<const Candidates::Table> table_of(const TestSpace& space, const Eigen::VectorXd& lower,
                                                  const Eigen::VectorXd& upper, int count,
                                                  const Buildable& buildable = {}) {
  return space.candidates.table(lower, upper, count, stress_at_two_strains, buildable, {});
}

/// The number of candidates at corners of the box.
int corners(const Eigen::MatrixXd& parameters, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) {
  int found = 0;
  for (const auto& column : parameters.colwise())
    found += ((column.array() == lower.array()) || (column.array() == upper.array())).all() ? 1 : 0;
  return found;
}

TEST(Candidates, HoldEveryCornerOfTheBoxOnce) {
  const TestSpace space(3, 5);
  const auto& network = space.model.network;
  const auto table = table_of(space, network.lower, network.upper, 48);
  EXPECT_EQ(corners(table->parameters, network.lower, network.upper), 8);
  std::set<std::vector<double>> different;
  for (const auto& column : table->parameters.colwise()) different.insert({column.begin(), column.end()});
  EXPECT_EQ(different.size(), 48u);
}

TEST(Candidates, AreNeverMostlyCorners) {
  const TestSpace space(5, 6);
  const auto& network = space.model.network;
  const auto few = table_of(space, network.lower, network.upper, 40);
  EXPECT_EQ(corners(few->parameters, network.lower, network.upper), 0) << "32 of 40 would have been";
  const auto many = table_of(space, network.lower, network.upper, 64);
  EXPECT_EQ(corners(many->parameters, network.lower, network.upper), 32);
}

TEST(Candidates, KeepWhatIsHeldAndStayWithinBounds) {
  const TestSpace space(3, 7);
  Eigen::VectorXd lower = space.model.network.lower;
  const Eigen::VectorXd& upper = space.model.network.upper;
  lower[1] = upper[1];
  const auto table = table_of(space, lower, upper, 32);
  for (const auto& column : table->parameters.colwise()) {
    EXPECT_EQ(column[1], upper[1]);
    EXPECT_TRUE((column.array() >= lower.array()).all() && (column.array() <= upper.array()).all());
  }
}

TEST(Candidates, HaveNoValuesWhereNothingCanBeBuilt) {
  const TestSpace space(2, 8);
  const auto& network = space.model.network;
  const double middle = (network.lower[0] + network.upper[0]) / 2;
  const auto table = table_of(space, network.lower, network.upper, 32,
                              [&](const Eigen::VectorXd& parameters) { return parameters[0] < middle; });
  int left = 0;
  for (Eigen::Index c = 0; c < table->parameters.cols(); ++c) {
    const bool built = table->parameters(0, c) < middle;
    left += built ? 1 : 0;
    EXPECT_EQ(table->y.col(c).array().isNaN().all(), !built) << c;
  }
  EXPECT_GT(left, 8);
  EXPECT_LT(left, 24);
}

TEST(Candidates, AreMadeAnewForAnotherOrientation) {
  const TestSpace space(2, 5);
  const auto& network = space.model.network;
  auto turned = stress_at_two_strains;
  turned[0].orientation = 0.5;
  const auto table = table_of(space, network.lower, network.upper, 8);
  const auto other = space.candidates.table(network.lower, network.upper, 8, turned, {}, {});
  EXPECT_GT((table->y - other->y).norm(), 1e-3 * table->y.norm());
  turned[0].direction += 0.5;
  const auto along = space.candidates.table(network.lower, network.upper, 8, turned, {}, {});
  EXPECT_LT((table->y - along->y).norm(), 1e-5 * table->y.norm()) << "the same direction of the material";
}

TEST(Candidates, AreMadeOnceForTheSameSamples) {
  const TestSpace space(2, 9);
  const auto& network = space.model.network;
  const auto first = table_of(space, network.lower, network.upper, 16);
  EXPECT_EQ(first, table_of(space, network.lower, network.upper, 16));
  EXPECT_NE(first, table_of(space, network.lower, network.upper, 17));
}

}  // namespace
}  // namespace supple::design
