// The state as the text of a link. The definition is in it as a whole, since families of one's own may be removed or belong to another key.
import { plain } from "../base/format";
import { numberOf, readFields, writeFields } from "../base/link_fields";
import { readDefinition } from "./definition_reader";
import { CORE_HOURS, DEFAULT_TRAINING, ERRORS, type FamilyState, withinBounds } from "./state";

/** Limit of the length of a link; some programs truncate longer ones. */
const MAX_LINK_LENGTH = 30_000;
const MAX_VALUE = 1e6;

export function isShareable(state: FamilyState): boolean {
  return writeLink(state).length <= MAX_LINK_LENGTH;
}

export function writeLink({ definition, shown, coreHours, error }: FamilyState): string {
  const fields: [string, string][] = [["definition", encodeURIComponent(JSON.stringify(definition))]];
  if (shown.length > 0) fields.push(["shown", shown.map(plain).join(",")]);
  if (coreHours !== DEFAULT_TRAINING.coreHours) fields.push(["core-hours", plain(coreHours)]);
  if (error !== DEFAULT_TRAINING.error) fields.push(["error", plain(error)]);
  return writeFields(fields);
}

/** The state of a link; null if the text is no valid link. */
export function readLink(text: string): FamilyState | null {
  const fields = readFields(text);
  const written = fields.get("definition");
  if (!written) return null;
  try {
    const definition = readDefinition(JSON.parse(written));
    const shown = (fields.get("shown") ?? "").split(",").map((value) => numberOf(value, -MAX_VALUE, MAX_VALUE, Number.NaN));
    const isWhole = shown.length === definition.parameters.length && shown.every((value) => !Number.isNaN(value));
    const error = Number(fields.get("error") ?? DEFAULT_TRAINING.error);
    return {
      definition,
      shown: withinBounds(definition, isWhole ? shown : []),
      coreHours: numberOf(fields.get("core-hours"), ...CORE_HOURS, DEFAULT_TRAINING.coreHours),
      error: ERRORS.includes(error) ? error : DEFAULT_TRAINING.error,
    };
  } catch {
    return null; // no JSON, or no definition
  }
}
