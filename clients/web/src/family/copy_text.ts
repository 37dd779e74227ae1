// The family as a curl command, as commands for a shell and as a Python program that add it to the server.
import { curlText } from "../base/curl";
import type { FamilyDefinition } from "../contract/types";

export function curlOf(definition: FamilyDefinition, origin: string): string {
  return curlText(origin, "/v1/families", { definition });
}

export function commandOf(definition: FamilyDefinition, origin: string): string {
  return `cat > ${definition.id}.json <<'END'\n${JSON.stringify(definition)}\nEND\nsupple --server ${origin} families add ${definition.id}.json\n`;
}

export function pythonOf(definition: FamilyDefinition, origin: string): string {
  return `import json\nimport supple\n\nclient = supple.Client(${JSON.stringify(origin)})\ndefinition = json.loads(r'''${
    JSON.stringify(definition)
  }''')\nprint(client.add_family(definition))\n`;
}

/** The definition as the text of a file, as the server's own families are written: a line for each point. */
export function fileOf(definition: FamilyDefinition): string {
  const text = JSON.stringify(definition, null, 2);
  // Lists of numbers, and points of them, are short enough for a line.
  return `${text.replace(/\[[^[\]{}]*\]/g, oneLine).replace(/\[[^{}[\]]*(?:\[[^[\]{}]*\][^{}[\]]*){1,2}\]/g, oneLine)}\n`;
}

function oneLine(list: string): string {
  return list.replace(/\s+/g, " ").replace(/\[ /g, "[").replace(/ \]/g, "]");
}
