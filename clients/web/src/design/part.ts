// A part made of the shown design: its settings, its requests, and the server's answers.
import { Observable } from "../base/observable";
import { type Client, explain, Problem } from "../contract/client";
import { entriesAtFault } from "../contract/refusals";
import { JobRunner } from "../contract/runner";
import type { OutlineRequest, Outlines, PartAnswer, PartRequest } from "../contract/types";
import type { LayoutChoices, Drawing, PartLayout, RegionLocation } from "./drawing";
import { loadDirection } from "./part_load";
import { axisOf } from "./part_sketch";
import { radians } from "./specification";
import type { TargetResponse } from "./shown";
import type { TilingDesign } from "./state";

export type PartKind = "rectangle" | "coupon" | "block" | "drawing";
export type PartFormat = "stl" | "3mf" | "step" | "dxf" | "svg";

/** Lengths in mm, the density in g/cm^3, angles in degrees. */
export interface PartSettings {
  readonly kind: PartKind;
  readonly width: number;
  /** Length of the structure, without grips or plates. */
  readonly length: number;
  /** Length of each grip of a coupon. */
  readonly grip: number;
  /** Thickness of each plate of a block. */
  readonly plate: number;
  readonly beamWidth: number;
  readonly thickness: number;
  readonly frame: number;
  readonly density: number;
  readonly orientation: number;
  /** The direction of the design that lies along the axis of the part; null if the targets of the design have no common direction. */
  readonly direction: number | null;
  /** Direction in a sheet or a drawing along which the part will be loaded; null for none. */
  readonly axis: number | null;
  readonly whole: boolean;
}

/** The initial settings: the defaults of the contract, and a strip that is wide enough that the tiles of every family connect its ends. */
export const INITIAL_PART: PartSettings = {
  kind: "coupon",
  width: 30,
  length: 60,
  grip: 15,
  plate: 1,
  beamWidth: 0.3,
  thickness: 1,
  frame: 0,
  density: 1.2,
  orientation: 0,
  direction: null,
  axis: null,
  whole: false,
};

export const PART_TYPES: Record<PartFormat, string> = { stl: "model/stl", "3mf": "model/3mf", step: "model/step", dxf: "image/vnd.dxf", svg: "image/svg+xml" };

type Polygon = Outlines["polygons"][number]["points"];
type Structure = Pick<PartRequest, "structure" | "beam_width" | "orientation">;

/** The structure that fills a part or one of its regions. Angles in radians, beam width in mm. `direction`: that of the design's load, if it has a single one. */
export interface Filling {
  readonly name: string;
  readonly found: TilingDesign;
  readonly orientation: number;
  readonly direction: number | null;
  readonly beamWidth: number;
}

/** The contents of a part whose shape is a drawing. */
export interface Product {
  /** Empty if the regions alone make the part. */
  readonly outline: readonly Polygon[];
  /** The structure outside all regions. */
  readonly rest: Filling;
  readonly regions: readonly { readonly outline: Polygon; readonly filling: Filling }[];
}

/** The contents of a part from a drawing. Regions without a design are left out; null if no region has one. */
export function productOf({ curves }: Drawing, { outline, regions }: PartLayout, fillings: readonly (Filling | null)[]): Product | null {
  const known = fillings.filter((filling): filling is Filling => filling !== null);
  if (known.length === 0) return null;
  const points = (where: RegionLocation): Polygon | null => (typeof where === "number" ? curves.polygons[where].points : null);
  return {
    outline: outline.map((place) => curves.polygons[place].points),
    rest: fillings[regions.indexOf("rest")] ?? known[0],
    regions: fillings.flatMap((filling, k) => {
      const polygon = points(regions[k]);
      return filling && polygon ? [{ outline: polygon, filling }] : [];
    }),
  };
}

function structureOf({ found, beamWidth, orientation }: Omit<Filling, "name" | "direction">): Structure {
  return { structure: { family: found.family, parameters: [...found.parameters] }, beam_width: beamWidth, ...(orientation !== 0 && { orientation }) };
}

/** `product`: the contents of a part whose shape is a drawing; null for the other shapes. */
export function partRequest(found: TilingDesign, settings: PartSettings, product: Product | null = null): PartRequest {
  const { kind, width, length, grip, plate } = settings;
  const outline: PartRequest["outline"] = product ? (product.outline.length > 0 ? { polygons: [...product.outline] } : { regions: true })
    : kind === "rectangle" ? { rectangle: [width, length] }
    : kind === "coupon" ? { coupon: { width, length, grip_length: grip } }
    : { block: { width, height: length, plate } };
  const regions = product?.regions ?? [];
  const axis = axisOf(settings);
  const direction = product ? product.rest.direction : settings.direction === null ? null : radians(settings.direction);
  // A region of a design without a direction is not turned: its own axis is along the part's.
  const turned = (filling: Filling): { direction?: number } => (axis === null ? {} : { direction: filling.direction ?? axis });
  return {
    outline,
    ...structureOf(product?.rest ?? { found, beamWidth: settings.beamWidth, orientation: radians(settings.orientation) }),
    ...(regions.length > 0 &&
      { regions: regions.map((region) => ({ name: region.filling.name, outline: region.outline, ...structureOf(region.filling), ...turned(region.filling) })) }),
    ...(axis !== null && kind !== "coupon" && kind !== "block" && { axis }),
    ...(axis !== null && direction !== null && { direction }),
    thickness: settings.thickness,
    frame: settings.frame,
    rim: settings.whole ? "whole" : "clipped",
    material: { density: settings.density },
  };
}

/** An angle in degrees, rounded to two decimals. */
function degrees(angle: number): number {
  return Number(((angle * 180) / Math.PI).toFixed(2));
}

/** The initial settings of a part of a design: walls, density and orientation of the design, and the direction of its load. */
export function settingsOf(
  { measures, targets }: Pick<TargetResponse, "measures" | "targets">,
): Pick<PartSettings, "beamWidth" | "density" | "orientation" | "direction"> {
  const { beamWidth, materialDensity, orientation } = measures;
  const direction = loadDirection(targets);
  return {
    beamWidth: beamWidth === null ? INITIAL_PART.beamWidth : Number(beamWidth.toPrecision(4)),
    density: materialDensity,
    orientation: degrees(orientation),
    direction: direction === null ? null : degrees(direction),
  };
}

/** The file name in the header Content-Disposition, or a default one. */
export function fileName(disposition: string | null, format: PartFormat): string {
  return /filename="([^"]+)"/.exec(disposition ?? "")?.[1] ?? `part.${format}`;
}

export function outlineRequest(text: string, width: number | null, resolution: number | null = null): OutlineRequest {
  return { text, ...(width !== null && { width }), ...(resolution !== null && { resolution }) };
}

/** The server's answer, or why it could not make the part. */
export type PartState =
  | { readonly kind: "none" }
  | { readonly kind: "made"; readonly answer: PartAnswer }
  /** `curves`: those of the part that are at fault. */
  | { readonly kind: "failed"; readonly sentence: string; readonly curves: readonly Polygon[] };

/** The curves of a part that a refused request names: of its outline, and of its regions. */
export function curvesAtFault(error: unknown, product: Product | null): readonly Polygon[] {
  if (!(error instanceof Problem) || !product) return [];
  const { document } = error;
  const named = [...entriesAtFault(document, "polygons").map((entry) => product.outline[entry]),
    ...entriesAtFault(document, "regions").map((entry) => product.regions[entry]?.outline)];
  return named.filter((curve): curve is Polygon => curve !== undefined);
}

/** The user's choices for a drawing. `walls`: width of the walls of each region in mm; undefined for the width of its design. */
export interface DrawingChoices extends LayoutChoices {
  readonly walls: readonly (number | undefined)[];
}

export const NO_CHOICES: DrawingChoices = { regions: [], walls: [] };

export class Part {
  readonly settings = new Observable<PartSettings>(INITIAL_PART);
  readonly state = new Observable<PartState>({ kind: "none" });
  readonly drawing = new Observable<Drawing | null>(null);
  readonly choices = new Observable<DrawingChoices>(NO_CHOICES);
  /** Why the last drawing was refused; empty if it was not. */
  readonly drawingProblem = new Observable<string>("");
  /** Whether a resolution can be chosen: the last drawing states no physical size, or a resolution was chosen for it. */
  readonly resolutionAsked = new Observable<boolean>(false);
  private readonly requests: JobRunner;
  private readonly drawings: JobRunner;

  constructor(private readonly client: Client) {
    this.requests = new JobRunner(client);
    this.drawings = new JobRunner(client);
  }

  /** Requests the picture and the measures of the part. A newer request replaces an older one. */
  describe(found: TilingDesign, product: Product | null = null): void {
    const request = { ...partRequest(found, this.settings.get(), product), svg: true };
    this.requests.follow(async (run) => this.state.set({ kind: "made", answer: await run.post<PartAnswer>("/v1/parts", request) }),
      (error) => this.state.set({ kind: "failed", sentence: explain(error), curves: curvesAtFault(error, product) }), true);
  }

  /** The part as a file with its name. */
  async file(found: TilingDesign, format: PartFormat, product: Product | null = null): Promise<{ name: string; type: string; content: Blob }> {
    const response = await this.client.postResponse("/v1/parts", partRequest(found, this.settings.get(), product), { headers: { Accept: PART_TYPES[format] } });
    return { name: fileName(response.headers.get("Content-Disposition"), format), type: PART_TYPES[format], content: await response.blob() };
  }

  /** Makes a drawing the shape of the part. Resolves with the reason for a refusal, or with "". */
  open(text: string, name: string): Promise<string> {
    return this.readDrawing(text, name, null, null);
  }

  /** Scales the drawing to a width in mm; null for the size in the file. */
  scale(width: number | null): void {
    const drawing = this.drawing.get();
    if (!drawing) return;
    const resolution = this.lastRequest?.text === drawing.text ? this.lastRequest.resolution : drawing.resolution;
    void this.readDrawing(drawing.text, drawing.name, width, resolution);
  }

  /** Reads the last drawing again with a resolution in pixels per inch; null for the server's default. */
  setResolution(resolution: number | null): void {
    if (this.lastRequest) void this.readDrawing(this.lastRequest.text, this.lastRequest.name, this.lastRequest.width, resolution);
  }

  /** The last request, whether or not its answer has arrived: quick changes are based on it, so that they add up. */
  private lastRequest: { text: string; name: string; width: number | null; resolution: number | null } | null = null;

  private readDrawing(text: string, name: string, width: number | null, resolution: number | null): Promise<string> {
    this.lastRequest = { text, name, width, resolution };
    return new Promise((done) => {
      this.drawings.follow(async (run) => {
        const curves = await run.post<Outlines>("/v1/outlines", outlineRequest(text, width, resolution));
        if (this.drawing.get()?.text !== text) this.choices.set(NO_CHOICES);
        this.settings.set({ ...this.settings.get(), kind: "drawing" });
        this.drawing.set({ name, text, width, resolution, curves });
        this.resolutionAsked.set(resolution !== null || (curves.format === "svg" && !curves.unit_is_known));
        this.drawingProblem.set("");
        done("");
      }, (error) => {
        this.drawingProblem.set(`${name}: ${explain(error)}`);
        this.resolutionAsked.set(error instanceof Problem && error.document.code === "outline.resolution_missing");
        done(explain(error));
      }, true);
    });
  }
}
