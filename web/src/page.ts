// The parts of the page that are plain HTML.

import { MODES, type Mode, type Scale, gradient } from "./colours";
import type { Cone, Surface, UvMap } from "./data";

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no ${id}`);
  return found as T;
}

export function make(name: string, text = "", className = ""): HTMLElement {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

/** A number with its noun. */
export function counted(n: number, one: string, many: string): string {
  return `${n.toLocaleString("en")} ${n === 1 ? one : many}`;
}

export function about(surface: Surface): void {
  const { vertices, faces, components, genus, boundary_loops } = surface.topology;
  const parts = [counted(vertices, "vertex", "vertices"), counted(faces, "triangle", "triangles")];
  if (surface.refined) parts[1] += `, refined to ${counted(surface.points.length / 3, "vertex", "vertices")}, ${counted(surface.triangles.length / 3, "triangle", "triangles")}`;
  if (components > 1) parts.push(`${components} parts`);
  if (genus) parts.push(`genus ${genus}`);
  if (boundary_loops) parts.push(counted(boundary_loops, "boundary loop", "boundary loops"));
  byId("name").textContent = byId("name").title = surface.name;
  document.title = `${surface.name} – cones`;
  byId("about").textContent = parts.join(", ");
}

export function modeButtons(choose: (mode: Mode) => void): (mode: Mode) => void {
  const buttons = MODES.map(([mode, name]) => {
    const button = make("button", name) as HTMLButtonElement;
    button.type = "button";
    button.dataset.mode = mode;
    button.addEventListener("click", () => choose(mode));
    return button;
  });
  byId("colours").append(...buttons);
  return (mode) => buttons.forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.mode === mode)));
}

export function legend(mode: Mode, scale: Scale | null, islands: number | null): void {
  const place = byId("scale");
  place.title = scale?.title ?? "";
  if (!scale) {
    const count = islands === null ? "" : islands === 1 ? "1 island" : `${islands} islands, a colour each in turn`;
    const words = { checker: "squares keep their angles; their size shows the scale", islands: count };
    place.replaceChildren(make("span", words[mode as "checker"] ?? ""));
    return;
  }
  const ramp = make("div", "", "ramp");
  const bar = make("i");
  bar.style.background = gradient(scale.ramp);
  ramp.append(bar);
  for (const [at, text] of scale.marks) {
    const mark = make("b", text);
    mark.style.left = `${Math.min(96, Math.max(4, 100 * at))}%`;
    ramp.append(mark);
  }
  place.replaceChildren(ramp, make("span", scale.title));
}

/** What is known of a map: the same rows whatever that is, so that nothing moves. */
export function numbers(map: UvMap | null, predicted: number | null): void {
  const measured = map?.measured?.meta;
  const { fill = NaN, tiles = 1, times = {} } = (measured && map?.meta) || {};
  const { area_mean, quasi_conformal, flipped, overlap_pairs, seam_length, curvature_error } = measured?.distortion ?? {};
  const told = (value: number | null | undefined, digits: number) => value?.toFixed(digits) ?? "–";
  const seconds = Object.values(times).reduce<number>((sum, time) => sum + (time ?? 0), 0);
  const rows: [string, string][] = [
    ["Area distortion, predicted", told(predicted, 3)],
    ["Area distortion, measured", told(area_mean, 3)],
    ["Quasi-conformal, mean", told(quasi_conformal?.mean, 4)],
    ["Quasi-conformal, 99 %", told(quasi_conformal?.p99, 3)],
    ["Flipped; overlapping pairs", measured ? `${flipped}; ${overlap_pairs}` : "–"],
    ["Islands", told(measured?.islands, 0)],
    ["Seams, over √area", told(seam_length, 2)],
    [tiles > 1 ? `Filled, of ${tiles} tiles` : "Filled", measured ? `${(100 * fill).toFixed(0)} %` : "–"],
    ["Curvature off the cones", curvature_error == null ? "–" : `${curvature_error.toExponential(0)} rad`],
    ["Time", measured ? `${seconds.toFixed(2)} s` : "–"],
  ];
  const table = byId<HTMLTableElement>("numbers");
  while (table.rows.length < rows.length) table.append(make("tr"));
  rows.forEach((row, k) => row.forEach((text, i) => {
    const cell = table.rows[k].cells[i] ?? table.rows[k].appendChild(make("td"));
    // What is the same is not painted again.
    if (cell.textContent !== text) cell.textContent = text;
  }));
}

export function warnings(sentences: string[]): void {
  byId("warnings").replaceChildren(...sentences.map((sentence) => make("li", sentence)));
}

export function coneList(cones: Cone[], selected: number | null, name: (vertex: number) => number, select: (k: number) => void): void {
  listRows(cones.map(({ vertex, curvature }, k) => {
    const row = make("li");
    const button = make("button") as HTMLButtonElement;
    button.type = "button";
    button.dataset.vertex = String(vertex);
    button.setAttribute("aria-pressed", String(k === selected));
    button.append(make("span", `vertex ${name(vertex)}`), make("span", turns(curvature), curvature < 0 ? "negative" : "positive"));
    button.addEventListener("click", () => select(k));
    row.append(button);
    return row;
  }));
}

/** The rows of the list, each with a button of a vertex: whoever goes through them by keys stays where they are. */
export function listRows(rows: HTMLElement[]): void {
  const focused = (document.activeElement as HTMLElement | null)?.dataset.vertex;
  byId("cones").replaceChildren(...rows);
  if (focused !== undefined) byId("cones").querySelector<HTMLElement>(`[data-vertex="${focused}"]`)?.focus({ preventScroll: true });
}

/** A curvature as a multiple of π. */
export function turns(curvature: number): string {
  return Number.isNaN(curvature) ? "…" : `${(curvature / Math.PI).toFixed(3)} π`;
}

export function status(text: string, how: "" | "busy" | "failed" = ""): void {
  const state = byId("state");
  if (state.textContent !== text) state.textContent = state.title = text;
  state.className = how;
}

/** Says why another number was taken than was typed. */
export function bound(text: string): void {
  const place = byId("bound");
  place.hidden = !text;
  place.textContent = text;
}

/** How what a click does is used. */
export function hint(text: string): void {
  byId("hint").textContent = text;
}

export function message(view: HTMLElement, text: string): void {
  const place = view.querySelector<HTMLElement>(".message")!;
  place.hidden = !text;
  place.textContent = text;
}

export function save(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** The theme that the user has chosen, else the system's. */
export function theme(changed: (isDark: boolean) => void): void {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : dark.matches);
  dark.addEventListener("change", () => changed(isDark()));
  byId("theme").addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    changed(isDark());
  });
  changed(isDark());
}

/** The cones of a file of lines `vertex curvature` or `vertex`. */
export function readCones(text: string): [number, number | null][] {
  const cones = text.split("\n").map((line) => line.split("#")[0].trim()).filter(Boolean).map((line): [number, number | null] => {
    const words = line.split(/\s+/);
    const [vertex, curvature] = [Number(words[0]), words.length > 1 ? Number(words[1]) : null];
    if (!Number.isInteger(vertex) || vertex < 0 || words.length > 2 || Number.isNaN(curvature)) throw new Error(`no cone: ${line.slice(0, 60)}`);
    return [vertex, curvature];
  });
  const vertices = cones.map(([vertex]) => vertex);
  const twice = vertices.find((vertex, k) => vertices.indexOf(vertex) < k);
  if (twice !== undefined) throw new Error(`the file lists cone ${twice} twice`);
  return cones;
}
