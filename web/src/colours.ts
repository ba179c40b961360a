// What surfaces are coloured by, and how a value becomes a colour.

import type { Surface, UvMap } from "./data";

export type Mode = "checker" | "area" | "stretch" | "factor" | "islands" | "plain";

export const MODES: [Mode, string][] = [
  ["checker", "Checker"],
  ["area", "Area distortion"],
  ["stretch", "Quasi-conformal"],
  ["factor", "Conformal factor"],
  ["islands", "Islands"],
  ["plain", "Plain"],
];

type Colour = [number, number, number];

/** Blue where areas shrink, white where they are kept, red where they grow, as in the paper's first figure. */
const DIVERGING: Colour[] = [[0x24, 0x3f, 0xb5], [0x5b, 0xa3, 0xe6], [0xf3, 0xf2, 0xec], [0xf2, 0xa0, 0x5a], [0xb8, 0x1d, 0x24]];
const GROWING: Colour[] = [[0xf3, 0xf2, 0xec], [0xf4, 0xc8, 0x6a], [0xdb, 0x5c, 0x5c], [0x7a, 0x1f, 0x6d]];
const ISLANDS: Colour[] = [
  [0x4c, 0x9a, 0xa8], [0x7f, 0xb0, 0x7a], [0x8d, 0x7f, 0xc4], [0xd0, 0xa5, 0x5c],
  [0x6b, 0x93, 0xd6], [0xc9, 0x8b, 0x8b], [0xb0, 0x7a, 0xb5], [0x7d, 0x8a, 0x99],
];
export const PLAIN: Colour = [0xc4, 0xcb, 0xd4];
export const CHECKER: [Colour, Colour] = [[0xf4, 0xf1, 0xea], [0x8f, 0xa6, 0xb8]];

/** A colour scale with the marks of its legend, from 0 to 1. */
export interface Scale {
  ramp: Colour[];
  /** From the value of a triangle's corner to 0 … 1. */
  place: (value: number) => number;
  marks: [number, string][];
  title: string;
}

const AREA = Math.log(10);
const STRETCH = Math.log(2);

export function scale(mode: Mode, surface: Surface): Scale | null {
  const log = (at: number, most: number) => Math.log(at) / most;
  switch (mode) {
    case "area":
      return {
        ramp: DIVERGING,
        place: (log) => 0.5 + (0.5 * log) / AREA,
        marks: [0.1, 0.3, 1, 3, 10].map((r) => [0.5 + 0.5 * log(r, AREA), String(r)]),
        title: "area on the map over area on the surface; ideal 1",
      };
    case "stretch":
      return {
        ramp: GROWING,
        place: (ratio) => Math.log(ratio) / STRETCH,
        marks: [1, 1.2, 1.5, 2].map((q) => [log(q, STRETCH), String(q)]),
        title: "longest over shortest stretch; ideal 1",
      };
    case "factor": {
      const most = percentile(surface.factor.map(Math.abs), 0.98) || 1;
      const marks: [number, string][] = [-1, 0, 1].map((k) => [0.5 + 0.5 * k, (k * most).toFixed(k ? 2 : 0)]);
      return { ramp: DIVERGING, place: (phi) => 0.5 + (0.5 * phi) / most, marks, title: "conformal factor φ, a log scale" };
    }
    default:
      return null;
  }
}

function percentile(values: Float32Array, share: number): number {
  return values.sort()[Math.floor(share * (values.length - 1))];
}

/** The colour of a scale at a place from 0 to 1, each channel from 0 to 255. */
export function sample(ramp: Colour[], place: number): Colour {
  const at = Math.min(Math.max(Number.isNaN(place) ? 1 : place, 0), 1) * (ramp.length - 1);
  const k = Math.min(Math.floor(at), ramp.length - 2);
  return [0, 1, 2].map((i) => Math.round(ramp[k][i] + (at - k) * (ramp[k + 1][i] - ramp[k][i]))) as Colour;
}

/** Red, green and blue of each corner of each triangle, from 0 to 255. */
export function cornerColours(mode: Mode, surface: Surface, map: UvMap | null): Uint8Array {
  const { triangles, factor } = surface;
  const colours = new Uint8Array(3 * triangles.length);
  const found = scale(mode, surface);
  const table = found && Array.from({ length: 256 }, (_, k) => sample(found.ramp, k / 255));
  const of = (corner: number): Colour => {
    const t = Math.floor(corner / 3);
    if (mode === "islands" && map) return ISLANDS[map.island[t] % ISLANDS.length];
    if (!found || !table || (!map?.measured && mode !== "factor")) return PLAIN;
    const value = mode === "factor" ? factor[triangles[corner]] : mode === "area" ? map!.measured!.logArea[t] : map!.measured!.stretch[t];
    return table[Math.round(255 * Math.min(Math.max(found.place(value) || 0, 0), 1))];
  };
  for (let corner = 0; corner < triangles.length; corner++) {
    const colour = of(corner);
    for (let i = 0; i < 3; i++) colours[3 * corner + i] = colour[i];
  }
  return colours;
}

export function css([r, g, b]: Colour): string {
  return `rgb(${r} ${g} ${b})`;
}

export function gradient(ramp: Colour[]): string {
  return `linear-gradient(to right, ${ramp.map(css).join(", ")})`;
}
