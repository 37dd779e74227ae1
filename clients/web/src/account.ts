// Signing in with a key, where the server asks for one, and out again. The key goes to the server once; what the browser
// keeps is a session's cookie, which no script sees.
import { button } from "./base/controls";
import { h, uniqueId } from "./base/dom";
import { Client, explain, isUnauthorized } from "./contract/client";
import type { KeySession } from "./contract/types";


export class Account {
  /** For the header: who is signed in, and a button to sign out. */
  readonly element = h("div", { class: "account", hidden: true });
  readonly dialog: HTMLDialogElement;
  private readonly client = new Client();
  private readonly input = h("input", { type: "password", id: uniqueId("key"), required: true, autocomplete: "current-password", spellcheck: "false" });
  private readonly problem = h("p", { class: "problem", role: "alert" });
  private readonly submit = h("button", { type: "submit", class: "button primary" }, "Sign in");
  private waiting: (() => void)[] = [];

  constructor() {
    const heading = h("h2", { id: uniqueId("sign-in") }, "Sign in");
    const form = h("form", {
      onsubmit: (event: Event) => {
        event.preventDefault();
        void this.signIn();
      },
    },
      heading,
      h("p", {}, "This server answers holders of a key. Whoever runs it makes one with supple-server keys add."),
      h("label", { for: this.input.id }, "Key"),
      this.input,
      this.problem,
      this.submit);
    this.dialog = h("dialog", { class: "sign-in", "aria-labelledby": heading.id, oncancel: (event: Event) => event.preventDefault() }, form);
  }

  /** Asks for a key, once for all who wait, and resolves when the server has accepted one. */
  ask(): Promise<void> {
    return new Promise((resolve) => {
      this.waiting.push(resolve);
      if (!this.dialog.open) this.dialog.showModal();
    });
  }

  /** Finds out who is signed in. */
  async look(): Promise<void> {
    const session = await this.client.get<KeySession>("/v1/session").catch(() => null); // an ended session, or nobody there
    if (session) this.show(session);
  }

  private async signIn(): Promise<void> {
    this.submit.disabled = true;
    this.problem.textContent = "";
    try {
      this.show(await this.client.post<KeySession>("/v1/session", { key: this.input.value.trim() }));
      this.input.value = "";
      this.dialog.close();
      for (const resolve of this.waiting.splice(0)) resolve();
    } catch (error) {
      this.problem.textContent = isUnauthorized(error) ? "The server does not accept this key." : explain(error);
      this.input.select();
    } finally {
      this.submit.disabled = false;
    }
  }

  private show({ key }: KeySession): void {
    this.element.hidden = !key;
    if (!key) return;
    this.element.replaceChildren(h("span", { class: "key-name" }, key.name), button("Sign out", () => void this.signOut(), { kind: "quiet" }));
  }

  private async signOut(): Promise<void> {
    await this.client.send("DELETE", "/v1/session");
    location.reload(); // what is in sight was the key's
  }
}
