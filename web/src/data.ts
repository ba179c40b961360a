// What the page knows of a surface and its maps, and the container that arrays come in (cli/src/page/container.rs).

export interface Surface {
  name: string;
  topology: { vertices: number; faces: number; components: number; boundary_loops: number; genus: number };
  least: number;
  most: number;
  methods: { name: string; description: string }[];
  chosen: { n: number | null; method: string; angles: string };
  warnings: string[];
  /** Whether maps are computed on even triangles, whose edges are not those that are shown. */
  refined: boolean;
  /** Three coordinates a vertex, about the origin. */
  points: Float32Array;
  /** Three vertices a triangle. */
  triangles: Uint32Array;
  /** The conformal factor of each vertex. */
  factor: Float32Array;
  /** The number of each vertex in the file; none where it is the number here. */
  vertex: Uint32Array | null;
  /** For each vertex whether it can be a cone; none where nothing can be asked for. */
  usable: Uint8Array | null;
}

/** A cone at a vertex as it is numbered here; its curvature in radians, NaN while it is not known. */
export interface Cone {
  vertex: number;
  curvature: number;
}

export interface Extremum {
  vertex: number;
  kind: "minimum" | "maximum";
  value: number;
  persistence: number;
  saddle: number | null;
}

/** So many cones, with their curvatures as far as they are known. */
export interface ForeseenLevel {
  n: number;
  cones: [number, number | null][];
  predicted_area: number;
}

/** The cones of a method for every number of them. */
export interface Foreseen {
  extrema: Extremum[];
  levels: ForeseenLevel[];
}

/** Cones, what is predicted for them, and seams, before there is a map. */
export interface Preview {
  cones: Cone[];
  predicted: number | null;
  seams: Uint32Array[];
}

export interface MapMeta {
  cones: { vertex: number; curvature: number }[];
  method: string;
  angles: string;
  tiles: number;
  fill: number;
  number: { target: number; chosen: number; curve?: unknown } | null;
  times: Record<string, number | null>;
  warnings: string[];
}

/** What a map is like, which is found after it. */
export interface Measured {
  meta: {
    distortion: {
      area_mean: number;
      quasi_conformal: { mean: number; p99: number; max: number };
      flipped: number;
      overlap_pairs: number;
      seam_length: number;
      curvature_error: number | null;
    };
    islands: number;
    /** The area distortion that was predicted for its cones. */
    predicted: number | null;
  };
  logArea: Float32Array;
  stretch: Float32Array;
}

export interface UvMap {
  meta: MapMeta;
  /** None while it is being measured. */
  measured: Measured | null;
  cones: Cone[];
  /** Two coordinates for each of three corners of each triangle. */
  uv: Float32Array;
  island: Uint32Array;
  seams: Uint32Array[];
}

export interface Question {
  n: number | null;
  given: [number, number | null][] | null;
  /** The text of a file of cones, which says more than where these are. */
  recipe: string | null;
  /** Edges that are cut, and edges that are not. */
  cut: Edge[];
  avoid: Edge[];
  method: string;
  angles: string;
}

/** Two vertices, the lower number first. */
export type Edge = [number, number];

type Kind = "f32" | "u32" | "u8";

/** Arrays by name, and the document that came with them. */
export class Container {
  readonly meta: any;
  private readonly arrays: Record<string, { type: Kind; at: number; length: number }>;
  private readonly begin: number;

  constructor(private readonly buffer: ArrayBuffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const document = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    this.meta = document.meta;
    this.arrays = document.arrays;
    this.begin = 4 + length;
  }

  has(name: string): boolean {
    return name in this.arrays;
  }

  floats(name: string): Float32Array {
    const { at, length } = this.find(name);
    return new Float32Array(this.buffer, this.begin + at, length);
  }

  words(name: string): Uint32Array {
    const { at, length } = this.find(name);
    return new Uint32Array(this.buffer, this.begin + at, length);
  }

  bytes(name: string): Uint8Array {
    const { at, length } = this.find(name);
    return new Uint8Array(this.buffer, this.begin + at, length);
  }

  private find(name: string) {
    const found = this.arrays[name];
    if (!found) throw new Error(`the data has no ${name}`);
    return found;
  }
}

/** One array cut into pieces of given lengths. */
export function pieces(all: Uint32Array, lengths: Uint32Array): Uint32Array[] {
  let at = 0;
  return Array.from(lengths, (length) => all.subarray(at, (at += length)));
}
