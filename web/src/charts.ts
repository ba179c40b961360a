// The two charts, as plain SVG.

import type { Extremum, ForeseenLevel } from "./data";
import { counted } from "./page";

const SPACE = "http://www.w3.org/2000/svg";

/** As wide are digits at most, in pixels. */
export const DIGIT = 7;

export function element(name: string, attributes: Record<string, string | number>, text?: string): SVGElement {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, String(value));
  if (text !== undefined) made.textContent = text;
  return made;
}

interface Frame {
  width: number;
  height: number;
  left: number;
  bottom: number;
}

/**
 * An empty chart as large as its place, again when that changes. What each choice changes lies on a sheet of its own above the rest, which
 * the browser keeps painted: without a graphics card the distortion curve and 1200 dots take it 33 ms a time.
 */
export abstract class Chart {
  protected frame: Frame = { width: 1, height: 1, left: 34, bottom: 18 };
  private readonly sheet = element("svg", { class: "marks", "aria-hidden": "true" });

  constructor(protected readonly place: HTMLElement, private readonly label: string) {
    // An observer also tells of the size that it begins with, which may be drawn already.
    new ResizeObserver(() => (place.clientWidth === this.frame.width && place.clientHeight === this.frame.height) || this.draw()).observe(place);
  }

  protected abstract fill(svg: SVGElement): void;

  /** What a choice changes. */
  protected marks(): SVGElement[] {
    return [];
  }

  protected draw(): void {
    const [width, height] = [this.place.clientWidth, this.place.clientHeight];
    this.frame = { ...this.frame, width, height };
    if (width < 40 || height < 40) return;
    const viewBox = `0 0 ${width} ${height}`;
    const svg = element("svg", { viewBox, role: "img", "aria-label": this.label });
    this.sheet.setAttribute("viewBox", viewBox);
    this.fill(svg);
    this.place.replaceChildren(svg, this.sheet);
    this.mark();
  }

  /** Draws the marks anew, and nothing else. */
  protected mark(): void {
    this.sheet.replaceChildren(...this.marks());
  }

  /** A line across at each mark of an axis. */
  protected axes(svg: SVGElement, x: [number, string][], y: [number, string][]): void {
    const { width, height, left, bottom } = this.frame;
    for (const [at, text] of y) {
      svg.append(element("line", { x1: left, x2: width - 4, y1: at, y2: at, stroke: "var(--line)" }));
      svg.append(element("text", { x: left - 5, y: at + 4, "text-anchor": "end" }, text));
    }
    // Numbers at the rim stay inside, and those that would lie over earlier ones are left out.
    const taken: [number, number][] = [];
    for (const [at, text] of x) {
      const half = 0.5 * DIGIT * text.length + 2;
      const middle = Math.max(half, Math.min(at, width - half));
      if (taken.some(([low, high]) => middle - half < high && low < middle + half)) continue;
      taken.push([middle - half, middle + half]);
      svg.append(element("text", { x: middle, y: height - bottom + 14, "text-anchor": "middle" }, text));
    }
  }
}

const FINDING = "being found …";

/** The predicted area distortion for every number of cones, and the measured one of the maps that were made. */
export class CurveChart extends Chart {
  private curve: ForeseenLevel[] = [];
  private isKnown = false;
  private measured = new Map<number, number>();
  private chosen = 0;
  private most = 64;
  /** What is drawn below the marks. */
  private drawn = "";

  constructor(place: HTMLElement, choose: (n: number) => void) {
    super(place, "Predicted area distortion for each number of cones; the slider chooses one");
    place.addEventListener("click", (event) => {
      const n = Math.round(this.number(event.clientX - place.getBoundingClientRect().left));
      choose(Math.min(this.most, Math.max(1, n)));
    });
    place.style.cursor = "crosshair";
  }

  /** The curve is none while it is being found. */
  show(curve: ForeseenLevel[] | null, measured: Map<number, number>, chosen: number, most: number): void {
    this.isKnown = curve !== null;
    this.curve = (curve ?? []).filter(({ n }) => n <= most);
    [this.measured, this.chosen, this.most] = [measured, chosen, most];
    const drawn = JSON.stringify([this.isKnown, this.curve.map(({ predicted_area }) => predicted_area), [...measured], most]);
    if (drawn !== this.drawn) this.draw();
    else this.mark();
    this.drawn = drawn;
  }

  private number(x: number): number {
    const { width, left } = this.frame;
    return ((x - left) / (width - left - 8)) * this.most;
  }

  /** The largest distortion in the frame, and where numbers and distortions are. */
  private places(): { top: number; x: (n: number) => number; y: (d: number) => number } {
    const { width, height, left, bottom } = this.frame;
    const values = [...this.curve.map((point) => point.predicted_area), ...this.measured.values()];
    const top = Math.min(10, Math.max(1.5, ...values));
    return {
      top,
      x: (n) => left + ((width - left - 8) * n) / this.most,
      y: (d) => height - bottom - ((height - bottom - 8) * Math.log(Math.min(top, Math.max(1, d)))) / Math.log(top),
    };
  }

  protected marks(): SVGElement[] {
    const { chosen, frame, measured } = this;
    const { x, y } = this.places();
    if (chosen > this.most) return [];
    const line = element("line", { x1: x(chosen), x2: x(chosen), y1: 4, y2: frame.height - frame.bottom, stroke: "var(--accent)", "stroke-dasharray": "3 3" });
    return measured.has(chosen) ? [line, this.dot(x(chosen), y(measured.get(chosen)!), 5, chosen)] : [line];
  }

  /** What was measured with so many cones. */
  private dot(cx: number, cy: number, r: number, n: number): SVGElement {
    const dot = element("circle", { cx, cy, r, fill: "var(--ink)" });
    dot.append(element("title", {}, `${counted(n, "cone", "cones")}: measured ${this.measured.get(n)!.toFixed(3)}`));
    return dot;
  }

  protected fill(svg: SVGElement): void {
    const { width, height } = this.frame;
    const { top, x, y } = this.places();
    const ticks = [1, 1.25, 1.5, 2, 3, 5, 10].filter((d) => d <= top * 1.001);
    const isRoomy = (d: number, k: number) => k === 0 || y(ticks[k - 1]) - y(d) > 13;
    const numbers = [1, 0.25, 0.5, 0.75].map((share, k) => (k ? Math.round(share * this.most) : this.most));
    this.axes(svg, numbers.map((n) => [x(n), String(n)]), ticks.filter(isRoomy).map((d) => [y(d), String(d)]));
    const points = this.curve.map(({ n, predicted_area }) => `${x(n)},${y(predicted_area)}`).join(" ");
    svg.append(element("polyline", { points, fill: "none", stroke: "var(--accent)", "stroke-width": 2 }));
    for (const [n, d] of this.measured) if (n <= this.most) svg.append(this.dot(x(n), y(d), 3, n));
    if (!this.curve.length) svg.append(element("text", { x: width / 2, y: height / 2, "text-anchor": "middle" }, this.isKnown ? "no cones to choose" : FINDING));
  }
}

/** So many pairs are drawn, the most persistent. */
const MOST = 1200;

/** The extrema of the conformal factor: where each begins, and where it ends. */
export class DiagramChart extends Chart {
  private extrema: Extremum[] | null = null;
  private chosen = new Set<number>();
  private at: (extremum: Extremum) => [number, number] = () => [0, 0];

  constructor(place: HTMLElement) {
    super(place, "Persistence diagram of the conformal factor: minima above the diagonal, maxima below, cones marked");
  }

  /** The extrema are none while they are being found. */
  show(extrema: Extremum[] | null, chosen: number[]): void {
    const isOther = extrema !== this.extrema;
    this.extrema = extrema;
    this.chosen = new Set(chosen);
    if (isOther || !this.place.firstChild) this.draw();
    else this.mark();
  }

  protected fill(svg: SVGElement): void {
    const { width, height, left, bottom } = this.frame;
    if (!this.extrema?.length) {
      svg.append(element("text", { x: width / 2, y: height / 2, "text-anchor": "middle" }, this.extrema ? "φ has no extrema" : FINDING));
      return;
    }
    const end = ({ kind, value, persistence }: Extremum) => value + (kind === "minimum" ? persistence : -persistence);
    const values = this.extrema.slice(0, MOST).flatMap((extremum) => [extremum.value, end(extremum)]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const share = (value: number) => (high > low ? (value - low) / (high - low) : 0.5);
    const x = (value: number) => left + 6 + (width - left - 16) * share(value);
    const y = (value: number) => height - bottom - 4 - (height - bottom - 14) * share(value);
    this.at = (extremum) => [x(extremum.value), y(end(extremum))];
    // What rounds to nothing has no sign, and what rounds to the same one mark.
    const digits = high - low < 0.5 ? 2 : 1;
    const mark = (value: number) => (Number(value.toFixed(digits)) || 0).toFixed(digits);
    const ends = mark(low) === mark(high) ? [low] : [low, high];
    this.axes(svg, ends.map((v) => [x(v), mark(v)]), ends.map((v) => [y(v), mark(v)]));
    svg.append(element("line", { x1: x(low), y1: y(low), x2: x(high), y2: y(high), stroke: "var(--line)", "stroke-width": 1.5 }));
    for (const extremum of this.extrema.slice(0, MOST)) svg.append(this.dot(extremum, { r: 2, "fill-opacity": 0.35 }));
  }

  protected marks(): SVGElement[] {
    const chosen = (this.extrema ?? []).filter((extremum) => this.chosen.has(extremum.vertex));
    return chosen.map((extremum) => this.dot(extremum, { r: 5, stroke: "var(--ink)" }));
  }

  private dot(extremum: Extremum, how: Record<string, string | number>): SVGElement {
    const [cx, cy] = this.at(extremum);
    const dot = element("circle", { cx, cy, fill: extremum.kind === "minimum" ? "var(--positive)" : "var(--negative)", ...how });
    dot.append(element("title", {}, `${extremum.kind} at vertex ${extremum.vertex}: persistence ${extremum.persistence.toFixed(3)}`));
    return dot;
  }
}
