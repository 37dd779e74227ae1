// Signing in with a key and signing out, on servers that ask for keys. The key is sent once. The browser stores only the
// cookie of the session, which scripts cannot read.
import { button } from "./base/controls";
import { h, uniqueId } from "./base/dom";
import { Client, explain, isUnauthorized } from "./contract/client";
import type { KeySession } from "./contract/types";

export class Account {
  /** Part of the header: the name of the key that is signed in, and a button to sign out. */
  readonly element = h("div", { class: "account", hidden: true });
  readonly dialog: HTMLDialogElement;
  private readonly client = new Client();
  private readonly input = h("input", { type: "password", id: uniqueId("key"), required: true, autocomplete: "current-password", spellcheck: "false" });
  private readonly problem = h("p", { class: "problem", role: "alert" });
  private readonly submit = h("button", { type: "submit", class: "button primary" }, "Sign in");
  private resolvers: (() => void)[] = [];

  constructor() {
    const heading = h("h2", { id: uniqueId("sign-in") }, "Sign in");
    const form = h("form", {
      onsubmit: (event: Event) => {
        event.preventDefault();
        void this.signIn();
      },
    }, heading, h("p", {}, "This server answers holders of a key. Whoever runs it makes one with supple-server keys add."), h("label", { for: this.input.id }, "Key"), this.input,
      this.problem, this.submit);
    this.dialog = h("dialog", { class: "sign-in", "aria-labelledby": heading.id, oncancel: (event: Event) => event.preventDefault() }, form);
  }

  /** Opens the dialog, if it is closed, and resolves when the server has accepted a key. All callers wait for the same dialog. */
  ask(): Promise<void> {
    return new Promise((resolve) => {
      this.resolvers.push(resolve);
      if (!this.dialog.open) this.dialog.showModal();
    });
  }

  /** Asks the server which key is signed in, and shows it. */
  async checkSession(): Promise<void> {
    const session = await this.client.get<KeySession>("/v1/session").catch(() => null); // the session has ended, or the server does not answer
    if (session) this.show(session);
  }

  private async signIn(): Promise<void> {
    this.submit.disabled = true;
    this.problem.textContent = "";
    try {
      this.show(await this.client.post<KeySession>("/v1/session", { key: this.input.value.trim() }));
      this.input.value = "";
      this.dialog.close();
      for (const resolve of this.resolvers.splice(0)) resolve();
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
    location.reload(); // the page shows data of this key
  }
}
