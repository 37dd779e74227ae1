// The facts of a print: time, material and size, and the notes of the G-code checker and the layout.
import { h } from "../base/dom";
import { digits } from "../base/format";
import type { Plan } from "./print_session";
import type { PrintSettings } from "./printer";

/** Limit of the listed violations; the total number is stated separately. */
const MAX_LISTED = 8;

export function duration(minutes: number): string {
  if (minutes < 1) return `${Math.max(1, Math.round(60 * minutes))} s`;
  const whole = Math.round(minutes);
  return whole < 60 ? `${digits(minutes, 2)} min` : `${Math.floor(whole / 60)} h ${whole % 60} min`;
}

/** A length as text, in mm or m. */
export function longWords(length: number): string {
  return length < 1000 ? `${digits(length)} mm` : `${digits(length / 1000)} m`;
}

export function printFacts({ settings, toolpath: { statistics } }: Plan): [string, string][] {
  const { filament, minutes, lowest, highest, extruded_length: printed, travel_length: travel, travels, channels, heights } = statistics;
  const diameter = Number(settings["/printer/filament_diameter"]);
  const volume = (filament * (Math.PI * diameter * diameter)) / 4000;
  return [
    ["Time", `${duration(minutes)}, without accelerations`],
    ["Filament", `${longWords(filament)}, ${digits(volume)} cm³`],
    ["Size", `${[0, 1].map((axis) => digits(highest[axis] - lowest[axis])).join(" × ")} mm, up to ${digits(highest[2])} mm high`],
    ["Printed", `${longWords(printed)}, ${channels} ${channels === 1 ? "channel" : "channels"}`],
    ["Travels", `${travels}, ${longWords(travel)}`],
    ["Level heights", `${heights.map((height) => digits(height)).join(", ")} mm`],
  ];
}

/** The printer in one line. */
export function printerWords(settings: PrintSettings): string {
  const at = (name: string) => String(settings[`/printer/${name}`]);
  return `${at("name")}: nozzle ${at("nozzle_temperature")} °C, bed ${at("bed_temperature")} °C, ${at("bed/0")} × ${at("bed/1")} mm.`;
}

export function printNotes({ warnings, toolpath: { check } }: Plan): HTMLElement[] {
  const { violations, violation_count: count } = check;
  const listed = violations.slice(0, MAX_LISTED);
  const found = count === 0
    ? h("p", { class: "note good" }, "The checker has read the G-code and finds nothing wrong.")
    : h("div", { class: "note" }, h("p", {}, `The checker objects ${count} ${count === 1 ? "time" : "times"}:`),
      h("ul", { class: "violations" }, ...listed.map(({ line, kind, message }) => h("li", {}, `line ${line}, ${kind.replace(/_/g, " ")}: ${message}`))),
      count > listed.length && h("p", {}, `and ${count - listed.length} more`));
  const uncheckedCommands = [...new Set(check.unchecked.map(({ command }) => command))];
  const unchecked = uncheckedCommands.length > 0 &&
    h("p", { class: "note" },
      `Passed on to the printer, and not followed by the checker: ${uncheckedCommands.slice(0, MAX_LISTED).join(", ")}${uncheckedCommands.length > MAX_LISTED ? ", …" : ""}.`);
  return [found, ...(unchecked ? [unchecked] : []), ...warnings.map((words) => h("p", { class: "note" }, words))];
}
