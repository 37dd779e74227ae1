// The card about the server: the family's name and words, adding and removing it, drawings of tiles, and the way to the page Design.
import { announce } from "../base/announce";
import { button, Checkbox, Select } from "../base/controls";
import { h, writeText } from "../base/dom";
import { TextField } from "../base/fields";
import { keepFocus } from "../base/focus";
import { type Library, nameFault, withFreeName } from "./library";
import type { FamilySession } from "./session";
import { FIRST_TYPE, MAX_ID_LENGTH, MAX_WORDS_LENGTH, typeName, typeWords } from "./state";

/** `use`: opens the page Design with the family. */
export function libraryCard(session: FamilySession, library: Library, use: () => void): HTMLElement {
  const shipped = (): string[] => session.families.get().filter(({ created }) => created === null).map(({ id }) => id);
  const define = (change: { id?: string; description?: string }) => session.apply({ definition: { ...session.state.get().definition, ...change } });
  const name = new TextField({ label: "Name", maxLength: MAX_ID_LENGTH, fault: (text) => nameFault(text, []), changed: (id) => define({ id }) });
  const words = new TextField({ label: "What the family is", maxLength: MAX_WORDS_LENGTH, changed: (description) => define({ description }) });
  const state = h("p", { class: "library-state" });
  const owner = h("p", { class: "muted" },
    "A family belongs to the key that adds it, which alone sees it; where no key is needed, it is everyone’s. The administrator can publish its network, and the family with it, to all keys.");
  const add = button("Add to the server", () => void library.add(), { kind: "primary" });
  const swap = button("Replace the stored one", () => void library.add(true), { title: "Removes the family that the server has under this name, and adds this one" });
  const rename = button("Give it a free name", () => session.apply({ definition: withFreeName(session.state.get().definition, session.families.get().map(({ id }) => id)) }));
  const remove = button("Remove from the server", () => void library.remove(), { kind: "quiet" });
  const useIt = button("Use it on the page Design", use, { kind: "primary" });
  const useWords = h("p", { class: "muted" });
  const outcome = h("p", { class: "note", role: "status", hidden: true });
  const element = h("section", { class: "card library controls", "aria-label": "On the server" }, h("h2", {}, "On the server"), name.element, words.element, state,
    h("div", { class: "row" }, add, swap, rename, remove), owner, drawingForm(session, library), outcome, useIt, useWords);

  function draw(): void {
    const { definition } = session.state.get();
    const { namesake, isStored, model } = session;
    const isShipped = namesake !== null && namesake.created === null;
    const hasFaults = session.findings?.some(({ kind }) => kind === "fault") ?? false;
    name.value = definition.id;
    words.value = definition.description;
    const fault = isStored ? "" : nameFault(definition.id, shipped());
    writeText(state, isStored ? (isShipped ? `${definition.id} comes with the server.` : `The server has ${definition.id}.`)
      : fault ||
        (namesake ? `The server has another family of the name ${definition.id}.`
          : hasFaults ? "A family with faults is not added: see below the drawing." : "The server does not have this family yet."));
    keepFocus(element, () => {
      add.hidden = isStored || namesake !== null;
      swap.hidden = isStored || namesake === null || isShipped;
      rename.hidden = isStored || namesake === null;
      remove.hidden = !isStored || isShipped;
      const isBusy = library.isBusy.get();
      for (const action of [add, swap]) action.disabled = isBusy || hasFaults || fault !== "";
      remove.disabled = isBusy;
      owner.hidden = isStored && isShipped;
      useIt.hidden = model === null;
    }, remove, useIt, add, name.input);
    writeText(useWords, model !== null ? `Designs use its network ${model.id}.`
      : isStored ? "Designs need a network of the family: train one below." : "Designs need a network, which is trained once the server has the family.");
  }

  session.redraws.follow([session.state, session.families, session.models, session.checked, library.isBusy], draw);
  library.outcome.watch(({ sentence, isFault }) => {
    outcome.hidden = sentence === "";
    outcome.classList.toggle("good", !isFault);
    outcome.textContent = sentence;
    if (sentence !== "") announce(sentence);
  });
  // What was told of one family says nothing of another.
  let told = "";
  session.state.watch(({ definition: { id } }) => {
    if (told !== "" && told !== id && !library.isBusy.get()) library.outcome.set({ sentence: "", isFault: false });
    told = id;
  });
  return element;
}

/** The form that makes a family of a drawing of a tile. */
function drawingForm(session: FamilySession, library: Library): HTMLElement {
  let type = FIRST_TYPE;
  let id = "";
  let shapeParameters = false;
  const heading = h("p", {});
  const types = new Select<string>("Isohedral type of the drawn tile", [], (value) => {
    type = Number(value);
  });
  const name = new TextField({
    label: "Name of the new family",
    maxLength: MAX_ID_LENGTH,
    fault: (text) => nameFault(text, session.families.get().map((family) => family.id)),
    changed: (text) => {
      id = text;
    },
  });
  const heights = new Checkbox("Heights of curved edges become parameters", (value) => {
    shapeParameters = value;
  });
  const make = button("Make a family of it", () => void library.addDrawing({ type, id, shapeParameters }), { kind: "primary" });
  const cancel = button("Cancel", () => library.drawing.set(null), { kind: "quiet" });
  const element = h("div", { class: "controls drawing-form", role: "group", "aria-label": "Drawing of a tile", hidden: true }, heading, types.element, name.element,
    heights.element, h("p", { class: "muted" }, "The server adds the family under this name. Remove it if it is not what you meant."), h("div", { class: "row" }, make, cancel));
  session.types.watch((all) => {
    types.setChoices(all.map((one) => ({ value: String(one.number), words: typeWords(one) })));
    types.value = String(type);
  });
  library.isBusy.watch((isBusy) => (make.disabled = isBusy));
  library.drawing.watch((drawing) => {
    element.hidden = drawing === null;
    if (!drawing) return;
    const taken = session.families.get().map((family) => family.id);
    const plain = drawing.name.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9_-]+/g, "-").slice(0, MAX_ID_LENGTH) || typeName(type).toLowerCase();
    id = withFreeName({ id: plain, description: "", parameters: [], beam_width: 1 }, taken).id;
    name.value = id;
    heights.value = shapeParameters;
    heading.textContent = `${drawing.name}: one closed curve with a corner at each vertex of the tile. Which type is it a tile of?`;
    announce(heading.textContent);
    element.scrollIntoView({ block: "nearest" });
    element.querySelector("select")?.focus({ preventScroll: true });
  });
  return element;
}
