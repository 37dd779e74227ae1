#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// The mean relative errors of a published network.
struct PublishedErrors {
  double gradient = 0;
  double energy = 0;
};
/// The errors that the thesis reports for its network of this family, on rows of designs that training has seen (Table
/// 4.1).
std::optional<PublishedErrors> published_errors(const std::string& family);

/// Writes a page about a model in Markdown: what it predicts, how large its errors are and where they occur, where not
/// to trust it, and where it comes from. `data` are the data of its training, whose held-out designs are judged anew.
/// `image` is the name of a plot beside the page. The plot of the model's calibration is ID-calibration.svg.
std::string model_card(const neural::Model& model, const ModelData& data, const std::string& image);

/// Writes a CSV file with one row for each sample of a held-out design: its load, strain, energy, branch, contacts and
/// relative errors. Throws "file.write_failed".
void write_row_errors(const std::filesystem::path& path, const neural::Model& model, const ModelData& data);

}  // namespace supple::training
