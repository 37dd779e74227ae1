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
/// The errors of the published network of this family, on held-out rows of designs on which it was trained [Thesis,
/// table 4.1]. None if [Thesis] has no network of the family.
std::optional<PublishedErrors> published_errors(const std::string& family);

/// Returns a page about a model in Markdown: what it predicts, how large its errors are and where they occur, where not
/// to trust it, and how it was trained. `data` are the data of its training, on whose held-out designs the errors are
/// computed anew. `image` is the file name of a plot that the page shows; the page also refers to the plot of the
/// model's calibration, ID-calibration.svg.
std::string model_card(const neural::Model& model, const ModelData& data, const std::string& image);

/// Writes a CSV file with one row for each sample of a held-out design: its load, strain, energy, branch, contacts and
/// relative errors. Throws "file.write_failed".
void write_row_errors(const std::filesystem::path& path, const neural::Model& model, const ModelData& data);

}  // namespace supple::training
