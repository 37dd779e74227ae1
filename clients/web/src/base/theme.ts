// The colour theme: light, dark, or the system's.
import { Observable } from "./observable";

export type Theme = "system" | "light" | "dark";
const KEY = "supple-theme";
const ORDER: Theme[] = ["system", "light", "dark"];

function stored(): Theme {
  try {
    const value = localStorage.getItem(KEY);
    return ORDER.find((theme) => theme === value) ?? "system";
  } catch {
    return "system"; // storage is blocked: the choice lasts as long as the page
  }
}

export const theme = new Observable<Theme>(stored());

/** Whether the page is dark now. */
export const dark = new Observable(false);

export function startTheme(): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const apply = () => {
    const choice = theme.get();
    const isDark = choice === "dark" || (choice === "system" && system.matches);
    document.documentElement.dataset.theme = isDark ? "dark" : "light";
    dark.set(isDark);
  };
  theme.watch((choice) => {
    try {
      localStorage.setItem(KEY, choice);
    } catch {
      // storage is blocked
    }
    apply();
  });
  system.addEventListener("change", apply);
}

export function nextTheme(): void {
  theme.set(ORDER[(ORDER.indexOf(theme.get()) + 1) % ORDER.length]);
}
