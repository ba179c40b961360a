// Seams by hand: chains of edges that are cut, and chains that are not.

import type { Edge, Question, Surface } from "./data";
import { type Corners, follow } from "./geometry";

/** What is done with edges. */
export type Pin = "cut" | "avoid";
/** The edges of a choice. */
export type Pins = Pick<Question, Pin>;

/** A comment in a file of edges that tells what they are for; the command passes over it. */
const HEADS: Record<Pin, string> = {
  cut: "# edges to cut, for --seams",
  avoid: "# edges not to cut, for --avoid",
};

/** The shortest chain of edges between two vertices (Dijkstra 1959); nothing where they are on different parts. */
export function chain(surface: Surface, { start, corner }: Corners, from: number, to: number): number[] | null {
  const { points, triangles } = surface;
  const away = new Map([[from, 0]]);
  const before = new Map<number, number>();
  const heap = new Heap();
  heap.push(0, from);
  const length = (a: number, b: number) =>
    Math.hypot(...[0, 1, 2].map((i) => points[3 * a + i] - points[3 * b + i]));
  for (let next = heap.pop(); next; next = heap.pop()) {
    const [distance, v] = next;
    if (v === to) break;
    if (distance > away.get(v)!) continue;
    for (let k = start[v]; k < start[v + 1]; k++) {
      const one = follow(corner[k]);
      for (const w of [triangles[one], triangles[follow(one)]]) {
        const there = distance + length(v, w);
        if (there < (away.get(w) ?? Infinity)) {
          away.set(w, there);
          before.set(w, v);
          heap.push(there, w);
        }
      }
    }
  }
  const found = [to];
  for (let v = before.get(to); v !== undefined; v = before.get(v)) found.unshift(v);
  return found[0] === from ? found : null;
}

/** The edges with those of a chain pinned, which are no longer pinned otherwise. */
export function pinned({ cut, avoid }: Pins, pin: Pin, vertices: number[]): Pins {
  const added = vertices.slice(1).map((v, k): Edge => [Math.min(v, vertices[k]), Math.max(v, vertices[k])]);
  const names = new Set(added.map(String));
  const rest = (edges: Edge[]) => edges.filter((edge) => !names.has(String(edge)));
  const all = { cut: rest(cut), avoid: rest(avoid) };
  return { ...all, [pin]: [...all[pin], ...added] };
}

export function text(pin: Pin, edges: Edge[]): string {
  return [HEADS[pin], ...edges.map((edge) => edge.join(" "))].join("\n") + "\n";
}

/**
 * What a file pins, and its edges; nothing where it is a file of something else. Where no comment says what it is for, its lines are edges
 * to cut if all of them are edges of the surface: curvatures are seldom whole numbers, and never all of them neighbours.
 */
export function read(file: string, surface: Surface, corners: Corners): { pin: Pin; edges: Edge[] } | null {
  const lines = file.split("\n").map((line) => line.trim());
  const pin = (["cut", "avoid"] as const).find((pin) => lines.includes(HEADS[pin]));
  const told = lines.map((line) => line.split("#")[0].trim()).filter(Boolean);
  const edges = told.map((line): Edge | null => {
    const [a, b, ...more] = line.split(/\s+/).map(Number);
    return !more.length && [a, b].every((v) => Number.isInteger(v) && v >= 0) ? [Math.min(a, b), Math.max(a, b)] : null;
  });
  const wrong = edges.indexOf(null);
  if (pin && wrong >= 0) throw new Error(`no edge: ${told[wrong].slice(0, 60)}`);
  const isPinned = pin || (edges.length > 0 && edges.every((edge) => edge && isEdge(surface, corners, edge)));
  return isPinned ? { pin: pin ?? "cut", edges: edges as Edge[] } : null;
}

function isEdge({ triangles }: Surface, { start, corner }: Corners, [a, b]: Edge): boolean {
  if (Math.max(a, b) >= start.length - 1) return false;
  return corner.subarray(start[a], start[a + 1]).some((c) => triangles[follow(c)] === b || triangles[follow(follow(c))] === b);
}

/** Vertices by their distances, the nearest first. */
class Heap {
  private readonly all: [number, number][] = [];

  push(distance: number, vertex: number): void {
    const { all } = this;
    let k = all.push([distance, vertex]) - 1;
    for (let up = (k - 1) >> 1; k > 0 && all[up][0] > distance; k = up, up = (k - 1) >> 1) {
      [all[k], all[up]] = [all[up], all[k]];
    }
  }

  pop(): [number, number] | undefined {
    const { all } = this;
    const first = all[0];
    const last = all.pop();
    if (!last || !all.length) return first;
    all[0] = last;
    for (let k = 0; ; ) {
      let down = 2 * k + 1;
      if (down + 1 < all.length && all[down + 1][0] < all[down][0]) down++;
      if (down >= all.length || all[down][0] >= all[k][0]) return first;
      [all[k], all[down]] = [all[down], all[k]];
      k = down;
    }
  }
}
