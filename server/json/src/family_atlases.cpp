#include "supple/json/family_atlases.h"

#include <algorithm>
#include <utility>

#include "answer_parts.h"
#include "family_fields.h"
#include "request_parts.h"
#include "supple/json/family_checks.h"
#include "supple/json/family_definitions.h"

namespace supple::json {
namespace {

using design::AtlasPlace;
using design::Task;

// The ranges of api/openapi.yaml.
constexpr double min_atlas_mesh_size = 0.1;
constexpr double max_atlas_mesh_size = 2;
constexpr int max_error_samples = 64;
constexpr int max_type_number = 93;

constexpr auto stop_names = names_of<StopReason>(
    {{StopReason::none, "none"}, {StopReason::deadline, "deadline"}, {StopReason::memory, "memory"}});

void read_subject(Fields& fields, FamilyAtlasRequest& request) {
  const int given = fields.present("family") + fields.present("isohedral_type") + fields.present("definition");
  for (const auto* name : {"family", "isohedral_type", "definition"}) fields.optional(name);
  if (given != 1) return fields.faults().add("", "must have one of the fields family, isohedral_type and definition");
  if (fields.present("isohedral_type")) {
    fields.integer("isohedral_type", request.isohedral_type, 1, max_type_number);
    if (request.isohedral_type != 0 && !tiling::find_isohedral_type(request.isohedral_type))
      fields.faults().add(fields.at("isohedral_type"), "must be the number of one of the 81 types");
  } else if (fields.present("definition")) {
    nested(fields, "definition", [&](Fields& definition) { request.definition = read_family_definition(definition); });
  } else {
    read_family_id(fields, "family", request.family);
  }
}

void write_range(JsonWriter& out, std::string_view name, const design::AtlasSample& sample, Task task) {
  out.key(name);
  if (!sample.compliance) {
    out.null();
    return;
  }
  const auto range = design::range_over_directions(*sample.compliance, task);
  out.begin_array().number(range.lowest).number(range.highest).end_array();
}

void write_optional(JsonWriter& out, std::string_view name, const std::optional<double>& value) {
  out.key(name);
  if (value)
    out.number(*value);
  else
    out.null();
}

void write_samples(JsonWriter& out, const std::vector<design::AtlasSample>& samples) {
  out.key("samples").begin_array();
  for (const auto& sample : samples) {
    out.begin_object().key("parameters").numbers(sample.parameters);
    out.field("place", atlas_place_names.name_of(sample.place)).field("relative_density", sample.relative_density);
    out.key("compliance");
    if (sample.compliance) {
      write_rows(out, *sample.compliance);
    } else {
      out.null();
    }
    write_range(out, "stiffness", sample, Task::stiffness);
    write_range(out, "poisson_ratio", sample, Task::poisson);
    write_optional(out, "error", sample.error);
    out.end_object();
  }
  out.end_array();
}

/// How many samples are at which kind of place, and the error of the mesh at those that were solved twice.
void write_summary(JsonWriter& out, const design::FamilyAtlas& atlas) {
  out.key("places").begin_object();
  for (const auto& [place, name] : atlas_place_names) out.field(name, atlas.count(place));
  out.end_object().field(
      "good_fraction", static_cast<double>(atlas.count(AtlasPlace::good)) / static_cast<double>(atlas.samples.size()));
  std::vector<double> errors;
  for (const auto& sample : atlas.samples)
    if (sample.error) errors.push_back(*sample.error);
  std::sort(errors.begin(), errors.end());
  out.key("mesh_error");
  if (errors.empty()) {
    out.null();
  } else {
    out.begin_object()
        .field("samples", errors.size())
        .field("median", errors[errors.size() / 2])
        .field("largest", errors.back())
        .end_object();
  }
}

void write_profiles(JsonWriter& out, const design::FamilyAtlas& atlas, const ComparedAtlas* compared) {
  out.key("profiles").begin_array();
  for (std::size_t k = 0; k < atlas.profiles.size(); ++k) {
    const auto& profile = atlas.profiles[k];
    out.begin_object()
        .field("name", profile.name)
        .field("deviation", profile.distance.deviation)
        .field("met", profile.distance.is_met)
        .field("sample", profile.sample)
        .field("orientation", profile.distance.orientation)
        .key("others");
    if (compared && k < compared->comparison.profiles.size()) {
      const auto& other = compared->comparison.profiles[k];
      out.begin_object()
          .field("family", other.family)
          .field("deviation", other.distance.deviation)
          .field("met", other.distance.is_met)
          .end_object();
    } else {
      out.null();
    }
    out.end_object();
  }
  out.end_array();
}

void write_comparison(JsonWriter& out, const ComparedAtlas* compared) {
  out.key("comparison");
  if (!compared) {
    out.null();
    return;
  }
  const auto& comparison = compared->comparison;
  out.begin_object().key("families").begin_array();
  for (const auto& family : compared->families) out.string(family);
  out.end_array()
      .field("median_distance", comparison.median_distance)
      .field("largest_distance", comparison.largest_distance)
      .field("farthest_sample", comparison.farthest_sample)
      .field("new_fraction", comparison.new_fraction)
      .key("same_as");
  if (comparison.same_as)
    out.string(*comparison.same_as);
  else
    out.null();
  out.end_object();
}

template <class Value, std::size_t count>
Value value_of(const Document& name, const NameTable<Value, count>& names) {
  const auto found = names.find(name.get_ref<const std::string&>());
  if (!found) throw std::out_of_range("a name without a value");
  return *found;
}

design::AtlasSample sample_of(const Document& entry) {
  design::AtlasSample sample;
  sample.parameters = entry.at("parameters").get<std::vector<double>>();
  sample.place = value_of(entry.at("place"), atlas_place_names);
  sample.relative_density = entry.at("relative_density").get<double>();
  if (const auto& rows = entry.at("compliance"); !rows.is_null()) {
    auto& compliance = sample.compliance.emplace();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        compliance(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
  }
  if (const auto& error = entry.at("error"); !error.is_null()) sample.error = error.get<double>();
  return sample;
}

tiling::DefinitionFinding finding_of(const Document& entry) {
  constexpr std::string_view prefix = "/definition/";
  tiling::DefinitionFinding finding;
  finding.flaw = value_of(entry.at("flaw"), flaw_names);
  finding.where = entry.at("pointer").get<std::string>().substr(prefix.size());
  finding.message = entry.at("message").get<std::string>();
  finding.parameters = entry.at("parameters").get<std::vector<double>>();
  if (const auto& point = entry.at("point"); !point.is_null())
    finding.point.emplace(point.at(0).get<double>(), point.at(1).get<double>());
  return finding;
}

design::FamilyAtlas atlas_of(const Document& document) {
  design::FamilyAtlas atlas;
  atlas.family = document.at("family").get<std::string>();
  const auto& bounds = document.at("parameters");
  for (std::size_t k = 0; k < bounds.at("lower").size(); ++k)
    atlas.bounds.push_back({bounds.at("lower").at(k).get<double>(), bounds.at("upper").at(k).get<double>(),
                            bounds.at("default").at(k).get<double>()});
  atlas.mesh_size = document.at("mesh_size").get<double>();
  atlas.crossings = document.at("crossings").get<bool>();
  for (const auto& entry : document.at("samples")) atlas.samples.push_back(sample_of(entry));
  for (const auto& entry : document.at("profiles")) {
    atlas.profiles.push_back(
        {entry.at("name").get<std::string>(),
         entry.at("sample").get<std::size_t>(),
         {entry.at("deviation").get<double>(), entry.at("orientation").get<double>(), entry.at("met").get<bool>()}});
    static_cast<void>(atlas.samples.at(atlas.profiles.back().sample));  // which throws where there is none
  }
  for (const auto& entry : document.at("warnings")) atlas.warnings.push_back(finding_of(entry));
  atlas.stopped = value_of(document.at("stopped"), stop_names);
  return atlas;
}

}  // namespace

FamilyAtlasRequest parse_family_atlas_request(std::string_view body, const Limits& limits,
                                              const CancellationToken& cancellation) {
  return read_request<FamilyAtlasRequest>(body, limits, cancellation, [&](Fields& fields, FamilyAtlasRequest& request) {
    read_subject(fields, request);
    auto& options = request.options;
    options.max_nodes = limits.max_mesh_nodes;
    fields.integer("samples", options.samples, 1, design::max_atlas_samples);
    fields.number("mesh_size", options.mesh_size, min_atlas_mesh_size, max_atlas_mesh_size);
    options.error_samples = std::min(options.error_samples, options.samples);
    fields.integer("error_samples", options.error_samples, 0, std::min(max_error_samples, options.samples));
    if (fields.present("crossings")) {
      fields.boolean("crossings", request.crossings.emplace(false));
    } else {
      fields.optional("crossings");
    }
    fields.boolean("recompute", request.recompute);
  });
}

AtlasRecord make_atlas_record(design::FamilyAtlas atlas, std::shared_ptr<const tiling::FamilyDefinition> definition,
                              const Bill& bill) {
  JsonWriter out;
  out.begin_object();
  write_bill(out, bill);
  out.end_object();
  const auto document = Document::parse(out.take());
  return {std::move(atlas), std::move(definition), document.at("effects").dump(), document.at("cost").dump()};
}

std::string write_family_atlas(const AtlasRecord& record, const ComparedAtlas* compared, bool is_kept) {
  const design::FamilyAtlas& atlas = record.atlas;
  JsonWriter out;
  out.begin_object().field("family", atlas.family).key("parameters").begin_object();
  const auto bound = [&](std::string_view name, double tiling::Parameter::*value) {
    out.key(name).begin_array();
    for (const auto& parameter : atlas.bounds) out.number(parameter.*value);
    out.end_array();
  };
  bound("lower", &tiling::Parameter::lower);
  bound("upper", &tiling::Parameter::upper);
  bound("default", &tiling::Parameter::preset);
  out.end_object().key("definition");
  if (record.definition)
    write_family_definition(out, *record.definition);
  else
    out.null();
  out.field("mesh_size", atlas.mesh_size).field("crossings", atlas.crossings).field("kept", is_kept);
  write_summary(out, atlas);
  write_profiles(out, atlas, compared);
  write_comparison(out, compared);
  write_findings(out, "warnings", atlas.warnings);
  write_samples(out, atlas.samples);
  out.field("stopped", stop_names.name_of(atlas.stopped));
  out.key("effects").raw(record.effects).key("cost").raw(record.cost).end_object();
  return out.take();
}

std::optional<AtlasRecord> read_family_atlas(std::string_view text,
                                             std::shared_ptr<const tiling::FamilyDefinition> definition) {
  try {
    const auto document = Document::parse(text);
    const auto now = definition ? Document::parse(write_family_definition(*definition)) : Document();
    if (document.at("definition") != now) return std::nullopt;
    return AtlasRecord{atlas_of(document), std::move(definition), document.at("effects").dump(),
                       document.at("cost").dump()};
  } catch (const Document::exception&) {
    return std::nullopt;
  } catch (const std::out_of_range&) {
    return std::nullopt;
  }
}

}  // namespace supple::json
