// Neighbours, normals, outlines, and what lies under a ray or a point.

import type { Surface } from "./data";

export type Vec3 = [number, number, number];

/** The corners at each vertex, row by row. */
export interface Corners {
  start: Uint32Array;
  corner: Uint32Array;
}

export function cornersAt(surface: Surface): Corners {
  const { triangles, points } = surface;
  const start = new Uint32Array(points.length / 3 + 1);
  for (const v of triangles) start[v + 1]++;
  for (let v = 1; v < start.length; v++) start[v] += start[v - 1];
  const next = start.slice();
  const corner = new Uint32Array(triangles.length);
  triangles.forEach((v, c) => (corner[next[v]++] = c));
  return { start, corner };
}

/** The normals of corners: smooth, but where the surface bends sharply. */
export function cornerNormals(surface: Surface): Float32Array {
  const { points, triangles } = surface;
  const face = new Float32Array(triangles.length);
  const vertex = new Float32Array(points.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    face[t] = uy * vz - uz * vy;
    face[t + 1] = uz * vx - ux * vz;
    face[t + 2] = ux * vy - uy * vx;
    for (let i = 0; i < 3; i++) {
      vertex[a + i] += face[t + i];
      vertex[b + i] += face[t + i];
      vertex[c + i] += face[t + i];
    }
  }
  normalise(face);
  normalise(vertex);
  const normals = new Float32Array(3 * triangles.length);
  for (let corner = 0; corner < triangles.length; corner++) {
    const f = corner - (corner % 3), v = 3 * triangles[corner];
    const cosine = face[f] * vertex[v] + face[f + 1] * vertex[v + 1] + face[f + 2] * vertex[v + 2];
    for (let i = 0; i < 3; i++) normals[3 * corner + i] = cosine > 0.75 ? vertex[v + i] : face[f + i];
  }
  return normals;
}

function normalise(vectors: Float32Array): void {
  for (let k = 0; k < vectors.length; k += 3) {
    const x = vectors[k], y = vectors[k + 1], z = vectors[k + 2];
    const length = Math.sqrt(x * x + y * y + z * z) || 1;
    for (let i = 0; i < 3; i++) vectors[k + i] /= length;
  }
}

/** The corners from which edges with one triangle go on around it. */
export function boundary({ triangles }: Surface, { start, corner }: Corners): number[] {
  const found = [];
  for (let c = 0; c < triangles.length; c++) {
    const [a, b] = [triangles[c], triangles[follow(c)]];
    let count = 0;
    for (let k = start[a]; k < start[a + 1]; k++) {
      const after = follow(corner[k]);
      if (triangles[after] === b) count++;
      if (triangles[follow(after)] === b) count++;
    }
    if (count === 1) found.push(c);
  }
  return found;
}

/** The vertex nearest to one for which something holds, of the first ring around it that has such. */
export function nearestVertex({ points, triangles }: Surface, { start, corner }: Corners, from: number, holds: (vertex: number) => boolean): number | null {
  const seen = new Set([from]);
  const away = (v: number) => Math.hypot(...[0, 1, 2].map((i) => points[3 * v + i] - points[3 * from + i]));
  for (let ring = [from]; ring.length; ) {
    const found = ring.filter(holds);
    if (found.length) return found.reduce((best, v) => (away(v) < away(best) ? v : best));
    const next: number[] = [];
    for (const v of ring) {
      for (let k = start[v]; k < start[v + 1]; k++) {
        const one = follow(corner[k]);
        for (const w of [triangles[one], triangles[follow(one)]]) if (!seen.has(w)) next.push(w), seen.add(w);
      }
    }
    ring = next;
  }
  return null;
}

export function follow(corner: number): number {
  return corner % 3 === 2 ? corner - 2 : corner + 1;
}

/** The corners from which the edge between two vertices goes on around a triangle: one for each of its sides. */
export function sides(triangles: Uint32Array, { start, corner }: Corners, a: number, b: number): number[] {
  const found = [];
  for (let k = start[a]; k < start[a + 1]; k++) {
    const c = corner[k];
    if (triangles[follow(c)] === b) found.push(c);
    const before = follow(follow(c));
    if (triangles[before] === b) found.push(before);
  }
  return found;
}

/** A point of the surface: a triangle and the weights of its corners. */
export interface Place {
  triangle: number;
  weights: Vec3;
}

/** Where a ray first meets the surface. */
export function hitSurface(surface: Surface, origin: Vec3, direction: Vec3): Place | null {
  const { points, triangles } = surface;
  const [ox, oy, oz] = origin;
  const [dx, dy, dz] = direction;
  let nearest = Infinity;
  let place: Place | null = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ax = points[a], ay = points[a + 1], az = points[a + 2];
    const ux = points[b] - ax, uy = points[b + 1] - ay, uz = points[b + 2] - az;
    const vx = points[c] - ax, vy = points[c + 1] - ay, vz = points[c + 2] - az;
    const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const inverse = 1 / (ux * px + uy * py + uz * pz);
    const sx = ox - ax, sy = oy - ay, sz = oz - az;
    const v = (sx * px + sy * py + sz * pz) * inverse;
    if (!(v >= 0 && v <= 1)) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const w = (dx * qx + dy * qy + dz * qz) * inverse;
    if (!(w >= 0 && v + w <= 1)) continue;
    const along = (vx * qx + vy * qy + vz * qz) * inverse;
    if (along > 0 && along < nearest) {
      nearest = along;
      place = { triangle: t / 3, weights: [1 - v - w, v, w] };
    }
  }
  return place;
}

/** Which triangle of a map lies at a point: found through a grid. */
export class MapGrid {
  private readonly cells: number;
  private readonly start: Uint32Array;
  private readonly triangle: Uint32Array;

  constructor(private readonly uv: Float32Array, private readonly extent: [number, number]) {
    const count = uv.length / 6;
    this.cells = Math.max(1, Math.min(512, Math.round(Math.sqrt(count / 2))));
    const start = new Uint32Array(this.cells * this.cells + 1);
    this.visit((cell) => start[cell + 1]++);
    for (let cell = 1; cell < start.length; cell++) start[cell] += start[cell - 1];
    const next = start.slice();
    this.triangle = new Uint32Array(start[start.length - 1]);
    this.visit((cell, t) => (this.triangle[next[cell]++] = t));
    this.start = start;
  }

  at(x: number, y: number): Place | null {
    const cell = this.cell(x, 0) + this.cells * this.cell(y, 1);
    if (x < 0 || y < 0 || x > this.extent[0] || y > this.extent[1]) return null;
    for (let k = this.start[cell]; k < this.start[cell + 1]; k++) {
      const t = this.triangle[k];
      const [ax, ay, bx, by, cx, cy] = this.uv.subarray(6 * t, 6 * t + 6);
      const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      const v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area;
      const w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area;
      if (v >= 0 && w >= 0 && v + w <= 1) return { triangle: t, weights: [1 - v - w, v, w] };
    }
    return null;
  }

  private cell(x: number, axis: 0 | 1): number {
    return Math.min(this.cells - 1, Math.max(0, Math.floor((x / this.extent[axis]) * this.cells)));
  }

  private visit(see: (cell: number, triangle: number) => void): void {
    const { uv } = this;
    for (let t = 0; t < uv.length / 6; t++) {
      const k = 6 * t;
      const left = this.cell(Math.min(uv[k], uv[k + 2], uv[k + 4]), 0), right = this.cell(Math.max(uv[k], uv[k + 2], uv[k + 4]), 0);
      const low = this.cell(Math.min(uv[k + 1], uv[k + 3], uv[k + 5]), 1), high = this.cell(Math.max(uv[k + 1], uv[k + 3], uv[k + 5]), 1);
      for (let j = low; j <= high; j++) {
        for (let i = left; i <= right; i++) see(i + this.cells * j, t);
      }
    }
  }
}

/** How far a map goes: over tiles of unit size. */
export function extent(uv: Float32Array): [number, number] {
  let [x, y] = [1, 1];
  for (let k = 0; k < uv.length; k += 2) {
    x = Math.max(x, Math.ceil(uv[k] - 1e-6));
    y = Math.max(y, Math.ceil(uv[k + 1] - 1e-6));
  }
  return [x, y];
}

export function pointOf(surface: Surface, { triangle, weights }: Place): Vec3 {
  const at = (i: number) =>
    weights.reduce((sum, w, k) => sum + w * surface.points[3 * surface.triangles[3 * triangle + k] + i], 0);
  return [at(0), at(1), at(2)];
}

export function uvOf(uv: Float32Array, { triangle, weights }: Place): [number, number] {
  const at = (i: number) => weights.reduce((sum, w, k) => sum + w * uv[6 * triangle + 2 * k + i], 0);
  return [at(0), at(1)];
}

export function vertexOf(surface: Surface, { triangle, weights }: Place): number {
  const most = weights.indexOf(Math.max(...weights));
  return surface.triangles[3 * triangle + most];
}

/** Edges that are cut by hand, and edges that are never cut. */
export const CUT = 0xf0a010;
export const SPARED = 0x18a070;

export function coneColour(curvature: number): number {
  return curvature < 0 ? 0xd62728 : 0x1f5fd0;
}
