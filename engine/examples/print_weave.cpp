/// Lays out strands, pulls the sheet apart, and writes the G-code that prints it. Prints what the sheet and the print
/// are like, and how many faults an independent check finds in the G-code.
///
///     print_weave FILE.gcode
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "supple/weave/gcode.h"
#include "supple/weave/gcode_check.h"
#include "supple/weave/shortcuts.h"
#include "supple/weave/simulation.h"

namespace {

void write_sheet(const char* path) {
  using namespace supple;
  // Three strands along x and three along y, 10 mm apart, each a matrix with one row for each of its points.
  std::vector<Eigen::MatrixXd> strands;
  for (const double offset : {10.0, 20.0, 30.0}) {
    strands.push_back((Eigen::MatrixXd(2, 2) << 0, offset, 40, offset).finished());
    strands.push_back((Eigen::MatrixXd(2, 2) << offset, 0, offset, 40).finished());
  }
  const weave::Weave sheet = weave::weave_of(strands);

  // The ends of the first strand are fixed: one where it is, the other one 1 mm further along x.
  const weave::SheetLoad load{
      .supports = {{.strand = 0, .coordinate = 0}, {.strand = 0, .coordinate = 40, .displacement = {1, 0, 0}}},
      .forces = {}};
  const weave::SheetState pulled = weave::simulate(sheet, load).states.back();
  std::cout << sheet.crossings.size() << " crossings; the force is " << pulled.reactions.back().x() << " N, "
            << to_string(pulled.stopped) << '\n';

  const weave::PrinterProfile printer;
  const weave::Toolpath toolpath = weave::toolpath(sheet, printer);
  const std::string gcode = weave::to_gcode(toolpath, printer);
  std::ofstream(path) << gcode;
  std::cout << "the print takes " << toolpath.statistics.minutes << " minutes and " << toolpath.statistics.filament
            << " mm of filament\n"
            << weave::check_gcode(gcode, weave::limits_of(printer, sheet)).violation_count << " faults\n";
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: print_weave FILE.gcode\n";
    return 2;
  }
  write_sheet(arguments[1]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
