// Checks Kubernetes objects, a JSON list on standard input, with the schemas of the package kubernetes-models: first each value by the
// schema, then the names of all fields by the TypeScript types, since the schemas permit unknown fields. Prints a line for each fault;
// the exit status is 1 if there are any.

import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import ts from "typescript";

const objects = JSON.parse(readFileSync(0, "utf8"));
const faults = [];
const program = [];
for (const [index, object] of objects.entries()) {
  const module = `kubernetes-models/${object.apiVersion}`;
  const name = `${object.kind} ${object.metadata?.name}`;
  let kinds;
  try {
    kinds = await import(module);
  } catch {
    faults.push(`${name}: there is no apiVersion '${object.apiVersion}'`);
    continue;
  }
  if (!(object.kind in kinds)) {
    faults.push(`${name}: ${object.apiVersion} has no kind '${object.kind}'`);
    continue;
  }
  try {
    new kinds[object.kind](object).validate();
  } catch (error) {
    faults.push(`${name}: ${error.message}`);
  }
  program.push(`import type { I${object.kind} as Kind${index} } from "${module}";`,
               `export const object${index}: Kind${index} = ${JSON.stringify(object)};`);
}

// The compiler finds the types only from a folder within this one.
const folder = new URL("node_modules/.manifests/", import.meta.url).pathname;
mkdirSync(folder, { recursive: true });
const file = `${folder}manifests.ts`;
writeFileSync(file, program.join("\n"));
const options = { noEmit: true, strict: true, skipLibCheck: true, module: ts.ModuleKind.NodeNext,
                  moduleResolution: ts.ModuleResolutionKind.NodeNext, target: ts.ScriptTarget.ES2022, types: [] };
for (const found of ts.getPreEmitDiagnostics(ts.createProgram([file], options)))
  faults.push(ts.flattenDiagnosticMessageText(found.messageText, " "));

for (const fault of faults) console.log(fault);
process.exitCode = faults.length > 0 ? 1 : 0;
