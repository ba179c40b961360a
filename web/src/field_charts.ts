// The pairs of a field: how components merge, how long each lasts, and the diagram of both ends.

import { Chart, DIGIT, element } from "./charts";
import type { Direction, Pair } from "./field_data";
import { rounded, writer } from "./field_numbers";

/** So many branches or bars are drawn, the most persistent. */
const MOST = 200;

/** What all three show: a direction, how many of its pairs stand out, in which colours, where a vertex is said to be, and what a click on a pair does. */
abstract class PairChart extends Chart {
  protected direction: Direction | null = null;
  protected count = 0;
  protected selected: number | null = null;

  private readonly write: (value: number) => string;

  constructor(place: HTMLElement, label: string, protected readonly range: [number, number], protected readonly colour: (k: number) => string, private readonly placeOf: (vertex: number) => string, choose: (k: number) => void) {
    super(place, label);
    this.write = writer(range);
    // Values may have many digits, none of which may be cut off: they would be other numbers.
    this.frame.left = Math.max(this.frame.left, 10 + DIGIT * Math.max(...this.ticks().map(([, text]) => text.length)));
    place.addEventListener("click", (event) => {
      const k = (event.target as Element).closest("[data-pair]")?.getAttribute("data-pair");
      if (k) choose(Number(k));
    });
  }

  show(direction: Direction, count: number, selected: number | null): void {
    [this.direction, this.count, this.selected] = [direction, count, selected];
    this.draw();
  }

  protected share(value: number): number {
    const [low, high] = this.range;
    // What is infinite lies at the end that it is beyond.
    return high > low ? (Math.min(high, Math.max(low, value)) - low) / (high - low) : 0.5;
  }

  /** Where a component ends: that of a class that never does, at the other end of the values. */
  protected death({ death }: Pair): number {
    return death ?? this.range[this.direction!.kind === "minimum" ? 1 : 0];
  }

  protected pair(name: string, k: number, attributes: Record<string, string | number>): SVGElement {
    const pair = this.direction!.pairs[k];
    const made = element(name, { "data-pair": k, ...attributes });
    made.append(element("title", {}, `${this.direction!.kind} at ${this.placeOf(pair.extremum)}: ${this.write(pair.birth)} to ${pair.death === null ? "the end" : this.write(pair.death)}, persistence ${this.write(pair.persistence)}`));
    return made;
  }

  protected strength(k: number): Record<string, string | number> {
    const isThere = k < this.count;
    return { stroke: isThere ? this.colour(k) : "var(--quiet)", "stroke-opacity": isThere ? 1 : 0.35, "stroke-width": k === this.selected ? 5 : isThere ? 2.5 : 1 };
  }

  /** The ends of the range, and the middle where there is room for it. */
  protected ticks(): [number, string][] {
    const [low, high] = this.range;
    const written = (value: number): [number, string] => [value, this.write(rounded(value, this.range))];
    return (high > low ? [low, high, 0.5 * (low + high)] : [low]).map(written);
  }
}

/** The merge tree: a branch for each extremum, from where it is born to where it joins its parent. */
export class TreeChart extends PairChart {
  protected fill(svg: SVGElement): void {
    const { width, height, left, bottom } = this.frame;
    const { pairs } = this.direction!;
    const shown = Math.min(MOST, pairs.length);
    const y = (value: number) => height - bottom - 6 - (height - bottom - 20) * this.share(value);
    this.axes(svg, [], this.ticks().map(([value, text]) => [y(value), text]));
    const order = sideBySide(pairs.slice(0, shown));
    const step = (width - left - 24) / Math.max(1, shown);
    const x = (k: number) => left + 12 + step * (order[k] + 0.5);
    for (let k = shown - 1; k >= 0; k--) {
      const pair = pairs[k];
      const [from, to] = [y(pair.birth), y(this.death(pair))];
      const across = pair.parent === null ? "" : `H${x(pair.parent)}`;
      svg.append(this.pair("path", k, { d: `M${x(k)} ${from}V${to}${across}`, fill: "none", "stroke-linejoin": "round", ...this.strength(k) }));
      if (k < this.count) svg.append(this.pair("circle", k, { cx: x(k), cy: from, r: k === this.selected ? 6 : 4, fill: this.colour(k) }));
    }
  }
}

/** A bar for each pair, from birth to death. */
export class BarcodeChart extends PairChart {
  protected fill(svg: SVGElement): void {
    const { width, height, left, bottom } = this.frame;
    const { pairs } = this.direction!;
    const shown = Math.min(MOST, pairs.length, Math.max(8, 2 * this.count));
    const x = (value: number) => left + (width - left - 10) * this.share(value);
    this.axes(svg, this.ticks().map(([value, text]) => [x(value), text]), []);
    const step = Math.min(12, (height - bottom - 10) / Math.max(1, shown));
    for (let k = 0; k < shown; k++) {
      const y = 6 + step * (k + 0.5);
      const thick = { "stroke-width": Math.max(1, 0.7 * step) };
      svg.append(this.pair("line", k, { x1: x(pairs[k].birth), x2: x(this.death(pairs[k])), y1: y, y2: y, ...this.strength(k), ...thick }));
    }
  }
}

/** Birth to the right, death up. */
export class PairDiagram extends PairChart {
  protected fill(svg: SVGElement): void {
    const { width, height, left, bottom } = this.frame;
    const x = (value: number) => left + 6 + (width - left - 16) * this.share(value);
    const y = (value: number) => height - bottom - 4 - (height - bottom - 14) * this.share(value);
    const ticks = this.ticks();
    this.axes(svg, ticks.map(([value, text]) => [x(value), text]), ticks.map(([value, text]) => [y(value), text]));
    const [low, high] = this.range;
    svg.append(element("line", { x1: x(low), y1: y(low), x2: x(high), y2: y(high), stroke: "var(--line)", "stroke-width": 1.5 }));
    this.direction!.pairs.forEach((pair, k) => {
      const isThere = k < this.count;
      svg.append(this.pair("circle", k, {
        cx: x(pair.birth), cy: y(this.death(pair)), r: k === this.selected ? 7 : isThere ? 4.5 : 2,
        fill: isThere ? this.colour(k) : "var(--quiet)", "fill-opacity": isThere ? 1 : 0.4,
      }));
    });
  }
}

/** Places beside each other so that branches do not cross: each stands to the right of its parent's later children. */
function sideBySide(pairs: Pair[]): number[] {
  const children = pairs.map((): number[] => []);
  const roots: number[] = [];
  pairs.forEach(({ parent }, k) => (parent === null || parent >= pairs.length ? roots : children[parent]).push(k));
  // What joins first stands nearest.
  const late = (k: number) => Math.abs((pairs[k].death ?? Infinity) - pairs[pairs[k].parent ?? k].birth);
  children.forEach((row) => row.sort((a, b) => late(a) - late(b)));
  const place = new Array<number>(pairs.length).fill(0);
  let next = 0;
  const waiting = roots.reverse();
  for (let k = waiting.pop(); k !== undefined; k = waiting.pop()) {
    place[k] = next++;
    waiting.push(...children[k].slice().reverse());
  }
  return place;
}
