// A field on a mesh or an array with its extrema: what belongs to which, at every level of persistence.

import { css, gradient, sample } from "./colours";
import type { Container, Surface } from "./data";
import { BarcodeChart, PairDiagram, TreeChart } from "./field_charts";
import { type Direction, type Field, NONE, readField } from "./field_data";
import { rounded, writer } from "./field_numbers";
import { FieldPicture } from "./field_picture";
import { vertexOf } from "./geometry";
import * as page from "./page";
import { byId, make } from "./page";
import { onClick, webGl } from "./stage";
import { SurfaceView } from "./surface_view";

type Colour = [number, number, number];

const RAMP: Colour[] = [[0x24, 0x3f, 0xb5], [0x5b, 0xa3, 0xe6], [0xf3, 0xf2, 0xec], [0xf2, 0xa0, 0x5a], [0xb8, 0x1d, 0x24]];
const NOTHING: Colour = [0x8a, 0x90, 0x9c];
/** As many extrema as are shown at first. */
const BEGIN = 8;
/** So many rows of the list. */
const ROWS = 64;

export class FieldApp {
  private readonly field: Field;
  private readonly view: SurfaceView | null = null;
  private readonly picture: FieldPicture | null = null;
  private readonly tree: TreeChart;
  private readonly barcode: BarcodeChart;
  private readonly diagram: PairDiagram;
  private readonly write: (value: number) => string;
  private readonly ramp = Array.from({ length: 256 }, (_, k) => sample(RAMP, (k - 1) / 254));
  private mode: "values" | "segments" = "segments";
  private at: number;
  private level = 0;
  private layer = 0;
  private selected: number | null = null;

  constructor(data: Container) {
    this.field = readField(data);
    const { field } = this;
    this.write = writer(field.range);
    document.body.classList.add("field", "file");
    this.at = field.directions.length - 1;
    this.arrange();
    const canvas = byId("surface").querySelector("canvas")!;
    if (field.kind === "mesh" && webGl(canvas, false)) this.view = new SurfaceView(byId("surface"), canvas, this.surface());
    else if (field.kind === "array") this.picture = new FieldPicture(byId("surface"), canvas, field);
    else page.message(byId("surface"), field.kind === "mesh" ? "This browser has no WebGL, so the surface cannot be shown." : "A network's nodes are nowhere in space. Its tree and its pairs are here.");
    const colour = (k: number) => css(segmentColour(k));
    const choose = (k: number) => this.select(k);
    const label = (what: string) => `${what} of the field`;
    const place = (vertex: number) => this.placeOf(vertex);
    this.tree = new TreeChart(byId("tree"), label("Merge tree"), field.range, colour, place, choose);
    this.barcode = new BarcodeChart(byId("curve"), label("Barcode"), field.range, colour, place, choose);
    this.diagram = new PairDiagram(byId("diagram"), label("Persistence diagram"), field.range, colour, place, choose);
    this.showDirection();
    this.listen();
    page.theme(() => this.show());
    byId("surface").querySelector<HTMLElement>(".tools")!.hidden = !this.view;
    page.status(this.view ? "drag to turn; click an extremum anywhere" : "click an extremum anywhere");
    document.body.dataset.maps = "1";
  }

  /** Parts of the page that are not a map's. */
  private arrange(): void {
    const { field } = this;
    page.byId("name").textContent = document.title = field.name;
    const count = field.kind === "array" ? `array of ${field.shape!.filter((n, k) => n > 1 || k === 2).join(" × ")}` : field.kind === "mesh" ? "mesh" : "network";
    byId("about").textContent = `${count}, values from ${this.write(field.range[0])} to ${this.write(field.range[1])}`;
    byId("atlas").replaceChildren(Object.assign(make("div"), { id: "tree" }));
    byId("atlas").setAttribute("aria-label", "Merge tree");
    const buttons = (["segments", "values"] as const).map((mode) => {
      const button = make("button", mode === "values" ? "Values" : "Segments") as HTMLButtonElement;
      button.type = "button";
      button.dataset.mode = mode;
      button.addEventListener("click", () => this.colour(mode));
      return button;
    });
    byId("colours").append(...buttons);
    // Of a network nothing is drawn that could be coloured.
    byId("colours").hidden = byId("scale").hidden = field.kind === "network";
    const direction = document.createElement("select");
    direction.id = "direction";
    direction.append(...field.directions.map(({ kind }, k) => new Option(kind === "minimum" ? "minima" : "maxima", String(k))));
    direction.value = String(this.at);
    const label = make("label", "Extrema ");
    label.append(direction);
    const layers = make("label", "Layer ");
    layers.hidden = field.kind !== "array" || field.shape![0] === 1;
    layers.append(Object.assign(document.createElement("input"), { id: "layer", type: "range", min: "0", max: String((field.shape?.[0] ?? 1) - 1), value: "0" }), make("b", "0"));
    byId("controls").replaceChildren(byId("number"), make("output", "", "quiet"), label, layers);
    const isOne = field.directions.every(({ pairs }) => pairs.filter(({ death }) => death === null).length < 2);
    const order = isOne ? "Extrema, the most persistent first" : "Extrema: those that never end, then the most persistent";
    const titles = ["Barcode", "Persistence diagram", "This extremum", order];
    document.querySelectorAll("figcaption").forEach((caption, k) => (caption.textContent = titles[k]));
    byId("add").remove();
  }

  /** The mesh as the surface's view has it. */
  private surface(): Surface {
    const { points, triangles, name } = this.field;
    return {
      name, points: points!, triangles: triangles!, factor: new Float32Array(), vertex: null, usable: null, refined: false, least: 0, most: 0, methods: [], warnings: [],
      chosen: { n: null, method: "", angles: "" }, topology: { vertices: 0, faces: 0, components: 1, boundary_loops: 0, genus: 0 },
    };
  }

  private get direction(): Direction {
    return this.field.directions[this.at];
  }

  private listen(): void {
    const input = (id: string) => byId<HTMLInputElement>(id);
    input("slider").addEventListener("input", () => this.go(Number(input("slider").value)));
    input("count").addEventListener("change", () => this.type(input("count").valueAsNumber));
    byId("direction").addEventListener("change", () => {
      this.at = Number(byId<HTMLSelectElement>("direction").value);
      this.showDirection();
    });
    input("layer").addEventListener("input", () => {
      this.layer = Number(input("layer").value);
      this.show();
    });
    const canvas = byId("surface").querySelector("canvas")!;
    const under = (event: PointerEvent): number | null => {
      const place = this.view?.under(event);
      return this.view ? (place ? vertexOf(this.surface(), place) : null) : (this.picture?.under(event) ?? null);
    };
    canvas.addEventListener("pointermove", (event) => event.buttons || this.tell(under(event)));
    canvas.addEventListener("pointerleave", () => this.tell(null));
    onClick(canvas, (event) => {
      const at = under(event);
      this.select(at === null ? null : this.segment(at));
    });
    byId("surface").querySelector(".fit")!.addEventListener("click", () => this.view?.fit());
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.select(null);
      else if (event.key === "f" && event.target === document.body) this.view?.fit();
    });
  }

  private showDirection(): void {
    const { levels } = this.direction;
    const slider = byId<HTMLInputElement>("slider");
    [slider.min, slider.max] = ["0", String(levels.length - 1)];
    const count = byId<HTMLInputElement>("count");
    [count.min, count.max] = [levels[0].n, levels[levels.length - 1].n].map(String);
    byId("number").querySelector("span")!.textContent = this.direction.kind === "minimum" ? "Minima" : "Maxima";
    this.selected = null;
    this.go(this.nearest(BEGIN));
  }

  /** The level with so many extrema, or the last with fewer. */
  private nearest(count: number): number {
    return Math.max(0, this.direction.levels.findLastIndex(({ n }) => n <= count));
  }

  /** Goes to a number that was typed, or says why to another. */
  private type(asked: number): void {
    if (Number.isNaN(asked)) return this.show();
    const { levels } = this.direction;
    const level = this.nearest(asked);
    this.go(level);
    const [least, { n }, next] = [levels[0].n, levels[level], levels[level + 1]];
    if (asked < least) page.bound(`${least} at least are there`);
    else if (asked > n) page.bound(next ? `the page shows ${n} or ${next.n}, nothing between` : `the page shows ${n} at most`);
  }

  private go(level: number): void {
    page.bound("");
    this.level = level;
    if (this.selected !== null && this.selected >= this.count()) this.selected = null;
    this.show();
  }

  private colour(mode: "values" | "segments"): void {
    this.mode = mode;
    this.show();
  }

  private count(): number {
    return Math.min(this.direction.levels[this.level].n, this.direction.pairs.length);
  }

  /** The pair that a vertex belongs to, by its place among those that are shown. */
  private segment(at: number): number | null {
    const basin = this.direction.basins[at];
    const pair = basin === undefined || basin === NONE ? NONE : this.direction.survivors[this.level][basin];
    return pair === NONE ? null : pair;
  }

  /** The extremum, chosen; of an array its layer is shown. */
  private select(k: number | null): void {
    this.selected = k;
    const { shape, first, kind } = this.field;
    if (k !== null && kind === "array" && shape![0] > 1) {
      const layer = Math.floor((this.direction.pairs[k].extremum - first) / (shape![1] * shape![2]));
      if (layer >= 0 && layer < shape![0]) this.layer = layer;
    }
    this.show();
  }

  private show(): void {
    const { direction, field } = this;
    const { n, threshold } = direction.levels[this.level];
    byId<HTMLInputElement>("slider").value = String(this.level);
    byId<HTMLInputElement>("count").value = String(n);
    byId<HTMLInputElement>("layer").value = String(this.layer);
    byId("layer").nextElementSibling!.textContent = String(this.layer);
    byId("controls").querySelector("output")!.textContent = `of ${direction.all.toLocaleString("en")}, more persistent than ${this.write(threshold)}`;
    const colour = (at: number) => this.colourOf(at);
    const ids = Array.from({ length: this.count() }, (_, k) => k);
    this.picture?.show(this.layer, colour, ids.map((k) => ({ vertex: direction.pairs[k].extremum, colour: direction.kind === "minimum" ? "#1f5fd0" : "#d62728", isSelected: k === this.selected })));
    if (this.view) {
      this.view.colour("tint", atCorners(field.triangles!, field.values.length, colour));
      const sign = direction.kind === "minimum" ? 1 : -1;
      this.view.showCones(ids.map((k) => ({ vertex: direction.pairs[k].extremum, curvature: sign })), this.selected);
    }
    document.querySelectorAll<HTMLElement>("#colours button").forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.mode === this.mode)));
    this.showLegend();
    for (const chart of [this.tree, this.barcode, this.diagram]) chart.show(direction, this.count(), this.selected);
    this.showNumbers();
    this.showList();
  }

  private colourOf(at: number): Colour {
    const value = this.field.values[at];
    if (!value) return NOTHING;
    if (this.mode === "values") return this.ramp[value];
    const k = this.segment(at);
    if (k === null) return NOTHING;
    const light = 0.55 + (0.45 * value) / 255;
    const colour = segmentColour(k).map((c) => Math.round(c * light)) as Colour;
    return this.selected === null || this.selected === k ? colour : (colour.map((c) => Math.round(0.35 * c + 0.65 * 0xd0)) as Colour);
  }

  private showLegend(): void {
    const place = byId("scale");
    if (this.mode === "segments") {
      place.replaceChildren(make("span", "a colour for what belongs to each extremum"));
      return;
    }
    const ramp = make("div", "", "ramp");
    const bar = make("i");
    bar.style.background = gradient(RAMP);
    const marks = this.field.range.map((value, k) => Object.assign(make("b", this.write(value)), { className: k ? "high" : "low" }));
    ramp.append(bar, ...marks);
    ramp.style.minWidth = `${2 + marks.reduce((sum, mark) => sum + mark.textContent!.length, 0)}ch`;
    place.replaceChildren(ramp, make("span", "value"));
  }

  private showNumbers(): void {
    const k = this.selected;
    const pair = k === null ? null : this.direction.pairs[k];
    const rows: [string, string][] = pair
      ? [
        [this.direction.kind === "minimum" ? "Minimum at" : "Maximum at", this.placeOf(pair.extremum)],
        ["Value, birth", this.write(pair.birth)],
        ["Saddle at", pair.saddle === null ? "none: it never ends" : this.placeOf(pair.saddle)],
        ["Value there, death", pair.death === null ? "–" : this.write(pair.death)],
        [pair.death === null ? "Persistence: the range of its part" : "Persistence", this.write(pair.persistence)],
        ["Joins", pair.parent === null ? "–" : this.placeOf(this.direction.pairs[pair.parent].extremum)],
      ]
      : [["Click an extremum, a branch, a bar or a segment", ""]];
    byId("numbers").replaceChildren(...rows.map(([name, value]) => {
      const row = make("tr");
      row.append(make("td", name), make("td", value));
      return row;
    }));
  }

  private showList(): void {
    const rows = this.direction.pairs.slice(0, Math.min(ROWS, this.count())).map((pair, k) => {
      const row = make("li");
      const button = make("button") as HTMLButtonElement;
      button.type = "button";
      button.dataset.vertex = String(pair.extremum);
      button.setAttribute("aria-pressed", String(k === this.selected));
      const name = make("span", this.placeOf(pair.extremum));
      name.style.borderLeft = `.7rem solid ${css(segmentColour(k))}`;
      name.style.paddingLeft = ".4rem";
      button.append(name, make("span", this.write(pair.persistence)));
      button.addEventListener("click", () => this.select(k));
      row.append(button);
      return row;
    });
    page.listRows(rows);
  }

  /** A vertex as people look for it: a network's node by its name, of an array the indices, the slowest first. */
  private placeOf(vertex: number): string {
    const { shape, kind, names } = this.field;
    if (names) return names[vertex];
    if (kind !== "array") return `vertex ${vertex}`;
    const [depth, rows, columns] = shape!;
    const layer = Math.floor(vertex / (rows * columns));
    const places = [Math.floor((vertex % (rows * columns)) / columns), vertex % columns];
    if (rows === 1 && depth === 1) return String(vertex);
    return (depth > 1 || layer > 0 ? [layer, ...places] : places).join(", ");
  }

  private tell(at: number | null): void {
    if (at === null) {
      byId("place").textContent = "";
      return;
    }
    const { range, values, first } = this.field;
    const value = values[at] ? this.write(rounded(range[0] + ((values[at] - 1) / 254) * (range[1] - range[0]), range)) : "none";
    const k = this.segment(at);
    const segment = k === null ? "" : `  ·  belongs to ${this.placeOf(this.direction.pairs[k].extremum)}`;
    byId("place").textContent = `${this.placeOf(first + at)}  ·  about ${value}${segment}`;
  }
}

/** The colours of vertices at the corners of triangles. */
function atCorners(triangles: Uint32Array, vertices: number, colour: (at: number) => Colour): Uint8Array {
  const known = new Uint8Array(3 * vertices);
  for (let at = 0; at < vertices; at++) known.set(colour(at), 3 * at);
  const tint = new Uint8Array(3 * triangles.length);
  for (let corner = 0; corner < triangles.length; corner++) {
    for (let i = 0; i < 3; i++) tint[3 * corner + i] = known[3 * triangles[corner] + i];
  }
  return tint;
}

/** A colour of its own for each pair: hues a golden section of the circle apart differ for long. */
function segmentColour(k: number): Colour {
  const turn = (k * 0.618034) % 1;
  const light = [0.95, 0.75, 0.6][k % 3];
  const channel = (shift: number) => {
    const distance = 6 * Math.abs(((turn + shift) % 1) - 0.5);
    return Math.round(255 * light * (0.35 + 0.65 * Math.min(1, Math.max(0, distance - 1))));
  };
  return [channel(0), channel(2 / 3), channel(1 / 3)];
}
