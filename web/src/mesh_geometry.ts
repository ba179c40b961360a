// The triangles of a surface or a map as they are sent to be drawn. What is the same at all corners of a vertex is sent once, which is a
// sixth of the work; colours of triangles are only told corner by corner.

import { BufferAttribute, BufferGeometry, Mesh, type ShaderMaterial } from "three";
import type { Surface } from "./data";

/** What triangles are painted with: a checkerboard, one colour, or a colour a corner. */
export type Paint = "checker" | "plain" | "tint";

/** Where corners are, what their normals are, and their texture coordinates: rows of three, three and two numbers. */
interface Corners {
  /** Writes the place of a corner. */
  position: (corner: number, into: Float32Array, at: number) => void;
  normals: Float32Array | null;
  coordinates: Float32Array | null;
}

export class TriangleMesh {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private readonly shared = new BufferGeometry();
  private readonly parted = new BufferGeometry();
  private isParted = false;
  private corners: Corners | null = null;

  constructor(private readonly surface: Surface, material: ShaderMaterial) {
    this.mesh = new Mesh(this.shared, material);
    this.mesh.frustumCulled = false;
    // There is nothing yet.
    this.mesh.visible = false;
  }

  /** Takes other corners. */
  shape(corners: Corners): void {
    this.corners = corners;
    const { corner, index } = wedges(this.surface, corners);
    fill(this.shared, corner, corners);
    if (!this.shared.index) this.shared.setIndex(new BufferAttribute(index, 1));
    else {
      this.shared.index.array.set(index);
      this.shared.index.needsUpdate = true;
    }
    this.isParted = false;
    if (this.mesh.geometry === this.parted) this.part();
    this.mesh.visible = true;
  }

  /** Paints it; the tint has three bytes a corner. */
  paint(paint: Paint, tint: Uint8Array): void {
    const { uniforms } = this.mesh.material;
    [uniforms.isChecker.value, uniforms.isPlain.value] = [paint === "checker", paint === "plain"];
    this.mesh.geometry = paint === "tint" ? this.parted : this.shared;
    if (paint !== "tint") return;
    this.part();
    put(this.parted, "tint", tint, 3);
  }

  private part(): void {
    if (this.isParted || !this.corners) return;
    const all = Uint32Array.from({ length: this.surface.triangles.length }, (_, corner) => corner);
    fill(this.parted, all, this.corners);
    this.isParted = true;
  }
}

/** Corners of one vertex with the same normal and coordinates are one: a corner of each, and which of them each corner is. */
function wedges({ triangles, points }: Surface, { normals, coordinates }: Corners): { corner: Uint32Array; index: Uint32Array } {
  const first = new Int32Array(points.length / 3).fill(-1);
  const corner = new Uint32Array(triangles.length);
  const next = new Int32Array(triangles.length);
  const index = new Uint32Array(triangles.length);
  let count = 0;
  for (let c = 0; c < triangles.length; c++) {
    const v = triangles[c];
    let k = first[v];
    while (k >= 0 && !(alike(coordinates, 2, corner[k], c) && alike(normals, 3, corner[k], c))) k = next[k];
    if (k < 0) {
      k = count++;
      corner[k] = c;
      next[k] = first[v];
      first[v] = k;
    }
    index[c] = k;
  }
  return { corner: corner.slice(0, count), index };
}

/** Whether two corners have the same row of values. */
function alike(values: Float32Array | null, width: number, a: number, b: number): boolean {
  for (let i = 0; values && i < width; i++) {
    if (values[width * a + i] !== values[width * b + i]) return false;
  }
  return true;
}

function fill(geometry: BufferGeometry, corners: ArrayLike<number>, { position, normals, coordinates }: Corners): void {
  const positions = new Float32Array(3 * corners.length);
  const normal = new Float32Array(normals ? 3 * corners.length : 0);
  const at = new Float32Array(2 * corners.length);
  for (let k = 0; k < corners.length; k++) {
    const c = corners[k];
    position(c, positions, 3 * k);
    for (let i = 0; normals && i < 3; i++) normal[3 * k + i] = normals[3 * c + i];
    for (let i = 0; coordinates && i < 2; i++) at[2 * k + i] = coordinates[2 * c + i];
  }
  put(geometry, "position", positions, 3);
  put(geometry, "coordinates", at, 2);
  if (normals) put(geometry, "normal", normal, 3);
}

/** Puts values in the place of others, and makes that place where it does not fit. */
function put(geometry: BufferGeometry, name: string, values: Float32Array | Uint8Array, width: number): void {
  const old = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (old?.array.length === values.length) {
    old.array.set(values);
    old.needsUpdate = true;
    return;
  }
  // Its buffers are those of the old size.
  if (old) geometry.dispose();
  geometry.setAttribute(name, new BufferAttribute(values, width, values instanceof Uint8Array));
}
