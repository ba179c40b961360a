// Where a map is cut, and where its cones came to lie.

import type { Cone, Surface, UvMap } from "./data";
import { type Corners, follow, sides } from "./geometry";

/** What is drawn over a map: pieces of its outline, four numbers each, and the copies of cones. */
export interface Outline {
  segments: Float32Array;
  cones: { at: [number, number]; cone: Cone }[];
}

export function outline(surface: Surface, corners: Corners, boundary: number[], map: UvMap): Outline {
  const { triangles } = surface;
  const from = new Set(boundary);
  for (const chain of map.seams) {
    for (let i = 1; i < chain.length; i++) sides(triangles, corners, chain[i - 1], chain[i]).forEach((c) => from.add(c));
  }
  const segments = new Float32Array(4 * from.size);
  let k = 0;
  for (const corner of from) {
    for (const c of [corner, follow(corner)]) {
      segments[k++] = map.uv[2 * c];
      segments[k++] = map.uv[2 * c + 1];
    }
  }
  return { segments, cones: map.cones.flatMap((cone) => copies(corners, map, cone)) };
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
