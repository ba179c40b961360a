// A field in a report, as cli/src/page/field.rs has written it.

import type { Container } from "./data";

/** A vertex or basin that belongs to no extremum. */
export const NONE = 0xffffffff;

export interface Pair {
  extremum: number;
  saddle: number | null;
  birth: number;
  death: number | null;
  persistence: number;
  /** The place of the pair whose component is joined. */
  parent: number | null;
}

/** So many extrema that are more persistent than a threshold. */
export interface Level {
  n: number;
  threshold: number;
}

export interface Direction {
  kind: "minimum" | "maximum";
  /** Those that never end first, then the most persistent: at each level the first ones are those that are there. */
  pairs: Pair[];
  /** How many pairs there are. */
  all: number;
  levels: Level[];
  /** The basin of each vertex that is shown. */
  basins: Uint32Array;
  /** For each level the pair that each basin belongs to. */
  survivors: Uint32Array[];
}

export interface Field {
  name: string;
  kind: "mesh" | "array" | "network";
  /** Depth, rows and columns. */
  shape: [number, number, number] | null;
  /** The first vertex of an array that is shown. */
  first: number;
  /** The names of a network's nodes. */
  names: string[] | null;
  range: [number, number];
  /** From 1 to 255 from the least to the greatest; 0 where there is none. */
  values: Uint8Array;
  points: Float32Array | null;
  triangles: Uint32Array | null;
  directions: Direction[];
}

export function readField(data: Container): Field {
  const { directions, ...rest } = data.meta.field;
  const isMesh = rest.kind === "mesh";
  return {
    ...rest,
    values: data.bytes("values"),
    points: isMesh ? data.floats("points") : null,
    triangles: isMesh ? data.words("triangles") : null,
    directions: directions.map((direction: any, k: number): Direction => {
      const all = data.words(`survivors.${k}`);
      // Infinite values are written as words, as JSON has no such numbers.
      const pairs = direction.pairs.map(([extremum, saddle, birth, death, persistence, parent]: any): Pair => ({
        extremum, saddle, birth: Number(birth), death: death === null ? null : Number(death), persistence: Number(persistence), parent,
      }));
      const levels = direction.levels.map(({ n, threshold }: any): Level => ({ n, threshold: Number(threshold) }));
      const level = (k: number) => all.subarray(k * direction.basins, (k + 1) * direction.basins);
      return { ...direction, pairs, levels, basins: data.words(`basins.${k}`), survivors: levels.map((_: Level, k: number) => level(k)) };
    }),
  };
}
