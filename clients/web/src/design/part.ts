// A part of the design that is shown: what is asked for, and what the server says of it.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import type { PartAnswer, PartRequest } from "../contract/types";
import { DEFAULT_MADE, radians } from "./made";
import type { Shown } from "./shown";
import type { Found } from "./state";

export type PartKind = "rectangle" | "coupon" | "block";
export type PartFormat = "stl" | "3mf" | "step" | "dxf" | "svg";

/** Lengths in mm, the density in g/cm^3, the orientation in degrees. */
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
  readonly whole: boolean;
}

/** Walls as wide as a common nozzle, and a strip wide enough that the tiles of every family hold it together. */
export const FIRST_PART: PartSettings = { kind: "coupon", width: 30, length: 60, end: 15, beamWidth: 0.4, thickness: 4, frame: 0, density: 1.2, orientation: 0, whole: false };

export const PART_TYPES: Record<PartFormat, string> = { stl: "model/stl", "3mf": "model/3mf", step: "model/step", dxf: "image/vnd.dxf", svg: "image/svg+xml" };

export function partRequest(found: Found, settings: PartSettings): PartRequest {
  const { kind, width, length, end } = settings;
  const outline: PartRequest["outline"] =
    kind === "rectangle" ? { rectangle: [width, length] }
    : kind === "coupon" ? { coupon: { width, length, grip_length: end } }
    : { block: { width, height: length, plate: end } };
  return {
    outline,
    structure: { family: found.family, parameters: [...found.parameters] },
    beam_width: settings.beamWidth,
    ...(settings.orientation !== 0 && { orientation: radians(settings.orientation) }),
    thickness: settings.thickness,
    frame: settings.frame,
    rim: settings.whole ? "whole" : "clipped",
    material: { density: settings.density },
  };
}

/** What a part of a design begins with: walls, density and orientation of the design, and a common nozzle's walls where no size was asked for. */
export function settingsOf({ measures, made }: Pick<Shown, "measures" | "made">): Pick<PartSettings, "beamWidth" | "density" | "orientation"> {
  const { beamWidth, materialDensity, orientation } = measures;
  const asked = made.size.kind !== DEFAULT_MADE.size.kind || made.size.value !== DEFAULT_MADE.size.value;
  return {
    beamWidth: asked && beamWidth !== null ? Number(beamWidth.toPrecision(4)) : FIRST_PART.beamWidth,
    density: materialDensity,
    orientation: Number(((orientation * 180) / Math.PI).toFixed(2)),
  };
}

/** The name that the server gives a file, or one of its own kind. */
export function fileName(disposition: string | null, format: PartFormat): string {
  return /filename="([^"]+)"/.exec(disposition ?? "")?.[1] ?? `part.${format}`;
}

/** What the server has made, or why it could not. */
export type PartState =
  | { readonly kind: "none" }
  | { readonly kind: "made"; readonly answer: PartAnswer }
  | { readonly kind: "failed"; readonly sentence: string };

export class Part {
  readonly settings = new Observable<PartSettings>(FIRST_PART);
  readonly state = new Observable<PartState>({ kind: "none" });
  private readonly requests = new Latest();

  constructor(private readonly client: Client) {}

  /** Asks for the part's picture and numbers; a newer question replaces an older one. */
  describe(found: Found): void {
    const request = { ...partRequest(found, this.settings.get()), svg: true };
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
  async file(found: Found, format: PartFormat): Promise<{ name: string; type: string; content: Blob }> {
    const response = await this.client.postResponse("/v1/parts", partRequest(found, this.settings.get()), { headers: { Accept: PART_TYPES[format] } });
    return { name: fileName(response.headers.get("Content-Disposition"), format), type: PART_TYPES[format], content: await response.blob() };
  }
}
