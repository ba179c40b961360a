// Where a map is cut, and where its cones came to lie.

import type { Cone, Edge, Surface, UvMap } from "./data";
import { type Corners, follow, sides } from "./geometry";

/** What is drawn over a map: pieces of its outline, four numbers each, and the copies of cones. */
export interface Outline {
  segments: Float32Array;
  /** The corners from which the pieces go on around their triangles. */
  corners: Uint32Array;
  cones: { at: [number, number]; cone: Cone }[];
}

export function outline(surface: Surface, corners: Corners, boundary: number[], map: UvMap): Outline {
  const { triangles } = surface;
  const from = new Set(boundary);
  for (const chain of map.seams) {
    for (let i = 1; i < chain.length; i++) sides(triangles, corners, chain[i - 1], chain[i]).forEach((c) => from.add(c));
  }
  const along = Uint32Array.from(from);
  return { segments: segments(map.uv, along), corners: along, cones: map.cones.flatMap((cone) => copies(corners, map, cone)) };
}

/** Both sides of edges on a map, four numbers each. */
export function onMap(surface: Surface, corners: Corners, uv: Float32Array, edges: Edge[]): Float32Array {
  return segments(uv, Uint32Array.from(edges.flatMap(([a, b]) => sides(surface.triangles, corners, a, b))));
}

function segments(uv: Float32Array, along: Uint32Array): Float32Array {
  const found = new Float32Array(4 * along.length);
  let k = 0;
  for (const corner of along) {
    for (const c of [corner, follow(corner)]) {
      found[k++] = uv[2 * c];
      found[k++] = uv[2 * c + 1];
    }
  }
  return found;
}

/** A cone's places in the map, each once. */
function copies({ start, corner }: Corners, map: UvMap, cone: Cone): Outline["cones"] {
  const found = new Map<string, [number, number]>();
  for (let k = start[cone.vertex]; k < start[cone.vertex + 1]; k++) {
    const at: [number, number] = [map.uv[2 * corner[k]], map.uv[2 * corner[k] + 1]];
    found.set(at.map((x) => x.toFixed(5)).join(), at);
  }
  return Array.from(found.values(), (at) => ({ at, cone }));
}
