// What a report's arrays were packed from (cli/src/page/packed.rs).

interface Range {
  low: number[];
  step: number;
}

/** Numbers of seven bits a byte, read one after the other. */
class Reader {
  private at = 0;

  constructor(readonly bytes: Uint8Array) {}

  get done(): boolean {
    return this.at >= this.bytes.length;
  }

  number(): number {
    let number = 0;
    let weight = 1;
    for (;;) {
      const byte = this.bytes[this.at++];
      number += (byte & 0x7f) * weight;
      if (byte < 0x80) return number;
      weight *= 128;
    }
  }

  signed(): number {
    const number = this.number();
    return number % 2 ? -(number + 1) / 2 : number / 2;
  }

  short(): number {
    this.at += 2;
    return this.bytes[this.at - 2] | (this.bytes[this.at - 1] << 8);
  }
}

export function sequence(bytes: Uint8Array, length: number): Uint32Array {
  const reader = new Reader(bytes);
  let last = 0;
  return Uint32Array.from({ length }, () => (last += reader.signed()));
}

/** Triangles, and for each vertex the one that it is told from. */
export function triangles(bytes: Uint8Array, count: number, vertices: number): [Uint32Array, Uint32Array] {
  const reader = new Reader(bytes);
  const corners = new Uint32Array(3 * count);
  const from = new Uint32Array(vertices);
  let next = 0;
  for (let t = 0; t < corners.length; t += 3) {
    const begin = next;
    for (let k = 0; k < 3; k++) {
      corners[t + k] = next - reader.number();
      next = Math.max(next, corners[t + k] + 1);
    }
    const known = [0, 1, 2].map((k) => corners[t + k]).find((v) => v < begin) ?? begin;
    for (let v = begin; v < next; v++) from[v] = known;
  }
  return [corners, from];
}

/** Values of each vertex, so many each. */
export function values(bytes: Uint8Array, from: Uint32Array, width: number, range: Range): Float32Array {
  const count = from.length * width;
  const steps = new Uint16Array(count);
  const values = new Float32Array(count);
  for (let v = 0; v < from.length; v++) {
    for (let i = 0; i < width; i++) {
      const at = v * width + i;
      const folded = bytes[at] | (bytes[count + at] << 8);
      const difference = (folded >>> 1) ^ -(folded & 1);
      steps[at] = difference + (from[v] === v ? 0 : steps[from[v] * width + i]);
      values[at] = range.low[i] + range.step * steps[at];
    }
  }
  return values;
}

/** Texture coordinates of corners. */
export function coordinates(
  firsts: Uint8Array,
  others: Uint8Array,
  from: Uint32Array,
  corners: Uint32Array,
  range: Range,
): Float32Array {
  const first = values(firsts, from, 2, range);
  const uv = new Float32Array(2 * corners.length);
  for (let corner = 0; corner < corners.length; corner++) {
    uv[2 * corner] = first[2 * corners[corner]];
    uv[2 * corner + 1] = first[2 * corners[corner] + 1];
  }
  const reader = new Reader(others);
  for (let corner = 0; !reader.done; ) {
    corner += reader.number();
    for (let i = 0; i < 2; i++) uv[2 * corner + i] = range.low[i] + range.step * reader.short();
  }
  return uv;
}

export function chains(bytes: Uint8Array): Uint32Array[] {
  const reader = new Reader(bytes);
  const chains = [];
  while (!reader.done) {
    const length = reader.number();
    let last = 0;
    chains.push(Uint32Array.from({ length }, () => (last += reader.signed())));
  }
  return chains;
}

/** Logarithms of a byte each. */
export function logarithms(bytes: Uint8Array, most: number): Float32Array {
  let code = 0;
  return Float32Array.from(bytes, (difference) => {
    code = (code + difference) & 0xff;
    return ((code - 127.5) / 127.5) * most;
  });
}
