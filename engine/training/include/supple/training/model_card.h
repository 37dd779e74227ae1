#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "supple/neural/model.h"
#include "supple/training/samples.h"

namespace supple::training {

/// Mean relative errors of a published network.
struct PublishedErrors {
  double gradient = 0;
  double energy = 0;
};
/// What the thesis reports of its network of this family, on rows of designs that training has seen (Table 4.1).
std::optional<PublishedErrors> published_errors(const std::string& family);

/// A page about a model in Markdown: what it predicts, its errors, where they are, where not to trust it, where it
/// comes from. `data` are those that it was trained on, whose held-out designs are judged anew; `image` is the
/// name of a plot that stands beside the page. That of the model's calibration is ID-calibration.svg.
std::string model_card(const neural::Model& model, const ModelData& data, const std::string& image);

/// One row for each sample of a held-out design: its load, strain, energy, branch, contacts and relative errors, as
/// CSV. Throws "file.write_failed".
void write_row_errors(const std::filesystem::path& path, const neural::Model& model, const ModelData& data);

}  // namespace supple::training
