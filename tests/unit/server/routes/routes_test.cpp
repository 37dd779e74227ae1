#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "handlers.h"
#include "supple/access/gate.h"
#include "unit/server/routes/router_fixture.h"

namespace supple::routes {
namespace {

using Document = nlohmann::json;
class Routes : public RouterTest {
 protected:
  /// Lets the server have connections, as its part http would tell.
  static void services_load() {
    parts().services.load = [] {
      http::Load load;
      load.connections = 3;
      load.reader_silence_seconds = 0.125;
      load.accept_silence_seconds = 0.25;
      return load;
    };
  }
};

/// A request whose single quotes stand for double ones, with the square's id in place of SQUARE, and what it is
/// answered with: a status, a code, and all pointers.
struct Refused {
  const char* path;
  const char* body;
  int status;
  const char* code;
  const char* pointers;
};

void PrintTo(const Refused& refused, std::ostream* out) { *out << refused.path; }

/// The letters of the path, and the number of the case.
std::string name_of(const ::testing::TestParamInfo<Refused>& info) {
  std::string name;
  for (const char* c = info.param.path; *c != 0; ++c)
    if (std::isalnum(static_cast<unsigned char>(*c)) != 0) name += *c;
  return name + std::to_string(info.index);
}

std::string with_quotes(std::string text) {
  std::replace(text.begin(), text.end(), '\'', '"');
  return text;
}

class Refusals : public RouterTest, public ::testing::WithParamInterface<Refused> {};

TEST_P(Refusals, NameTheFieldOfTheRequest) {
  const auto& [path, body, status, code, pointers] = GetParam();
  auto text = with_quotes(body);
  if (const auto at = text.find("SQUARE"); at != std::string::npos) text.replace(at, 6, square());
  const auto answer = ask("POST", std::string("/v1/") + path, text);
  EXPECT_EQ(answer.status, status) << answer.body;
  EXPECT_EQ(answer.code(), code);
  EXPECT_EQ(answer.pointers(), pointers) << answer.body;
}

constexpr const char* no_mesh =
    "{'mesh':'0000000000000000000000000000000000000000000000000000000000000000',"
    "'sources':[{'vertex':0}]}";

INSTANTIATE_TEST_SUITE_P(
    OfRoutes, Refusals,
    ::testing::Values(
        Refused{"geodesic-fields", no_mesh, 404, "mesh.not_found", " /mesh"},
        Refused{"geodesic-fields", "{'mesh':'SQUARE','sources':[{'vertex':0},{'vertex':4}]}", 422,
                "point.vertex_out_of_range", " /sources/1"},
        Refused{"karcher-means",
                "{'mesh':'SQUARE','points':[{'face':0,'barycentric':[1,0,0]},{'face':0,'barycentric':[2,-1,0]}]}", 422,
                "point.outside_face", " /points/1"},
        Refused{"exponential-maps", "{'mesh':'SQUARE','start':{'face':2,'barycentric':[1,0,0]},'tangent':[1,0]}", 422,
                "point.face_out_of_range", " /start"},
        Refused{"geodesics",
                "{'mesh':'SQUARE','pairs':[{'from':{'vertex':0},'to':{'vertex':1},"
                "'known_path':[{'vertex':3},{'vertex':1}]}]}",
                422, "geodesic.known_path", " /pairs/0/known_path/0"},
        Refused{"geodesics",
                "{'mesh':'SQUARE','pairs':[{'from':{'vertex':0},'to':{'vertex':1},"
                "'known_path':[{'vertex':0},{'vertex':3}]}]}",
                422, "geodesic.known_path", " /pairs/0/known_path/1"},
        Refused{"geodesics",
                "{'mesh':'SQUARE','pairs':[{'from':{'vertex':1},'to':{'vertex':1},"
                "'known_path':[{'vertex':1},{'vertex':3},{'vertex':1}]}]}",
                422, "geodesic.known_path", " /pairs/0/known_path/1"},
        Refused{"embedded-systems", "{'mesh':'SQUARE','points':[{'vertex':0},{'vertex':9}],'springs':[]}", 422,
                "point.vertex_out_of_range", " /points/1"},
        Refused{"embedded-systems",
                "{'mesh':'SQUARE','points':{'kind':'poisson_disk','radius':1e-4},'springs':{'kind':'voronoi_dual'}}",
                422, "network.radius", " /points/radius"},
        Refused{"voronoi-diagrams", "{'mesh':'SQUARE','sites':[{'vertex':0},{'face':7,'barycentric':[1,0,0]}]}", 422,
                "point.face_out_of_range", " /sites/1"},
        Refused{"structures", "{'family':'IH99'}", 404, "tiling.family_not_found", " /family"},
        Refused{"structures", "{'family':'IH01','parameters':[0.1,0.5]}", 422, "tiling.parameter_count",
                " /parameters"},
        Refused{"structures", "{'family':'IH21','parameters':[0.12,0.95]}", 422, "tiling.parameter_out_of_bounds",
                " /parameters/1"},
        Refused{"structures", "{'family':'IH50','mesh':{'mesh_size':0.01}}", 422, "tiling.mesh_too_large",
                " /mesh/mesh_size"},
        Refused{"family-checks",
                "{'definition':{'id':'w','description':'','parameters':[{'description':'','lower':0.1,'upper':0.2,"
                "'default':0.1}],'beam_width':[0,1],'isohedral_type':20},'parameters':[0.3]}",
                422, "tiling.parameter_out_of_bounds", " /parameters/0"},
        Refused{"simulations", "{'family':'IH21','load':{'green_strain':[[0,0,0],[-0.6,0,0]]}}", 422,
                "simulation.invalid_load", " /load/green_strain/1"},
        Refused{"simulations", "{'family':'IH50','load':{'green_strain':[[0,0,0]]},'accuracy':{'mesh_size':0.01}}", 422,
                "tiling.mesh_too_large", " /accuracy/mesh_size"},
        Refused{"parts", "{'outline':{'polygons':[[[0,0],[10,10],[10,0],[0,10]]]},'structure':{'family':'IH21'}}", 422,
                "tiling.part", " /outline/polygons/0"},
        Refused{"parts", "{'outline':{'rectangle':[1900,1900]},'structure':{'family':'IH21'}}", 422, "tiling.part",
                " /beam_width"},
        Refused{"parts", "{'outline':{'rectangle':[20,20]},'structure':{'family':'IH21','parameters':[9,0.7]}}", 422,
                "tiling.parameter_out_of_bounds", " /structure/parameters/0"},
        Refused{"parts",
                "{'outline':{'rectangle':[20,20]},'structure':{'family':'IH21'},"
                "'regions':[{'outline':[[0,0],[5,0],[5,5]],'structure':{'family':'IH99'}}]}",
                404, "tiling.family_not_found", " /regions/0/structure/family"},
        Refused{"part-simulations",
                "{'part':{'outline':{'polygons':[[[0,0],[10,10],[10,0],[0,10]]]},'structure':{'family':'IH21'}},"
                "'supports':[{'kind':'plate','side':'top'}]}",
                422, "tiling.part", " /part/outline/polygons/0"},
        Refused{"part-simulations",
                "{'part':{'outline':{'block':{'width':20,'height':20}},'structure':{'family':'IH21'},"
                "'regions':[{'outline':[[0,0],[5,0],[5,5]],'structure':{'family':'IH99'}}]}}",
                404, "tiling.family_not_found", " /part/regions/0/structure/family"},
        Refused{"part-simulations",
                "{'part':{'outline':{'rectangle':[3,3]},'structure':{'family':'IH21'},'frame':3},"
                "'supports':[{'kind':'clamp','box':[[0,0],[3,0]]},{'kind':'clamp','box':[[5,0],[6,1]]}],"
                "'accuracy':{'mesh_size':2}}",
                422, "simulation.invalid_load", " /supports/1/box"},
        Refused{"part-simulations",
                "{'part':{'outline':{'rectangle':[3,3]},'structure':{'family':'IH21'},'frame':3},"
                "'supports':[{'kind':'plate','side':'left'},{'kind':'plate','side':'top','gap':1}],"
                "'accuracy':{'mesh_size':2}}",
                422, "simulation.invalid_load", " /supports"},
        Refused{"part-simulations",
                "{'part':{'outline':{'rectangle':[100,100]},'structure':{'family':'IH21'},'frame':50},"
                "'supports':[{'kind':'clamp','box':[[0,0],[3,0]]}],'accuracy':{'mesh_size':0.01}}",
                400, "request.limit_exceeded", " /accuracy/mesh_size"},
        Refused{"measured-curves", "{'text':'nothing'}", 422, "design.unreadable_table", " /text"},
        Refused{"measured-curves", "{'content':'bm90aGluZw=='}", 422, "design.unreadable_table", " /content"},
        Refused{"profiles", "{'task':'poisson','model':'ih99','parameters':[0.1]}", 404, "model.not_found", " /model"},
        Refused{"profiles", "{'task':'poisson','family':'IH99','parameters':[0.1]}", 422, "design.no_model",
                " /family"},
        Refused{"profiles", "{'task':'poisson','family':'IH21','parameters':[0.1]}", 422, "design.parameter_count",
                " /parameters"},
        Refused{"profiles", "{'task':'stress_strain','family':'IH21','parameters':[0.12,0.7],'x':[0.1,-0.5]}", 422,
                "model.invalid_load", " /x/1"},
        Refused{"profiles",
                "{'task':'poisson','family':'IH21','parameters':[0.12,0.7],"
                "'material':{'law':'incompressible_plane_stress'}}",
                422, "design.other_material", " /material/law"},
        Refused{"profiles",
                "{'task':'poisson','family':'IH21','parameters':[0.12,0.7],'material':{'poisson_ratio':0.1}}", 422,
                "design.other_material", " /material/poisson_ratio"},
        Refused{"designs",
                "{'regions':[{'task':'stress_strain','family':'IH21','target':{'control_points':[[0,0],[0.1,1]]}},"
                "{'task':'stress_strain','family':'IH21','target':{'control_points':[[1,0],[0,1]]}}]}",
                422, "design.invalid_target", " /regions/1/target/control_points/1/0"},
        Refused{"designs",
                "{'task':'stress_strain','family':'IH21','target':{'control_points':[[0,0],[0.1,1]]},"
                "'also':[{'task':'stress_strain','target':{'control_points':[[1,0],[0,1]]}}]}",
                422, "design.invalid_target", " /also/0/target/control_points/1/0"},
        Refused{"designs", "{'task':'stress_strain','target':{'control_points':[[0,0],[0.1,1]]},'initial':[0.2,0.9]}",
                422, "design.needs_family", " /initial"},
        Refused{"designs", "{'task':'stress_strain','target':{'control_points':[[0,0],[0.1,1]]},'fixed':[0.2,null]}",
                422, "design.needs_family", " /fixed"},
        Refused{"designs",
                "{'task':'stress_strain','family':'IH21','target':{'control_points':[[0,0],[0.1,1]]},"
                "'initial':[0.2],'accuracy':{'candidates':2,'starts':1}}",
                422, "design.parameter_count", " /initial"},
        Refused{"models/ih21/evaluations", "{'parameters':[[0.1]],'green_strain':[[0,0,0]]}", 422,
                "model.parameter_count", " /parameters/0"},
        Refused{"models/ih99/uniaxial", "{'parameters':[0.1],'direction':0,'stretches':[1]}", 404, "model.not_found",
                ""}),
    name_of);

INSTANTIATE_TEST_SUITE_P(
    OfWeaves, Refusals,
    ::testing::Values(
        Refused{"weave-layouts", "{'weave':{'pattern':'interlacing_squares','type':3,'overlap':6}}", 422,
                "weave.invalid_pattern", " /weave/overlap"},
        Refused{"weave-layouts", "{'weave':{'pattern':'regular','sheet':{'columns':20000,'rows':2}}}", 422,
                "weave.invalid_pattern", " /weave/sheet/columns"},
        Refused{"weave-layouts", "{'weave':{'strands':[{'points':[[0,0],[1,0]]},{'points':[[0,0],[0,0]]}]}}", 422,
                "weave.invalid_strand", " /weave/strands/1/points/1"},
        Refused{"weave-layouts", "{'weave':{'strands':[{'points':[[0,0],[1,0]]}],'lattice':[[0,1],[1,0]]}}", 422,
                "weave.invalid_layout", " /weave/lattice"},
        Refused{"weave-layouts",
                "{'weave':{'strands':[{'points':[[0,0],[1,0]]},{'points':[[0,-1],[0,1]]}],"
                "'crossings':[{'members':[{'strand':0,'coordinate':0.5},{'strand':1,'coordinate':1}]}]}}",
                422, "weave.invalid_layout", " /weave/crossings/0/members/1"},
        Refused{"weave-layouts", "{'weave':{'pattern':'regular','overrides':[{'crossing':4,'slides':[]}]}}", 422,
                "weave.invalid_layout", " /weave/overrides/0/crossing"},
        Refused{"weave-layouts", "{'weave':{'pattern':'regular','overrides':[{'crossing':3,'slides':[0,2]}]}}", 422,
                "weave.invalid_layout", " /weave/overrides/0/slides/1"},
        Refused{"weave-homogenizations", "{'weave':{'pattern':'regular','sheet':{'columns':2,'rows':2}}}", 422,
                "weave.not_periodic", " /weave"},
        Refused{"weave-simulations", "{'weave':{'pattern':'regular'},'supports':[{'at':{'crossing':0}}]}", 422,
                "weave.invalid_load", " /weave"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'supports':[{'at':{'crossing':9}}]}",
                422, "weave.invalid_load", " /supports/0/at/crossing"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'supports':[{'at':{'strand':6,"
                "'share':0}}]}",
                422, "weave.invalid_load", " /supports/0/at/strand"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'supports':[{'at':{'crossing':1}}],"
                "'forces':[{'at':{'box':[[100,100],[200,200]]},'force':[1,0,0]}]}",
                422, "weave.invalid_load", " /forces/0/at/box"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},"
                "'supports':[{'at':{'box':[[-1,-1],[20,20]]}},{'at':{'strand':0,'coordinate':99}}]}",
                422, "weave.invalid_load", " /supports/1/coordinate"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},"
                "'supports':[{'at':{'crossing':0}},{'at':{'crossing':0}}]}",
                422, "weave.invalid_load", " /supports/1 /supports/1 /supports/1"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'supports':[{'at':{'crossing':0}}],"
                "'forces':[{'at':{'box':[[-1,-1],[20,20]]},'force':[1,0,0]},{'at':{'strand':0,'coordinate':99},"
                "'force':[1,0,0]}]}",
                422, "weave.invalid_load", " /forces/1/coordinate"},
        Refused{"weave-simulations",
                "{'weave':{'pattern':'regular','sheet':{'columns':50,'rows':50}},'supports':[{'at':{'crossing':0}}],"
                "'states':1000}",
                400, "request.limit_exceeded", " /deformed"},
        Refused{"weave-toolpaths", "{'weave':{'pattern':'regular'}}", 422, "weave.not_printable",
                " /weave /weave /weave /weave /weave"},
        Refused{"weave-toolpaths",
                "{'weave':{'strands':[{'points':[[0,20],[40,20]]},{'points':[[20,0],[20,40]]}],'crossings':[{'members':"
                "[{'strand':0,'coordinate':20,'slides':true},{'strand':1,'coordinate':20,'slides':true}]}]}}",
                422, "weave.not_printable", " /weave/crossings/0"},
        Refused{"weave-toolpaths",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'overruns':[{'strand':1},{'strand':9,"
                "'end':1}]}",
                422, "weave.invalid_option", " /overruns/1/strand"},
        Refused{"weave-toolpaths",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'printer':{'lift':{'top':3}}}", 422,
                "weave.invalid_option", " /printer/lift/run"},
        Refused{"weave-toolpaths",
                "{'weave':{'pattern':'regular','sheet':{'columns':3,'rows':3}},'printer':{'bed':[5,210,210]}}", 422,
                "weave.not_printable", " /printer/bed"}),
    name_of);

TEST_F(Routes, LinksNameEachParameterAtFault) {
  const auto fault_of = [](const std::string& query) {
    const auto answer = get("/v1/families/IH21/structure?" + query);
    return std::to_string(answer.status) + " " + answer.code() + answer.pointers();
  };
  for (const char* parameters : {"", "0.1,", "0.1,nan", "a", "0.1 0.5"})
    EXPECT_EQ(fault_of(std::string("parameters=") + parameters), "400 request.invalid_parameter query parameters");
  for (const char* cells : {"2", "2,", "0,1", "2,101", "101,2", "2,2,2", "1.5,2"})
    EXPECT_EQ(fault_of(std::string("cells=") + cells), "400 request.invalid_parameter query cells");
  for (const char* height : {"0", "1001", "0.0009", "tall"})
    EXPECT_EQ(fault_of(std::string("height=") + height), "400 request.invalid_parameter query height");
  for (const char* width : {"0", "101", "wide"})
    EXPECT_EQ(fault_of(std::string("beam_width=") + width), "400 request.invalid_parameter query beam_width");
  EXPECT_EQ(fault_of("parameters=" + std::string(1001, '0')), "400 request.invalid_parameter query parameters");
  std::string many = "parameters=0";
  for (int i = 0; i < 32; ++i) many += ",0";
  EXPECT_EQ(fault_of(many), "400 request.invalid_parameter query parameters");
  EXPECT_EQ(fault_of("cells=0,0&format=png&hieght=2"),
            "400 request.invalid_parameter query cells query format query hieght");
  EXPECT_EQ(fault_of("parameters=0.12,0.95"), "422 tiling.parameter_out_of_bounds query parameters/1");
  EXPECT_EQ(fault_of("parameters=0.12"), "422 tiling.parameter_count query parameters");
  EXPECT_EQ(get("/v1/families/IH99/structure?cells=0,0").code(), "tiling.family_not_found");
}

TEST_F(Routes, ALinkGivesTheFileThatARequestGives) {
  const Document request = {
      {"family", "IH21"}, {"parameters", {0.12, 0.7}}, {"cells", {3, 1}}, {"height", 2.5}, {"beam_width", 0.4}};
  const std::string query = "/v1/families/IH21/structure?parameters=0.12,0.7&cells=3,1&height=2.5&beam_width=0.4";
  for (const auto& [ending, type] :
       {std::pair("svg", "image/svg+xml"), std::pair("dxf", "image/vnd.dxf"), std::pair("stl", "model/stl")}) {
    const auto linked = get(query + "&format=" + ending);
    EXPECT_EQ(linked.status, 200) << linked.body;
    EXPECT_EQ(linked.header("Content-Type"), type);
    EXPECT_EQ(linked.header("Cache-Control"), "public, max-age=3600");
    EXPECT_FALSE(linked.header("Supple-Seconds").empty());
    EXPECT_EQ(linked.body, post("/v1/structures", request, {{"Accept", type}}).body);
  }
  EXPECT_EQ(get(query).header("Content-Type"), "image/svg+xml");
  EXPECT_EQ(post("/v1/structures", request, {{"Accept", "application/dxf"}}).header("Content-Type"), "application/dxf");
}

TEST_F(Routes, FormatsThatThereAreNotAreRefusedWithThoseThatThereAre) {
  const Headers png{{"Accept", "image/png"}};
  const auto detail = [&](const char* path) { return post(path, Document::object(), png).json()["detail"]; };
  EXPECT_EQ(detail("/v1/geodesic-fields"), "A field is sent as application/json or application/octet-stream.");
  EXPECT_EQ(detail("/v1/embedded-systems"),
            "A network is sent as application/json, model/obj, application/x-vtu+xml or image/svg+xml.");
  EXPECT_EQ(detail("/v1/voronoi-diagrams"),
            "A Voronoi diagram is sent as application/json, model/obj, application/x-vtu+xml, image/svg+xml or "
            "text/csv.");
  EXPECT_EQ(detail("/v1/structures"),
            "A structure is sent as application/json, image/svg+xml, image/vnd.dxf, application/dxf or model/stl.");
  EXPECT_EQ(detail("/v1/parts"),
            "A part is sent as application/json, image/svg+xml, image/vnd.dxf, application/dxf, model/step, model/stl "
            "or model/3mf.");
  EXPECT_EQ(detail("/v1/part-simulations"),
            "The simulation of a part is sent as application/json, text/csv, image/svg+xml, model/obj or "
            "application/x-vtu+xml.");
  EXPECT_EQ(detail("/v1/weave-layouts"), "A layout is sent as application/json or image/svg+xml.");
  EXPECT_EQ(detail("/v1/weave-toolpaths"), "A toolpath is sent as application/json, text/x-gcode or image/svg+xml.");
  EXPECT_EQ(get("/v1/meshes/" + square() + "/content", png).code(), "http.not_acceptable");
}

TEST_F(Routes, FilesOfNetworksAndDiagramsAreOfTheTypeThatIsAskedFor) {
  const Document network = {{"mesh", square()},
                            {"points", {{{"position", {0.1, 0.1, 0.5}}}, {{"vertex", 1}}, {{"vertex", 2}}}},
                            {"springs", {{{"between", {0, 1}}}, {{"between", {1, 2}}}}},
                            {"fixed_points", {0, 2}}};
  const Document diagram = {{"mesh", square()}, {"sites", {{{"position", {0.1, 0.1, 0.5}}}, {{"vertex", 2}}}}};
  const auto begin = [](const Answer& answer) { return answer.body.substr(0, 40); };
  for (const auto& [type, text] : {std::pair("model/obj", "v "), std::pair("application/x-vtu+xml", "<?xml"),
                                   std::pair("image/svg+xml", "<svg")}) {
    const auto answer = post("/v1/embedded-systems", network, {{"Accept", type}});
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.header("Content-Type"), type);
    EXPECT_NE(answer.body.substr(0, 200).find(text), std::string::npos) << begin(answer);
    EXPECT_EQ(answer.header("Supple-Stopped"), "converged");
    EXPECT_EQ(answer.header("Supple-Largest-Distance"), "0.5");
  }
  for (const auto& [type, text] : {std::pair("model/obj", "o borders"), std::pair("application/x-vtu+xml", "<?xml"),
                                   std::pair("image/svg+xml", "<svg"), std::pair("text/csv", ",")}) {
    const auto answer = post("/v1/voronoi-diagrams", diagram, {{"Accept", type}});
    ASSERT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(answer.header("Content-Type"), type);
    EXPECT_NE(answer.body.substr(0, 200).find(text), std::string::npos) << begin(answer);
    EXPECT_EQ(answer.header("Supple-Largest-Distance"), "0.5");
  }
}

TEST_F(Routes, ABinaryFieldIsTheDistancesAlone) {
  const auto mesh =
      post("/v1/meshes", Document::parse(with_quotes("{'vertices':[[0,0,0],[1,0,0],[0,1,0],[5,0,0],[6,0,0],[5,1,0]],"
                                                     "'faces':[[0,1,2],[3,4,5]]}")))
          .json()["id"];
  const Document request = {{"mesh", mesh}, {"sources", {{{"position", {0, 0, 2}}}}}};
  const auto answer = post("/v1/geodesic-fields", request, {{"Accept", "application/octet-stream"}});
  std::vector<double> distances(6);
  ASSERT_EQ(answer.body.size(), distances.size() * sizeof(double)) << answer.body;
  std::memcpy(distances.data(), answer.body.data(), answer.body.size());
  EXPECT_EQ(distances, (std::vector<double>{0, 1, 1, -1, -1, -1}));
  EXPECT_EQ(answer.header("Supple-Vertices"), "6");
  EXPECT_EQ(answer.header("Supple-Unreached"), "3");
  EXPECT_EQ(answer.header("Supple-Method"), "windows");
  EXPECT_EQ(answer.header("Supple-Relative-Error-Bound"), "0");
  EXPECT_EQ(answer.header("Supple-Largest-Distance"), "2");
  EXPECT_EQ(ask("DELETE", "/v1/meshes/" + mesh.get<std::string>()).status, 204);
}

TEST_F(Routes, AKnownPathIsSearchedFromAndBilled) {
  Document request = {{"mesh", square()}, {"pairs", {{{"from", {{"vertex", 1}}}, {"to", {{"vertex", 3}}}}}}};
  request["pairs"][0]["known_path"] = {{{"vertex", 1}}, {{"face", 0}, {"barycentric", {0.5, 0, 0.5}}}, {{"vertex", 3}}};
  const auto effect_of = [](const Document& answer, const std::string& name) {
    for (const auto& effect : answer["effects"])
      if (effect["name"] == name) return effect;
    return Document();
  };
  const auto answer = post("/v1/geodesics", request).json();
  EXPECT_NEAR(answer["results"][0]["distance"].get<double>(), std::sqrt(2.0), 1e-12);
  EXPECT_EQ(effect_of(answer, "known_path")["ran"], true);
  EXPECT_EQ(effect_of(answer, "known_path")["count"], 1);
  request["pairs"][0].erase("known_path");
  request["effects"] = {{"mollifier", "on"}};
  request["derivatives"] = 1;
  const auto plain = post("/v1/geodesics", request).json();
  EXPECT_EQ(effect_of(plain, "known_path")["ran"], false);
  EXPECT_EQ(effect_of(plain, "mollifier")["why"], "the request turns it on");
}

TEST_F(Routes, ListsAreReadPageByPage) {
  square();
  post("/v1/meshes", Document::parse(with_quotes("{'vertices':[[0,0,0],[2,0,0],[0,2,0]],'faces':[[0,1,2]]}")));
  const auto first = get("/v1/meshes?limit=1").json();
  ASSERT_EQ(first["meshes"].size(), 1U);
  EXPECT_EQ(first["next"], first["meshes"][0]["id"]);
  const auto second = get("/v1/meshes?limit=1000&after=" + first["next"].get<std::string>()).json();
  EXPECT_GE(second["meshes"].size(), 1U);
  EXPECT_FALSE(second.contains("next"));
  EXPECT_NE(second["meshes"][0]["id"], first["next"]);
  for (const char* query : {"limit=0", "limit=1001", "limit=a", "limit=1a", "more=1", "state=running"})
    EXPECT_EQ(get(std::string("/v1/meshes?") + query).code(), "request.invalid_parameter") << query;
  EXPECT_EQ(get("/v1/jobs?state=asleep").code(), "request.invalid_parameter");
  EXPECT_EQ(get("/v1/jobs?state=dismissed").status, 200);
}

TEST_F(Routes, RepairsAreAskedForInTheQueryOrInTheBody) {
  const std::string mesh =
      with_quotes("{'vertices':[[0,0,0],[1,0,0],[0,1,0],[0,0,0],[-1,0,0]],'faces':[[0,1,2],[3,2,4],[0,1,1]]}");
  const auto code = [&](const std::string& query, const std::string& body) {
    return ask("POST", "/v1/meshes?" + query, body).code();
  };
  EXPECT_EQ(ask("POST", "/v1/meshes?repair=weld,drop_degenerate", mesh).json()["repair"]["made"],
            Document({"weld", "drop_degenerate"}));
  EXPECT_EQ(ask("POST", "/v1/meshes?repair=automatic", mesh).status / 100, 2);
  EXPECT_EQ(code("repair=wield", mesh), "request.invalid_parameter");
  EXPECT_EQ(code("repair=weld,automatic", mesh), "request.invalid_parameter");
  EXPECT_EQ(code("repair=weld&weld_tolerance=0.02", mesh), "request.invalid_parameter");
  EXPECT_EQ(code("repair=weld&weld_tolerance=x", mesh), "request.invalid_parameter");
  EXPECT_EQ(code("repair=drop_degenerate&weld_tolerance=0.01", mesh), "request.invalid_parameter");
  EXPECT_EQ(code("mend=weld", mesh), "request.invalid_parameter");
  auto both = Document::parse(mesh);
  both["repair"] = {"weld"};
  EXPECT_EQ(code("repair=weld", both.dump()), "request.invalid_parameter");
  EXPECT_EQ(ask("POST", "/v1/meshes", mesh, {{"Content-Type", ";"}}).code(), "http.unsupported_media_type");
  EXPECT_EQ(
      ask("POST", "/v1/meshes", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 3 0\n3 0 1 2\n", {{"Content-Type", "model/off"}}).status,
      201);
}

TEST_F(Routes, EachRepresentationOfAMeshHasATagOfItsOwn) {
  const auto content = "/v1/meshes/" + square() + "/content";
  const auto ply = get(content);
  const auto obj = get(content, {{"Accept", "model/obj"}});
  EXPECT_TRUE(ply.body.starts_with("ply\n"));
  EXPECT_EQ(store::sha256(ply.body), square());
  EXPECT_NE(ply.header("ETag"), obj.header("ETag"));
  EXPECT_EQ(ply.header("Vary"), "Accept");
  EXPECT_EQ(get(content, {{"If-None-Match", ply.header("ETag")}}).status, 304);
  EXPECT_EQ(get(content, {{"If-None-Match", obj.header("ETag")}}).status, 200);
  EXPECT_EQ(get(content, {{"If-None-Match", "*"}}).status, 304);
  EXPECT_EQ(get("/v1/meshes/" + std::string(64, '0') + "/content").code(), "mesh.not_found");
  EXPECT_EQ(ask("DELETE", "/v1/meshes/" + std::string(64, '0')).code(), "mesh.not_found");
}

TEST_F(Routes, TheFilesOfTheEditorAreSentWithTheirTypesAndTags) {
  const auto index = get("/");
  EXPECT_EQ(index.body, "<html>");
  EXPECT_EQ(index.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(index.header("Cache-Control"), "no-cache");
  EXPECT_EQ(get("/index.html").body, index.body);
  const auto script = get("/assets/index-1f.js");
  EXPECT_EQ(script.header("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(script.header("Cache-Control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(script.header("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(script.header("Referrer-Policy"), "no-referrer");
  EXPECT_NE(script.header("Content-Security-Policy").find("script-src 'self'"), std::string::npos);
  EXPECT_EQ(get("/assets/index-1f.js", {{"If-None-Match", script.header("ETag")}}).status, 304);
  EXPECT_EQ(get("/?a=1").code(), "request.invalid_parameter");
  EXPECT_EQ(get("/.hidden").code(), "http.not_found");
  http::Router router;
  EXPECT_THROW(add_web_routes(router, (parts().folder / "models").string()), std::runtime_error);
}

TEST_F(Routes, ADiagramThatIsKeptMakesTheNextOneOfAlmostTheSameSitesCheaper) {
  Document request = {{"mesh", square()}, {"keep", true}, {"sites", {{{"vertex", 0}}, {{"vertex", 2}}}}};
  const auto first = post("/v1/voronoi-diagrams", request).json();
  const auto second = post("/v1/voronoi-diagrams", request).json();
  EXPECT_EQ(first["cells"], second["cells"]);
  request.erase("keep");
  EXPECT_EQ(post("/v1/voronoi-diagrams", request).json()["cells"], first["cells"]);
}

TEST_F(Routes, TheHolderOfAKeySeesOnlyItsOwnMeshesAndJobs) {
  const std::string body = with_quotes("{'vertices':[[0,0,0],[7,0,0],[0,7,0]],'faces':[[0,1,2]]}");
  const auto mesh = ask("POST", "/v1/meshes", body, {}, "mine").json()["id"].get<std::string>();
  const Document field = {{"mesh", mesh}, {"sources", {{{"vertex", 0}}}}};
  EXPECT_EQ(ask("GET", "/v1/meshes/" + mesh, {}, {}, "mine").status, 200);
  EXPECT_EQ(ask("GET", "/v1/meshes/" + mesh, {}, {}, "yours").code(), "mesh.not_found");
  EXPECT_EQ(ask("GET", "/v1/meshes", {}, {}, "mine").json()["meshes"].size(), 1U);
  EXPECT_EQ(ask("GET", "/v1/meshes", {}, {}, "yours").json()["meshes"].size(), 0U);
  const auto refused = ask("POST", "/v1/geodesic-fields", field.dump(), {}, "yours");
  EXPECT_EQ(refused.code() + refused.pointers(), "mesh.not_found /mesh");
  const auto accepted = ask("POST", "/v1/geodesic-fields", field.dump(), {{"Prefer", "respond-async"}}, "mine");
  ASSERT_EQ(accepted.status, 202) << accepted.body;
  const auto job = accepted.header("Location");
  EXPECT_EQ(ask("GET", job, {}, {}, "mine").status, 200);
  EXPECT_EQ(ask("GET", job, {}, {}, "yours").code(), "job.not_found");
  EXPECT_EQ(ask("GET", "/v1/jobs", {}, {}, "yours").json()["jobs"].size(), 0U);
  EXPECT_NE(ask("GET", job + "/events", {}, {}, "mine").body.find("event: finished"), std::string::npos);
  EXPECT_EQ(ask("DELETE", job, {}, {}, "yours").code(), "job.not_found");
  EXPECT_EQ(ask("DELETE", job, {}, {}, "mine").status, 204);
  EXPECT_EQ(ask("DELETE", "/v1/meshes/" + mesh, {}, {}, "yours").code(), "mesh.not_found");
  EXPECT_EQ(ask("DELETE", "/v1/meshes/" + mesh, {}, {}, "mine").status, 204);
}

TEST_F(Routes, NoMoreEventStreamsThanTheLimitAreFollowed) {
  const Document field = {{"mesh", square()}, {"sources", {{{"vertex", 0}}}}};
  const auto job = post("/v1/geodesic-fields", field, {{"Prefer", "respond-async"}}).header("Location");
  auto& services = parts().services;
  const int limit = std::exchange(services.limits.event_streams, 0);
  const auto refused = get(job + "/events");
  services.limits.event_streams = limit;
  EXPECT_EQ(refused.status, 503);
  EXPECT_EQ(refused.code(), "server.too_many_event_streams");
  EXPECT_EQ(refused.json()["setting"], "--event-streams");
  EXPECT_EQ(get(job + "/events").status, 200);
  EXPECT_EQ(services.event_streams, 0);
}

TEST_F(Routes, ReadinessDependsOnTheDiskAndOnTheEnd) {
  auto& services = parts().services;
  const auto ready = get("/readyz").json();
  EXPECT_GT(ready["disk_free_bytes"].get<std::int64_t>(), 0);
  EXPECT_EQ(ready["models_loaded"], 1);
  const auto limit = std::exchange(services.limits.min_free, std::int64_t{1} << 60);
  const auto full = get("/readyz");
  services.limits.min_free = limit;
  EXPECT_EQ(full.status, 507);
  EXPECT_EQ(full.code(), "store.full");
  EXPECT_EQ(full.header("Retry-After"), "60");
  services.draining = true;
  EXPECT_EQ(get("/readyz").code(), "server.shutting_down");
  services.draining = false;
}

TEST_F(Routes, MetricsTellWhatTheServerHas) {
  square();
  services_load();
  const auto text = get("/metrics").body;
  for (const char* line : {"supple_models_loaded 1", "supple_connections 3", "supple_event_streams 0"})
    EXPECT_NE(text.find(line), std::string::npos) << line << " is not in " << text;
  EXPECT_EQ(get("/healthz").json()["silence_seconds"], 0.25);
}

TEST_F(Routes, ABrowserSignsInWithAKeyAndOutAgain) {
  const auto folder = parts().folder / "keys";
  std::filesystem::create_directories(folder);
  const access::KeyFile file(folder / "keys");
  access::Token token;
  access::NewKey key;
  key.name = "mine";
  key.scopes = access::parse_scopes("read,compute");
  file.change([&](auto& keys) { token = access::add_key(keys, key, access::Gate::system_time().date); });
  access::Gate gate(file, access::Rule::where_keys_are);
  Services services;
  services.metrics = &parts().metrics;
  services.gate = &gate;
  const auto router = make_router(services);
  const auto ask_with = [&](const char* method, const std::string& body, Headers headers) {
    http::Request request;
    request.method = method;
    request.body = body;
    request.headers = std::move(headers);
    if (!body.empty()) request.headers.emplace_back("Content-Type", "application/json");
    return router.find(method, "/v1/session").route->handler(request);
  };
  const auto header = [](const http::Response& response, const std::string& name) {
    for (const auto& [key_of_header, value] : response.headers)
      if (key_of_header == name) return value;
    return std::string();
  };
  EXPECT_EQ(ask_with("GET", "", {}).body, R"({"key_required":true})");
  const auto signed_in = ask_with("POST", Document({{"key", access::token_text(token)}}).dump(), {});
  EXPECT_EQ(Document::parse(signed_in.body)["key"]["scopes"], Document({"read", "compute"}));
  EXPECT_EQ(signed_in.key, token.id);
  EXPECT_EQ(header(signed_in, "Cache-Control"), "no-store");
  const auto cookie = header(signed_in, "Set-Cookie");
  EXPECT_NE(cookie.find("; Path=/; HttpOnly; SameSite=Strict; Max-Age="), std::string::npos) << cookie;
  EXPECT_EQ(cookie.find("Secure"), std::string::npos);
  const Headers session{{"Cookie", cookie.substr(0, cookie.find(';'))}};
  EXPECT_EQ(Document::parse(ask_with("GET", "", session).body)["key"]["id"], token.id);
  const auto secure =
      ask_with("POST", Document({{"key", access::token_text(token)}}).dump(), {{"Origin", "https://supple.example"}});
  EXPECT_TRUE(header(secure, "Set-Cookie").ends_with("; Secure"));
  const auto signed_out = ask_with("DELETE", "", session);
  EXPECT_EQ(signed_out.status, 204);
  EXPECT_EQ(signed_out.key, token.id);
  EXPECT_NE(header(signed_out, "Set-Cookie").find("Max-Age=0"), std::string::npos);
}

TEST_F(Routes, AServerThatIsNotReadyAnswersSoWhereItNeedsItsStore) {
  Services starting;
  starting.metrics = &parts().metrics;
  const auto router = make_router(starting);
  const auto code = [&](const char* method, const char* path) {
    http::Request request;
    request.method = method;
    request.path = path;
    try {
      router.find(method, path).route->handler(request);
    } catch (const Error& error) {
      return error.code();
    }
    return std::string();
  };
  EXPECT_EQ(code("GET", "/readyz"), "server.not_ready");
  EXPECT_EQ(code("GET", "/v1/meshes"), "server.not_ready");
  EXPECT_EQ(code("GET", "/v1/models"), "server.not_ready");
  EXPECT_EQ(code("GET", "/v1/jobs"), "server.not_ready");
  EXPECT_EQ(code("POST", "/v1/geodesics"), "server.not_ready");
  EXPECT_EQ(code("GET", "/healthz"), "");
  EXPECT_EQ(code("GET", "/metrics"), "");
  starting.stopping = true;
  EXPECT_EQ(code("GET", "/v1/jobs"), "server.shutting_down");
}

}  // namespace
}  // namespace supple::routes
