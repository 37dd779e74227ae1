// The controls of the host: rigid, shell or solid, its parameters and its supports.
import { Checkbox, Segments, Slider } from "../base/controls";
import { h } from "../base/dom";
import { type Host, HOST_KINDS, hostFault, type HostKind, hostLimits, VOLUME_SCALE_LIMITS } from "./host";
import type { NetworkSession } from "./network_session";
import { POISSON_LIMITS } from "./network_state";
import type { Nudge } from "./nudge_buttons";
import type { MeshSession } from "./session";
import { supportControls } from "./support_controls";

const KIND_WORDS: Record<HostKind, string> = { rigid: "Rigid", shell: "Shell", solid: "Solid" };
const HELP: Record<HostKind, string> = {
  rigid: "The surface keeps its shape.",
  shell: "The surface is a thin elastic sheet, at rest as the mesh has it. Lengths are in mesh units, energies in those of the springs.",
  solid: "The closed surface is filled with elastic tetrahedra, at rest as the mesh has it. Lengths are in mesh units, energies in those of the springs.",
};

export function hostControls(mesh: MeshSession, network: NetworkSession, nudge: Nudge): HTMLElement {
  const kind = new Segments<HostKind>("Host", HOST_KINDS.map((value) => ({ value, words: KIND_WORDS[value] })), (value) => network.changeHost({ kind: value }));
  const help = h("p", { class: "muted" });
  const fault = h("p", { class: "note", hidden: true });
  const slider = (label: string, digits: number, change: (value: number) => Partial<Host>, [lower, upper]: readonly [number, number] = [0, 1]) =>
    new Slider({ label, lower, upper, digits, changed: (value, done) => done && network.changeHost(change(value)) });
  const thickness = slider("Thickness of the shell (length)", 5, (value) => ({ thickness: value }));
  const shellModulus = slider("Young’s modulus of the shell (energy / length³)", 4, (value) => ({ shellModulus: value }));
  const solidModulus = slider("Young’s modulus of the solid (energy / length³)", 4, (value) => ({ solidModulus: value }));
  const poisson = slider("Poisson’s ratio of the host", 4, (poissonRatio) => ({ poissonRatio }), POISSON_LIMITS);
  const bends = new Checkbox("Resist bending", (value) => network.changeHost({ bends: value }));
  const volumeCheckbox = new Checkbox("Keep the enclosed volume", (keepsVolume) => network.changeHost({ keepsVolume }));
  const volumeWeight = slider("Weight of the volume (energy / length³)", 4, (value) => ({ volumeWeight: value }));
  const volumeScale = slider("Volume to keep, over that at rest", 4, (value) => ({ volumeScale: value }), VOLUME_SCALE_LIMITS);
  const gravity = slider("Gravity along −z (energy / length⁴)", 5, (value) => ({ gravity: value }));
  const shellFields = h("div", { class: "parameters" }, thickness.element, shellModulus.element);
  const volume = h("div", { class: "parameters" }, volumeWeight.element, volumeScale.element);
  const shellOptions = h("div", { class: "parameters" }, h("div", {}, bends.element, volumeCheckbox.element), volume);
  const solidFields = h("div", { class: "parameters" }, gravity.element);
  const supports = supportControls(mesh, network, nudge);
  const fields = h("div", { class: "parameters" }, shellFields, solidModulus.element, poisson.element, shellOptions, solidFields, supports);
  const limit = () => {
    const diagonal = mesh.mesh.get()?.info.bounding_box.diagonal;
    if (!diagonal) return;
    const limits = hostLimits(diagonal);
    thickness.limit(...limits.thickness);
    shellModulus.limit(...limits.shellModulus);
    solidModulus.limit(...limits.solidModulus);
    volumeWeight.limit(...limits.volumeWeight);
    gravity.limit(...limits.gravity);
  };
  const show = () => {
    const { host } = network.state.get();
    const loaded = mesh.mesh.get();
    kind.value = host.kind;
    help.textContent = HELP[host.kind];
    const sentence = loaded && hostFault(host, loaded.info);
    fault.hidden = !sentence;
    fault.textContent = sentence ?? "";
    fields.hidden = host.kind === "rigid";
    shellFields.hidden = shellOptions.hidden = host.kind !== "shell";
    solidModulus.element.hidden = solidFields.hidden = host.kind !== "solid";
    volume.hidden = !host.keepsVolume;
    thickness.value = host.thickness;
    shellModulus.value = host.shellModulus;
    solidModulus.value = host.solidModulus;
    poisson.value = host.poissonRatio;
    bends.value = host.bends;
    volumeCheckbox.value = host.keepsVolume;
    volumeWeight.value = host.volumeWeight;
    volumeScale.value = host.volumeScale;
    gravity.value = host.gravity;
  };
  mesh.mesh.watch(() => {
    limit();
    show();
  });
  network.state.watch(show);
  return h("div", { class: "parameters" }, kind.element, help, fields, fault);
}
