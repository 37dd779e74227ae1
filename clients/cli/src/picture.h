#pragma once

#include <CLI/App.hpp>
#include <string>

namespace supple::cli {

/// Checks the name of a file that a plot is to be written to, before anything is computed: it ends with .svg or .png or
/// has no ending, which means SVG, and for .png this machine has what makes them.
CLI::Validator plot_file();

/// Writes a picture given as SVG to a file, or to standard output where the path is "-": as PNG where the name ends
/// with .png, two pixels for each of the picture's. Throws Failure(local_file).
void write_picture(const std::string& path, const std::string& svg);

}  // namespace supple::cli
