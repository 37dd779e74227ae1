// A part of the design that is shown: what is asked for, and what the server says of it.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, explainFile, isAbort, Problem } from "../contract/client";
import type { OutlineRequest, Outlines, PartAnswer, PartRequest } from "../contract/types";
import { type Choices, type Drawing, type Layout, type Where } from "./drawing";
import { DEFAULT_MADE, radians } from "./made";
import type { Shown } from "./shown";
import { type Found, isPolar } from "./state";

export type PartKind = "rectangle" | "coupon" | "block" | "drawing";
export type PartFormat = "stl" | "3mf" | "step" | "dxf" | "svg";

/** Lengths in mm, the density in g/cm^3, angles in degrees. */
export interface PartSettings {
  readonly kind: PartKind;
  readonly width: number;
  /** Of the structure: between grips or plates where there are any. */
  readonly length: number;
  /** Of a grip or a plate. */
  readonly end: number;
  readonly beamWidth: number;
  readonly thickness: number;
  readonly frame: number;
  readonly density: number;
  readonly orientation: number;
  /** The direction of the design that is to lie along the load of a coupon or a block; null where the design has no single one. */
  readonly direction: number | null;
  readonly whole: boolean;
}

/** Walls as wide as a common nozzle, and a strip wide enough that the tiles of every family hold it together. */
export const FIRST_PART: PartSettings = { kind: "coupon", width: 30, length: 60, end: 15, beamWidth: 0.4, thickness: 4, frame: 0, density: 1.2, orientation: 0, direction: null, whole: false };

export const PART_TYPES: Record<PartFormat, string> = { stl: "model/stl", "3mf": "model/3mf", step: "model/step", dxf: "image/vnd.dxf", svg: "image/svg+xml" };

type Polygon = Outlines["polygons"][number]["points"];
type Structure = Pick<PartRequest, "structure" | "beam_width" | "orientation">;

/** What fills a part, or one of its regions. The orientation in radians, the width in mm. */
export interface Filling {
  readonly name: string;
  readonly found: Found;
  readonly orientation: number;
  readonly beamWidth: number;
}

/** A part of a shape of its own. */
export interface Product {
  readonly outline: readonly Polygon[];
  /** What lies in no region. */
  readonly rest: Filling;
  readonly regions: readonly { readonly outline: Polygon; readonly filling: Filling }[];
}

/** The part of a drawing. A region without a design is left out; null where none has one. */
export function productOf({ curves }: Drawing, { outline, regions }: Layout, fillings: readonly (Filling | null)[]): Product | null {
  const known = fillings.filter((filling): filling is Filling => filling !== null);
  if (known.length === 0) return null;
  const points = (where: Where): Polygon | null => (typeof where === "number" ? curves.polygons[where].points : null);
  return {
    outline: outline.map((place) => curves.polygons[place].points),
    rest: fillings[regions.indexOf("rest")] ?? known[0],
    regions: fillings.flatMap((filling, k) => {
      const polygon = points(regions[k]);
      return filling && polygon ? [{ outline: polygon, filling }] : [];
    }),
  };
}

function structureOf({ found, beamWidth, orientation }: Omit<Filling, "name">): Structure {
  return { structure: { family: found.family, parameters: [...found.parameters] }, beam_width: beamWidth, ...(orientation !== 0 && { orientation }) };
}

/** `product`: of a part whose shape is a drawing. */
export function partRequest(found: Found, settings: PartSettings, product: Product | null = null): PartRequest {
  const { kind, width, length, end } = settings;
  const outline: PartRequest["outline"] =
    product ? { polygons: [...product.outline] }
    : kind === "rectangle" ? { rectangle: [width, length] }
    : kind === "coupon" ? { coupon: { width, length, grip_length: end } }
    : { block: { width, height: length, plate: end } };
  const regions = product?.regions ?? [];
  const loaded = !product && (kind === "coupon" || kind === "block");
  return {
    outline,
    ...structureOf(product?.rest ?? { found, beamWidth: settings.beamWidth, orientation: radians(settings.orientation) }),
    ...(regions.length > 0 && { regions: regions.map((region) => ({ name: region.filling.name, outline: region.outline, ...structureOf(region.filling) })) }),
    ...(loaded && settings.direction !== null && { direction: radians(settings.direction) }),
    thickness: settings.thickness,
    frame: settings.frame,
    rim: settings.whole ? "whole" : "clipped",
    material: { density: settings.density },
  };
}

/** The only direction along which a design is loaded, in degrees; null where its targets are over directions or of several ones. */
function loadDirection(targets: Shown["targets"]): number | null {
  const directions = new Set(targets.map(({ task, direction }) => (isPolar(task) ? null : direction)));
  const [only] = directions;
  return directions.size === 1 && only !== null ? degrees(only) : null;
}

/** Rounded as a person would write it. */
function degrees(angle: number): number {
  return Number(((angle * 180) / Math.PI).toFixed(2));
}

/** What a part of a design begins with: walls, density, orientation and direction of the design, and a common nozzle's walls where no size was asked for. */
export function settingsOf({ measures, made, targets }: Pick<Shown, "measures" | "made" | "targets">): Pick<PartSettings, "beamWidth" | "density" | "orientation" | "direction"> {
  const { beamWidth, materialDensity, orientation } = measures;
  const asked = made.size.kind !== DEFAULT_MADE.size.kind || made.size.value !== DEFAULT_MADE.size.value;
  return {
    beamWidth: asked && beamWidth !== null ? Number(beamWidth.toPrecision(4)) : FIRST_PART.beamWidth,
    density: materialDensity,
    orientation: degrees(orientation),
    direction: loadDirection(targets),
  };
}

/** The name that the server gives a file, or one of its own kind. */
export function fileName(disposition: string | null, format: PartFormat): string {
  return /filename="([^"]+)"/.exec(disposition ?? "")?.[1] ?? `part.${format}`;
}

export function outlineRequest(text: string, width: number | null, resolution: number | null = null): OutlineRequest {
  return { text, ...(width !== null && { width }), ...(resolution !== null && { resolution }) };
}

/** What the server has made, or why it could not. */
export type PartState =
  | { readonly kind: "none" }
  | { readonly kind: "made"; readonly answer: PartAnswer }
  | { readonly kind: "failed"; readonly sentence: string };

/** What a person has chosen of a drawing, and the width of the beams of each region in mm where that is not what its design says. */
export interface DrawingChoices extends Choices {
  readonly walls: readonly (number | undefined)[];
}

export const NO_CHOICES: DrawingChoices = { regions: [], walls: [] };

export class Part {
  readonly settings = new Observable<PartSettings>(FIRST_PART);
  readonly state = new Observable<PartState>({ kind: "none" });
  readonly drawing = new Observable<Drawing | null>(null);
  readonly choices = new Observable<DrawingChoices>(NO_CHOICES);
  /** Why the last drawing was refused. */
  readonly drawingProblem = new Observable<string>("");
  /** Whether the drawing that was opened last does not say how large its pixels are. */
  readonly resolutionAsked = new Observable<boolean>(false);
  private readonly requests = new Latest();
  private readonly drawings = new Latest();

  constructor(private readonly client: Client) {}

  /** Asks for the part's picture and numbers; a newer question replaces an older one. */
  describe(found: Found, product: Product | null = null): void {
    const request = { ...partRequest(found, this.settings.get(), product), svg: true };
    this.requests.submit(async (signal) => {
      try {
        const answer = await this.client.post<PartAnswer>("/v1/parts", request, { signal });
        if (!signal.aborted) this.state.set({ kind: "made", answer });
      } catch (error) {
        if (!signal.aborted && !isAbort(error)) this.state.set({ kind: "failed", sentence: explain(error) });
      }
    }, true);
  }

  /** The part as a file and its name. */
  async file(found: Found, format: PartFormat, product: Product | null = null): Promise<{ name: string; type: string; content: Blob }> {
    const response = await this.client.postResponse("/v1/parts", partRequest(found, this.settings.get(), product), { headers: { Accept: PART_TYPES[format] } });
    return { name: fileName(response.headers.get("Content-Disposition"), format), type: PART_TYPES[format], content: await response.blob() };
  }

  /** A drawing becomes the shape of the part. Ends with why it was refused, or with "". */
  open(text: string, name: string): Promise<string> {
    return this.readDrawing(text, name, null, null);
  }

  /** The same drawing, of another width in mm. */
  scale(width: number | null): void {
    const drawing = this.drawing.get();
    if (!drawing) return;
    const resolution = this.asked?.text === drawing.text ? this.asked.resolution : drawing.resolution;
    void this.readDrawing(drawing.text, drawing.name, width, resolution);
  }

  /** The drawing that was opened last, with so many pixels per inch. */
  setResolution(resolution: number | null): void {
    if (this.asked) void this.readDrawing(this.asked.text, this.asked.name, this.asked.width, resolution);
  }

  /** What was asked for last, whether the answer has come or not: changes that come before it add up. */
  private asked: { text: string; name: string; width: number | null; resolution: number | null } | null = null;

  private readDrawing(text: string, name: string, width: number | null, resolution: number | null): Promise<string> {
    this.asked = { text, name, width, resolution };
    return new Promise((done) => this.drawings.submit(async (signal) => {
      try {
        const curves = await this.client.post<Outlines>("/v1/outlines", outlineRequest(text, width, resolution), { signal });
        if (signal.aborted) return;
        if (this.drawing.get()?.text !== text) this.choices.set(NO_CHOICES);
        this.settings.set({ ...this.settings.get(), kind: "drawing" });
        this.drawing.set({ name, text, width, resolution, curves });
        this.resolutionAsked.set(resolution !== null || (curves.format === "svg" && !curves.unit_is_known));
        this.drawingProblem.set("");
        done("");
      } catch (error) {
        if (signal.aborted || isAbort(error)) return;
        this.drawingProblem.set(`${name}: ${explainFile(error)}`);
        this.resolutionAsked.set(error instanceof Problem && error.document.code === "outline.resolution_missing");
        done(explainFile(error));
      }
    }, true));
  }
}
