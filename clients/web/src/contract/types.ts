// Short names for the schemas of api/openapi.yaml; schema.ts is generated from it.
import type { components } from "./schema";

type Schemas = components["schemas"];

export type Task = Schemas["Task"];
export type StrainMeasure = Schemas["StrainMeasure"];
export type DesignRequest = Schemas["DesignRequest"];
export type Design = Schemas["Design"];
export type DesignProfile = Schemas["DesignProfile"];
export type DesignCandidate = Schemas["DesignCandidate"];
export type DesignStop = Schemas["DesignStop"];
export type PartialDesign = Schemas["PartialDesign"];
export type Polish = NonNullable<Schemas["Polish"]>;
export type Verified = NonNullable<DesignProfile["verified"]>;
export type ProfileRequest = Schemas["ProfileRequest"];
export type Profile = Schemas["ProfileResponse"];
export type Family = Schemas["Family"];
export type Model = Schemas["Model"];
export type SimulationRequest = Schemas["SimulationRequest"];
export type Simulation = Schemas["SimulationResponse"];
export type PatchMesh = Schemas["PatchMesh"];
export type Job = Schemas["Job"];
export type ProblemDocument = Schemas["Problem"];
export type Mesh = Schemas["Mesh"];
export type MeshRepair = Schemas["MeshRepair"];
export type Repair = Schemas["Repair"];
export type SurfacePoint = Schemas["Point"];
export type Geodesics = Schemas["GeodesicsResponse"];
export type PathPoint = Schemas["PathPoint"];
export type KarcherMean = Schemas["KarcherMeanResponse"];
export type EmbeddedSystemRequest = Schemas["EmbeddedSystemRequest"];
export type EmbeddedSystem = Schemas["EmbeddedSystemResponse"];
export type NetworkSpring = Schemas["NetworkSpring"];
export type EffectSwitch = Schemas["EffectSwitch"];
export type Effect = Schemas["Effect"];
export type Cost = Schemas["Cost"];

/** One design's answer; requests of this editor have no regions, so that every field of a design is there. */
export type DesignAnswer = Design & Pick<Schemas["DesignResponse"], "accuracy" | "effects" | "cost">;
export type Weave = Schemas["Weave"];
export type WeaveStrands = Schemas["WeaveLayout"];
export type CrossingOverride = Schemas["CrossingOverrides"][number];
export type CrossingMember = Schemas["CrossingMember"];
export type WeaveLayoutRequest = Schemas["WeaveLayoutRequest"];
export type WeaveLayout = Schemas["WeaveLayoutResponse"];
export type WeaveStop = Schemas["WeaveStop"];
export type WeaveHomogenizationRequest = Schemas["WeaveHomogenizationRequest"];
export type WeaveHomogenization = Schemas["WeaveHomogenizationResponse"];
export type WeaveSimulationRequest = Schemas["WeaveSimulationRequest"];
export type WeaveSimulation = Schemas["WeaveSimulationResponse"];
export type WeaveToolpath = Schemas["WeaveToolpathResponse"];
export type WeaveEquilibrium = Schemas["WeaveState"];
