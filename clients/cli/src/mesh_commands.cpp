#include <fmt/format.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "failure.h"
#include "idle_options.h"
#include "numbers.h"
#include "style.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

std::string corner_text(const nlohmann::json& corner) {
  std::string text;
  for (const auto& coordinate : corner)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", precise(coordinate.get<double>()));
  return "(" + text + ")";
}

void print_mesh(const nlohmann::json& mesh) {
  const auto& box = mesh.at("bounding_box");
  const auto& edge = mesh.at("edge_length");
  fmt::print("mesh            {}\n", mesh.at("id").get<std::string>());
  fmt::print("vertices        {}\n", mesh.at("vertices").get<std::int64_t>());
  fmt::print("faces           {}\n", mesh.at("faces").get<std::int64_t>());
  fmt::print("components      {}\n", mesh.at("components").get<std::int64_t>());
  fmt::print("boundary loops  {}\n", mesh.at("boundary_loops").get<std::int64_t>());
  fmt::print("genus           {}\n", mesh.at("genus").get<std::int64_t>());
  fmt::print("saddle vertices {}\n", mesh.at("saddle_vertices").get<std::int64_t>());
  fmt::print("bounding box    {} to {}\n", corner_text(box.at("lower")), corner_text(box.at("upper")));
  fmt::print("area            {:.9g}\n", mesh.at("area").get<double>());
  fmt::print("edge length     {:.4g} to {:.4g}, mean {:.4g}\n", edge.at("min").get<double>(),
             edge.at("max").get<double>(), edge.at("mean").get<double>());
  for (const auto& warning : mesh.at("warnings"))
    fmt::print("{}         {}\n", styled("warning", Style::warning), warning.get<std::string>());
}

void print_repairs(const nlohmann::json& made) {
  std::string names;
  for (const auto& name : made) names += (names.empty() ? "" : ", ") + name.get<std::string>();
  fmt::print("repairs made    {}\n", names.empty() ? "none; nothing had to be repaired" : names);
}

struct RepairArguments {
  std::string repairs;         ///< names separated by commas; empty for no repairs
  std::string weld_tolerance;  ///< a number; empty for the server's default
};

/// The path of an upload, with the repairs in its query.
std::string upload_path(const RepairArguments& arguments) {
  constexpr const char* letters = "abcdefghijklmnopqrstuvwxyz_,";
  if (arguments.repairs.find_first_not_of(letters) != std::string::npos) {
    throw Failure(ExitCode::usage,
                  fmt::format("'{}' are no repairs: write for example weld,drop_degenerate", arguments.repairs));
  }
  std::string path = "/v1/meshes";
  if (!arguments.repairs.empty()) path += "?repair=" + arguments.repairs;
  if (arguments.weld_tolerance.empty()) return path;
  return path + fmt::format("&weld_tolerance={}", parse_number(arguments.weld_tolerance, "a weld tolerance"));
}

void add_meshes(Session& session, const std::vector<std::string>& files, const RepairArguments& repair) {
  const std::string path = upload_path(repair);
  for (const auto& file : files) {
    const nlohmann::json mesh = session.http().post(path, read_file(file), "application/octet-stream").json();
    session.json() ? print_json(mesh) : print_mesh(mesh);
    if (!session.json() && mesh.contains("repair")) print_repairs(mesh.at("repair").at("made"));
  }
}

void list_meshes(Session& session) {
  auto entries = nlohmann::json::array();
  session.for_each_entry("/v1/meshes", "meshes", [&](const nlohmann::json& mesh) {
    if (session.json()) return entries.push_back(mesh);
    fmt::print("{}  {:>9} faces  {}\n", mesh.at("id").get<std::string>(), mesh.at("faces").get<std::int64_t>(),
               mesh.at("created").get<std::string>());
  });
  if (session.json()) print_json(entries);
}

void show_mesh(Session& session, const std::string& mesh) {
  const nlohmann::json document = session.http().get("/v1/meshes/" + session.mesh_id(mesh)).json();
  session.json() ? print_json(document) : print_mesh(document);
}

void download_mesh(Session& session, const std::string& mesh, const std::string& file) {
  const char* format = file.ends_with(".obj") ? "model/obj" : "model/ply";
  write_file(file, session.http().get("/v1/meshes/" + session.mesh_id(mesh) + "/content", format).body);
}

}  // namespace

void add_mesh_commands(CLI::App& program, const GlobalOptions& options) {
  struct MeshArguments {
    std::vector<std::string> files;
    std::string mesh;
    std::string output;
    RepairArguments repair;
  };
  const auto arguments = std::make_shared<MeshArguments>();
  CLI::App* family = program.add_subcommand("mesh", "Upload, list, describe, download and delete meshes");
  family->require_subcommand(1);

  CLI::App* add = family->add_subcommand("add", "Upload mesh files (OBJ, OFF, PLY, STL) and describe them");
  add->add_option("file", arguments->files, "Mesh files")->required();
  add->add_option("--repair", arguments->repair.repairs,
                  "automatic for the repairs that are needed, or some of weld, drop_degenerate, drop_duplicates, "
                  "split_non_manifold, separated by commas; the warnings say what was done, --json where vertices and "
                  "faces have gone");
  add->add_option(
      "--weld-tolerance", arguments->repair.weld_tolerance,
      "Weld any vertices up to this distance over the bounding box's diagonal, at most 0.01; without it the "
      "corners of cracks alone");
  add->callback([&options, arguments, add] {
    const auto& repairs = arguments->repair.repairs;
    const bool welds = repairs.find("weld") != std::string::npos || repairs.find("automatic") != std::string::npos;
    refuse_idle_options(*add, {{"--weld-tolerance", welds, "without --repair weld or --repair automatic"}});
    Session session(options);
    add_meshes(session, arguments->files, arguments->repair);
  });

  CLI::App* list = family->add_subcommand("list", "List the server's meshes, the newest first");
  list->callback([&options] {
    Session session(options);
    list_meshes(session);
  });

  CLI::App* show = family->add_subcommand("show", "Describe a mesh");
  show->add_option("mesh", arguments->mesh, "Mesh")->required();
  show->callback([&options, arguments] {
    Session session(options);
    show_mesh(session, arguments->mesh);
  });

  CLI::App* get = family->add_subcommand("get", "Download a mesh as PLY or OBJ");
  get->add_option("mesh", arguments->mesh, "Mesh")->required();
  get->add_option("-o,--output", arguments->output,
                  "File; .obj for OBJ, anything else is binary PLY, - for the terminal")
      ->required();
  get->callback([&options, arguments] {
    Session session(options);
    download_mesh(session, arguments->mesh, arguments->output);
  });

  CLI::App* remove = family->add_subcommand("delete", "Delete a mesh");
  remove->add_option("mesh", arguments->mesh, "Mesh id, or the beginning of one")->required();
  remove->callback([&options, arguments] {
    Session session(options);
    session.http().erase("/v1/meshes/" + session.mesh_id(arguments->mesh));
  });
}

}  // namespace supple::cli
