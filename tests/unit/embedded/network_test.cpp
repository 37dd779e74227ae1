#include "supple/embedded/network.h"

#include <gtest/gtest.h>

#include <limits>

#include "supple/base/error.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

Network two_points() {
  Network network;
  network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{1}, {0.2, 0.3, 0.5}}};
  network.springs = {{0, 1, 0, 1}};
  return network;
}

struct Fault {
  const char* code;
  const char* where;
  const char* what;  ///< part of the message
};

void expect_refused(const surface::TriangleMesh& mesh, const Network& network, const Fault& fault) {
  try {
    checked_network(mesh, network);
    FAIL() << "not refused: " << fault.code;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), fault.code);
    ASSERT_FALSE(error.details().empty());
    EXPECT_EQ(error.details().front().where, fault.where);
    EXPECT_NE(error.details().front().message.find(fault.what), std::string::npos) << error.details().front().message;
  }
}

TEST(CheckedNetwork, NamesTheEntryThatIsWrongAndTheLimit) {
  const auto mesh = testing::icosphere(1);
  Network network = two_points();
  network.points.clear();
  expect_refused(mesh, network, {"network.no_points", "points", "empty"});
  network = two_points();
  network.springs[0].to = 2;
  expect_refused(mesh, network, {"network.spring", "springs/0/between/1", "from 0 to 1"});
  network.springs[0].to = -1;
  expect_refused(mesh, network, {"network.spring", "springs/0/between/1", "-1"});
  network.springs[0].to = 0;
  expect_refused(mesh, network, {"network.spring", "springs/0/between", "twice"});
  network = two_points();
  network.springs[0].weight = -1;
  expect_refused(mesh, network, {"network.spring", "springs/0/weight", "negative"});
  network.springs[0].weight = std::numeric_limits<double>::quiet_NaN();
  expect_refused(mesh, network, {"network.spring", "springs/0/weight", "finite"});
  network = two_points();
  network.springs[0].rest_length = -1e-300;
  expect_refused(mesh, network, {"network.spring", "springs/0/rest_length", "negative"});
  network = two_points();
  network.fixed_points = {1, 7};
  expect_refused(mesh, network, {"network.fixed_point", "fixed_points/1", "from 0 to 1"});
  network = two_points();
  network.points[1].face = FaceId{mesh.face_count()};
  EXPECT_THROW(checked_network(mesh, network), Error);
}

TEST(CheckedNetwork, RefusesSpringsBetweenComponents) {
  const auto mesh = testing::two_components();
  Network network = two_points();
  network.points[1].face = FaceId{mesh.face_count() - 1};
  expect_refused(mesh, network, {"network.unreachable", "springs/0/between", "component"});
  network.springs.clear();
  EXPECT_EQ(checked_network(mesh, network).points.size(), 2U);
}

}  // namespace
}  // namespace supple::embedded
