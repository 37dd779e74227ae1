// The family page: makes its parts and connects them.
import { button } from "../base/controls";
import { copyMenu } from "../base/copy_as";
import { h, uniqueId } from "../base/dom";
import { download } from "../base/download";
import { handleDrops } from "../base/drops";
import { shareButton } from "../base/share";
import { StateLink } from "../base/state_link";
import { textOf } from "../base/text_file";
import { undoKeys } from "../base/undo_keys";
import type { Page, PageContext } from "../page";
import { atlasCard } from "./atlas_card";
import { AtlasSession } from "./atlas_session";
import { commandOf, curlOf, fileOf, pythonOf } from "./copy_text";
import { edgeCard } from "./edge_card";
import { Library } from "./library";
import { libraryCard } from "./library_card";
import { isShareable, readLink, writeLink } from "./link";
import { parameterCard } from "./parameter_card";
import { FamilySession } from "./session";
import { stage } from "./stage";
import type { FamilyState } from "./state";
import { trainingCard } from "./training_card";
import { TrainingSession } from "./training_session";
import { designLink } from "./use_family";

/** A family that is too long for a link has none. */
const LINK_TEXT = { write: (state: FamilyState) => (isShareable(state) ? writeLink(state) : ""), read: readLink };

export function familyPage({ client, link }: PageContext): Page {
  const session = new FamilySession(client);
  const library = new Library(session, client);
  const atlas = new AtlasSession(session, client);
  const training = new TrainingSession(session, client);
  const address = new StateLink(link, session.edited, LINK_TEXT, () => session.isStarted);
  const note = h("p", { class: "note problem", role: "alert", hidden: true });
  const open = (text: string, name: string): string => {
    const fault = library.open(text, name);
    note.hidden = true;
    return fault;
  };

  async function useIt(): Promise<void> {
    const { model } = session;
    const text = model && (await designLink(client, model));
    if (text) location.hash = `#/design?${text}`;
    else library.outcome.set({ sentence: "The network of this family does not answer; it may be of another definition of the same name.", isFault: true });
  }

  const share = shareButton("Copy a link to this family", () => {
    address.write();
    return isShareable(session.state.get()) ? undefined : "Too long for a link: save the file";
  });
  const tools = [...fileTools(session, open, note), share, copyAs(session)];
  const element = h(
    "div",
    { class: "family-page" },
    h("h1", { class: "visually-hidden" }, "Family"),
    h("div", { class: "column left" }, parameterCard(session), edgeCard(session)),
    h("div", { class: "column middle" }, note, stage(session, tools), atlasCard(session, atlas)),
    h("div", { class: "column right" }, libraryCard(session, library, () => void useIt()), trainingCard(session, training)),
  );
  handleDrops(element, (text, name) => Promise.resolve(open(text, name)));
  const keys = undoKeys(session);

  return {
    element,
    async open(text) {
      document.addEventListener("keydown", keys);
      if (!session.isStarted) return session.start(readLink(text));
      const linked = address.follow(text);
      if (linked) session.apply(linked);
      // Another page or another browser may have added families and networks meanwhile.
      await session.loadFamilies().catch(() => {}); // what needs them reports the fault
    },
    close() {
      document.removeEventListener("keydown", keys);
      address.close();
    },
    async resume(path, text) {
      const linked = text === writeLink(session.state.get()) ? null : readLink(text);
      if (!session.isStarted) return;
      if (linked) session.apply(linked);
      if (path === "/v1/family-atlases") await atlas.make();
      if (path === "/v1/training-plans") await training.estimate();
      if (path === "/v1/trainings") await training.train();
    },
    reconnected() {
      if (!session.isStarted) return void session.start(readLink(link.read()));
      session.retry();
      atlas.retry();
      training.retry();
    },
  };
}

/** Buttons that open and save the definition as a file. `open`: returns why a file cannot be used, or "". */
function fileTools(session: FamilySession, open: (text: string, name: string) => string, note: HTMLElement): HTMLElement[] {
  const file = h("input", {
    type: "file",
    accept: ".json,.svg,application/json,image/svg+xml",
    class: "visually-hidden",
    id: uniqueId("file"),
    onchange: () => {
      const chosen = file.files?.[0];
      file.value = "";
      if (chosen) void chosen.arrayBuffer().then((bytes) => show(open(textOf(bytes), chosen.name), chosen.name));
    },
  });
  function show(fault: string, name: string): void {
    note.hidden = fault === "";
    note.textContent = fault === "" ? "" : `${name}: ${fault}`;
  }
  const label = h("label", { class: "button", for: file.id, title: "A definition as JSON, or the drawing of a tile as SVG; or drop it onto the page" }, "Open");
  const save = button("Save", () => {
    const { definition } = session.state.get();
    download(`${definition.id}.json`, "application/json", fileOf(definition));
  }, { icon: "download", title: "Save the definition as JSON" });
  return [h("span", { class: "row" }, label, file), save];
}

function copyAs(session: FamilySession): HTMLElement {
  const copied = (write: typeof curlOf) => () => (session.isStarted ? write(session.state.get().definition, location.origin) : null);
  return copyMenu([{ words: "curl", text: copied(curlOf) }, { words: "Command line", text: copied(commandOf) }, { words: "Python", text: copied(pythonOf) }]);
}
