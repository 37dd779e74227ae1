#pragma once

#include <string>

#include "supple/dataset/dataset.h"

namespace supple::lab {

/// Describes a data set in several lines of text: its recipe, the designs that it holds and lacks, the engines that
/// computed it, and the command that makes it again.
std::string describe(const dataset::Dataset& data);

/// Reports what the simulations gave: the numbers of rows with contact, with patches of two cells, after a branch was
/// left and without stability; every rejected design and every path that stopped early, with reasons; the rows per
/// core-second, and the shares of their cost. At most `most_failures` of either kind are listed one by one, and all are
/// counted.
std::string report(const dataset::Dataset& data, int most_failures = 50);

/// The complete command line that makes the data set's designs again, with every setting that is not the default.
std::string command_line(const dataset::Dataset& data);

}  // namespace supple::lab
