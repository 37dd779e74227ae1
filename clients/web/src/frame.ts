// The frame around every page: name, navigation, theme, and a message while the connection is lost.
import { announce } from "./base/announce";
import { button } from "./base/controls";
import { h } from "./base/dom";
import { icon, type IconName } from "./base/icons";
import { nextTheme, type Theme, theme } from "./base/theme";
import type { Connection } from "./contract/connection";
import { helpMenu } from "./help_menu";
import { type PageEntry, PAGES } from "./pages";

const THEME_WORDS: Record<Theme, [IconName, string]> = {
  system: ["half", "Colours: as the system"],
  light: ["sun", "Colours: light"],
  dark: ["moon", "Colours: dark"],
};

export interface Frame {
  element: HTMLElement;
  main: HTMLElement;
  /** Marks a page as the visible one in the navigation. */
  select(entry: PageEntry): void;
}

/** `account` shows the key that is signed in, `bill` the last computations of the visible page, `tray` the jobs. */
export function frame(connection: Connection, account: HTMLElement, bill: HTMLElement, tray: HTMLElement): Frame {
  const main = h("main", { id: "main", tabindex: -1 });
  const links = PAGES.map((page) => h("a", { href: `#/${page.id}` }, page.title));
  const switcher = button("", nextTheme, { kind: "quiet", title: "Colours" });
  theme.watch((choice) => {
    const [name, words] = THEME_WORDS[choice];
    switcher.replaceChildren(icon(name));
    switcher.title = words;
    switcher.setAttribute("aria-label", words);
  });
  const lost = h("div", { class: "lost", role: "alert", hidden: true });
  connection.lost.watch((isLost) => {
    if (!isLost && !lost.hidden) announce("The server answers again.");
    lost.hidden = !isLost;
    lost.textContent = isLost ? "The server does not answer. Trying again; nothing of yours is lost." : "";
  });
  const skip = h("a", {
    class: "skip",
    href: "#main",
    onclick: (event: Event) => {
      event.preventDefault();
      main.focus();
    },
  }, "Skip to the content");
  const element = h(
    "div",
    { class: "frame" },
    skip,
    h("header", {}, h("a", { class: "brand", href: "#/design" }, h("img", { src: "./favicon.svg", alt: "", width: 28, height: 28 }), h("span", { class: "brand-name" }, "Supple")),
      h("nav", { "aria-label": "Pages" }, ...links), tray, bill, helpMenu(), account, switcher),
    lost,
    main,
  );
  return {
    element,
    main,
    select(entry) {
      document.title = `${entry.title} – Supple`;
      links.forEach((link, k) => {
        if (PAGES[k] === entry) link.setAttribute("aria-current", "page");
        else link.removeAttribute("aria-current");
      });
    },
  };
}
