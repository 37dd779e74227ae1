#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace supple::weave {

/// How a strand is printed over another one without touching it. It rises before their crossing and comes down after
/// it.
struct Lift {
  double height = 1;  ///< height of the nozzle over a strand that lies on the bed, mm
  /// Half length of the top, on which the strand is fully up, at a right-angled crossing; mm. At another angle it is
  /// divided by the sine of that angle.
  double top = 0.75;
  double run = 2;       ///< distance from the crossing at which it begins to rise, or less if there is no room; mm
  double bridge = 2.5;  ///< two lifts closer than this are joined: the strand does not come down between them; mm
};

enum class ChannelShape {
  triangle,  ///< foot, apex, foot
  arc,       ///< a quarter of a sine wave up, another one down
};

/// The bridge over a sliding strand. It is fused on both sides to the strand across which the other one slides.
struct Channel {
  ChannelShape shape = ChannelShape::triangle;
  double half_width = 1.2;  ///< distance from the first foot to the crossing along the bottom strand, mm
  double longer = 0.2;      ///< relative excess length of the second half, whose sagging bead then clears the strand
  double apex = 2;          ///< height over the feet, mm
};

/// A printer, its material and how it prints strands. The defaults are a Prusa i3 MK3S with PLA, with the heights and
/// speeds of most of the nine sheets that have been printed (see `printed_samples.h`). Speeds are in mm/min and
/// temperatures in degrees Celsius.
struct PrinterProfile {
  std::string name = "Prusa i3 MK3S, PLA";
  Eigen::Vector3d bed{250, 210, 210};  ///< where the nozzle may go, from (0, 0, 0); mm
  double nozzle_diameter = 0.4;        ///< mm
  double filament_diameter = 1.75;     ///< mm
  double nozzle_temperature = 180;
  double bed_temperature = 60;

  double strand_width = 0.5;          ///< width of frames and grips, mm; strands have their own radius
  std::optional<double> bead_area{};  ///< area of every bead, mm^2; by default that of a circle of the strand's width
  double lifted_flow = 1;             ///< factor of the bead's area on lifted parts
  double channel_flow = 0.5;          ///< factor of the bead's area on channels
  double strand_height = 0.5;         ///< height of the nozzle over the bed, mm
  double travel_clearance = 1;        ///< height of the nozzle over everything that is printed, mm
  double retraction = 0.4;            ///< retraction of the filament around every travel, mm
  /// Length (mm) of the line that fills the nozzle before the print. It has the bead of a frame and lies along an edge
  /// of the bed that is clear of the print. It is left out if it is 0 or no edge is clear.
  double priming_length = 60;
  bool park = true;  ///< whether the nozzle ends at the rear left corner, out of the way of the print
  Lift lift{};
  Channel channel{};

  double strand_speed = 600;
  double lifted_speed = 600;
  double channel_speed = 300;
  double travel_speed = 3000;
  double retraction_speed = 2100;

  std::string startup_gcode{};  ///< lines after heating and homing
  std::string footer_gcode{};   ///< lines before the heaters are switched off
};

/// Throws "weave.invalid_option" with a detail for each value out of its range.
void validate(const PrinterProfile& profile);

/// The area (mm^2) of the bead of a strand with this radius (mm): `bead_area` of the profile, or else pi r^2.
double bead_area(const PrinterProfile& profile, double radius);

/// The millimetres of filament for one millimetre of a bead with this area (mm^2): area / (pi d^2 / 4).
double filament_per_mm(const PrinterProfile& profile, double area);

}  // namespace supple::weave
