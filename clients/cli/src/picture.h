#pragma once

#include <CLI/App.hpp>
#include <string>

namespace supple::cli {

/// Checks the name of a plot's file before anything is computed. It must end with .svg or .png, or have no ending,
/// which means SVG. For .png this machine must have librsvg.
CLI::Validator plot_file();

/// Writes an SVG picture to a file, or to standard output if the path is "-". If the name ends with .png, it is
/// converted to PNG at twice its size. Throws Failure(local_file).
void write_picture(const std::string& path, const std::string& svg);

}  // namespace supple::cli
