// The sentence below the view that says what clicks, drags and keys do.
import { h } from "../base/dom";
import { touchWords } from "../base/touch_words";
import type { MeshSessions } from "./sessions";

const SITES =
  "Click to add a site, drag one to move it; drag beside it to turn, scroll to come nearer. With the keyboard: arrows and + −; with Shift, arrows move the chosen site.";

export function viewHint(sessions: MeshSessions): HTMLElement {
  const { mesh, network } = sessions;
  const element = h("p", { class: "hint" });
  for (const part of [mesh.tool, network.state, network.mode, network.supportMode]) {
    part.watch(() => {
      element.textContent = touchWords(sessions.isVoronoiTool ? SITES : pointWords(sessions));
    });
  }
  return element;
}

function pointWords(sessions: MeshSessions): string {
  const canMoveSupports = sessions.hasSupports && sessions.network.state.get().host.supports.length > 0;
  const dragged = canMoveSupports ? "a support to move it, beside it " : sessions.isNetworkTool ? "" : "a point to move it, beside it ";
  const keys = canMoveSupports ? "; with Shift, arrows move the chosen support" : "";
  return `${clickWords(sessions)}, drag ${dragged}to turn, scroll to come nearer. With the keyboard: arrows and + −${keys}.`;
}

function clickWords({ network, isNetworkTool }: MeshSessions): string {
  if (isNetworkTool && network.supportMode.get()) return "Click to hold the nearest vertex or let it go";
  const arePicked = network.state.get().points === "picked";
  if (!isNetworkTool || (arePicked && network.mode.get() === "add")) return "Click to pick a point";
  return arePicked && network.mode.get() === "join" ? "Click on two points to join them" : "Click on a point to fix it or let it go";
}
