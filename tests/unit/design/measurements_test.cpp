#include "supple/design/measurements.h"

#include <gtest/gtest.h>

#include <string>

#include "supple/base/error.h"
#include "supple/design/measured_curve.h"
#include "support/expect_error.h"

namespace supple::design {
namespace {

using testing::text_or_places;

MeasurementRequest table_of(std::string text) {
  MeasurementRequest request;
  request.text = std::move(text);
  return request;
}

/// The places of the error's details, in their order.
std::string places_of(const MeasurementRequest& request) {
  const auto read = [&] {
    read_measurements(request);
    return "nothing thrown";
  };
  return text_or_places(read, "design.invalid_measurement");
}

bool says(const Measurements& found, const std::string& words, const std::string& where) {
  for (const auto& note : found.notes) {
    if (note.text.find(words) != std::string::npos && note.where == where) return true;
  }
  return false;
}

TEST(Measurements, AskForUnitsThatAreMissingOrUnknown) {
  EXPECT_EQ(places_of(table_of("Strain,Stress\n0,0\n1,2\n")), "units/x units/y");
  EXPECT_EQ(places_of(table_of("0,0\n1,2\n")), "units/x units/y");
  EXPECT_EQ(places_of(table_of("Strain (%),Stress (furlong)\n0,0\n1,2\n")), "units/y");
  EXPECT_EQ(places_of(table_of("Strain (%),Stress (mPa)\n0,0\n1,2\n")), "units/y") << "a million times less than MPa";
  auto given = table_of("Strain,Stress (furlong)\n0,0\n5,2\n");
  given.x_unit = "%";
  given.y_unit = "KPA";
  const Measurements found = read_measurements(given);
  EXPECT_EQ(found.x_unit, "%");
  EXPECT_EQ(found.y_unit, "kPa");
  EXPECT_NEAR((found.curve.points[1] - Eigen::Vector2d(0.05, 0.002)).norm(), 0, 1e-15);
  MeasurementRequest points;
  points.points = {{0, 0}, {0.1, 2}};
  EXPECT_EQ(read_measurements(points).y_unit, "MPa") << "the contract's own";
  points.y_unit = "furlong";
  EXPECT_EQ(places_of(points), "units/y");
}

TEST(Measurements, AskForAllThatIsMissingAtOnce) {
  EXPECT_EQ(places_of(table_of("Extension (mm),Load (N)\n0,0\n1,2\n")), "specimen/gauge_length specimen/area");
  EXPECT_EQ(places_of(table_of("Position (mm),Load\n120,0\n121,2\n")), "units/y specimen/gauge_length zero");
}

TEST(Measurements, SayWhatOfTheSpecimenWasNotUsed) {
  auto request = table_of("Time (s),Load (N),Displacement (mm),Stress (MPa),Strain (%)\n0,0,0,0,0\n1,2,1,0.025,2\n");
  request.specimen = {50, 80};
  const Measurements found = read_measurements(request);
  EXPECT_EQ(found.columns.x, 4U);
  EXPECT_TRUE(says(found, "gauge length was not used", "specimen/gauge_length"));
  EXPECT_TRUE(says(found, "cross-section was not used", "specimen/area"));
}

TEST(Measurements, CountDisplacementsFromWhereTheRequestSays) {
  auto request = table_of("Position (mm),Load (N)\n120,0\n121,2\n125,9\n");
  request.specimen = {50, 20};
  EXPECT_EQ(places_of(request), "zero");
  request.zero = ZeroChoice::first;
  EXPECT_NEAR(read_measurements(request).curve.points[2].x(), 0.1, 1e-15);
  request.zero = ZeroChoice::as_written;
  EXPECT_NEAR(read_measurements(request).curve.points[2].x(), 2.5, 1e-15);
  auto near = table_of("Position (mm),Load (N)\n0.1,0\n1,2\n5,9\n");
  near.specimen = {50, 20};
  EXPECT_EQ(places_of(near), "nothing thrown") << "a preload";
}

TEST(Measurements, TakeTheSenseFromTitlesRemarksAndSigns) {
  const auto sense = [](const std::string& text, Sense asked = Sense::automatic) -> std::string {
    auto request = table_of(text);
    request.sense = asked;
    return text_or_places([&] {
      const Measurements found = read_measurements(request);
      const auto& last = found.curve.points.back();
      return to_string(found.sense) + " by " + to_string(found.told_by) + (last.x() < 0 ? " -" : " +") +
             (last.y() < 0 ? "-" : "+");
    });
  };
  EXPECT_EQ(sense("Compressive strain (%);Compressive stress (kPa)\n0;0\n5;21\n"), "compression by titles --");
  EXPECT_EQ(sense("Stauchung [%];Druckspannung [kPa]\n0;0\n5;21\n"), "compression by titles --");
  EXPECT_EQ(sense("Tensile strain (%);Tensile stress (kPa)\n0;0\n5;21\n"), "tension by titles ++");
  EXPECT_EQ(sense("Zugversuch 17\n\nDehnung [%];Spannung [kPa]\n0;0\n5;21\n"), "tension by remarks ++");
  EXPECT_EQ(sense("Bluehill Compression Test\n\nStrain (%);Stress (kPa)\n0;0\n5;21\n"), "compression by remarks --");
  EXPECT_EQ(sense("3D-Druck, gedruckt in TPU\n\nStrain (%);Stress (kPa)\n0;0\n5;21\n"), "tension by nothing ++");
  EXPECT_EQ(sense("Strain (%);Stress (kPa)\n0;0\n-5;-21\n"), "compression by signs --");
  EXPECT_EQ(sense("Strain (%);Stress (kPa)\n-5;-21\n0;0\n5;21\n"), "both by signs ++");
  EXPECT_EQ(sense("Strain (%);Stress (kPa)\n0;0\n-5;21\n"), "sense") << "opposite signs";
  EXPECT_EQ(sense("Compressive strain (%);Stress (kPa)\n0;0\n-5;21\n"), "compression by titles --");
  EXPECT_EQ(sense("Compressive strain (%);Tensile stress (kPa)\n0;0\n5;21\n"), "sense");
  EXPECT_EQ(sense("Strain (%);Stress (kPa)\n0;0\n5;21\n", Sense::compression), "compression by request --");
  EXPECT_EQ(sense("Compressive strain (%);Stress (kPa)\n0;0\n-5;-21\n", Sense::tension), "tension by request ++");
  EXPECT_EQ(sense("Strain (%);Stress (kPa)\n5;21\n0;0\n-5;-21\n", Sense::compression), "both by request ++");
  EXPECT_TRUE(
      says(read_measurements(table_of("Strain (%);Stress (kPa)\n0;0\n5;21\n")), "tension was assumed", "sense"));
}

TEST(Measurements, ReadStretchesAndAskWhereTheyAreNone) {
  const Measurements found = read_measurements(table_of("Stretch,Stress (kPa)\n1,0\n1.5,21\n"));
  EXPECT_EQ(found.x_unit, "stretch");
  EXPECT_NEAR(found.curve.points[1].x(), 0.5, 1e-15);
  EXPECT_EQ(read_measurements(table_of("\xCE\xBB [-];Stress (kPa)\n1;0\n1.5;21\n")).x_unit, "stretch");
  EXPECT_EQ(places_of(table_of("Stretch,Stress (kPa)\n0,0\n0.5,21\n")), "units/x");
  EXPECT_EQ(places_of(table_of("Stretch (%),Stress (kPa)\n100,0\n150,21\n")), "units/x");
  EXPECT_EQ(read_measurements(table_of("Stretch (%),Stress (kPa)\n0,0\n50,21\n")).x_unit, "%");
}

TEST(Measurements, SayWhichOfSeveralWasTaken) {
  const Measurements beside =
      read_measurements(table_of("Strain 1 (%),Stress 1 (kPa),Strain 2 (%),Stress 2 (kPa)\n0,0,0,0\n1,2,1,3\n"));
  EXPECT_TRUE(says(beside, "2 columns may be x: column 0 \"Strain 1 (%)\" was taken", "columns"));
  const Measurements below =
      read_measurements(table_of("Strain (%),Stress (kPa)\n0,0\n5,21\nStrain (%),Stress (kPa)\n0,0\n5,18\n"));
  EXPECT_TRUE(says(below, "2 blocks of rows: block 0 was read", "block"));
}

}  // namespace
}  // namespace supple::design
