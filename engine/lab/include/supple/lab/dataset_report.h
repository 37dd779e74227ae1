#pragma once

#include <string>

#include "supple/dataset/dataset.h"

namespace supple::lab {

/// What the data set is: its recipe, which designs it holds and lacks, the engines that computed it, and the command
/// that makes it again. Text of several lines.
std::string describe(const dataset::Dataset& data);

/// What came of it: rows with contact, of two-cell patches, on left branches and unstable; every rejected design and
/// every path that stopped early, with reasons; rows per core-second and the shares of what they cost. At most
/// `most_failures` of either kind are listed one by one; all are counted.
std::string report(const dataset::Dataset& data, int most_failures = 50);

/// The command line that makes the data set's designs again, whole, with every setting that is not the default.
std::string command_line(const dataset::Dataset& data);

}  // namespace supple::lab
