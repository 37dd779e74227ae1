#pragma once

#include <string>

#include "supple/dataset/dataset.h"

namespace supple::lab {

/// Describes a data set in several lines of text: its recipe, the designs that it holds and lacks, the engines that
/// computed it, and the command that makes it again.
std::string describe(const dataset::Dataset& data);

/// Reports the results of the simulations. These are the numbers of rows with contact, with patches of two by two
/// cells, after an unstable branch was left, and without stability; rejected designs and paths that stopped early, with
/// reasons; the rows per core-second, and the time of each stage. At most `max_failures` rejected designs, and as many
/// paths, are listed one by one, and all are counted.
std::string report(const dataset::Dataset& data, int max_failures = 50);

/// The complete command line that makes the data set's designs again, with every setting that is not the default.
std::string command_line(const dataset::Dataset& data);

}  // namespace supple::lab
