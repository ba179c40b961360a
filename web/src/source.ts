// Where surfaces, cones and maps come from: the server of `cones view`, or the file that the page is.

import { type Cone, Container, type Foreseen, type Measured, pieces, type Preview, type Question, type Surface, type UvMap } from "./data";
import * as packed from "./packed";

export interface Source {
  /** Whether everything can be asked for, or only what is stored. */
  readonly isLive: boolean;
  surface(): Promise<Surface>;
  foreseen(method: string, angles: string): Promise<Foreseen>;
  preview(question: Question, serial: number, signal: AbortSignal): Promise<Preview>;
  map(question: Question, serial: number, signal: AbortSignal): Promise<UvMap>;
  /** What the map of a question is like, which that one did not say. */
  measured(question: Question, serial: number, signal: AbortSignal): Promise<Measured>;
  save(kind: "obj" | "glb" | "cones", question: Question): Promise<Blob>;
  /** Wants nothing any more of what was asked before a question of that number. */
  stop(serial: number): void;
}

/** An answer that a newer question has replaced. */
export class Replaced extends Error {}

/** A question that has no answer, and why. */
export class Refused extends Error {}

class Live implements Source {
  readonly isLive = true;
  private readonly tab = Math.random().toString(36).slice(2);

  constructor() {
    // A page that the browser keeps may come back.
    addEventListener("pagehide", (event) => event.persisted || navigator.sendBeacon("leave", JSON.stringify({ tab: this.tab })));
  }

  async surface(): Promise<Surface> {
    const data = new Container(await (await this.ask("surface")).arrayBuffer());
    return {
      ...data.meta,
      points: data.floats("points"),
      triangles: data.words("triangles"),
      factor: data.floats("factor"),
      vertex: null,
      usable: data.bytes("usable"),
    };
  }

  async foreseen(method: string, angles: string): Promise<Foreseen> {
    return (await this.ask("foreseen", { method, angles })).json();
  }

  async preview(question: Question, serial: number, signal: AbortSignal): Promise<Preview> {
    const { found, seams } = await (await this.ask("cones", { ...question, serial }, signal)).json();
    return {
      cones: found.cones.map(({ vertex, curvature }: Cone) => ({ vertex, curvature })),
      predicted: found.prediction.predicted_area,
      seams: seams.map((chain: number[]) => Uint32Array.from(chain)),
    };
  }

  async map(question: Question, serial: number, signal: AbortSignal): Promise<UvMap> {
    const data = new Container(await (await this.ask("map", { ...question, serial }, signal)).arrayBuffer());
    return {
      meta: data.meta,
      measured: null,
      cones: data.meta.cones,
      uv: data.floats("uv"),
      island: data.words("island"),
      seams: pieces(data.words("seams"), data.words("seam_lengths")),
    };
  }

  async measured(question: Question, serial: number, signal: AbortSignal): Promise<Measured> {
    const data = new Container(await (await this.ask("measured", { ...question, serial }, signal)).arrayBuffer());
    return { meta: data.meta, logArea: data.floats("log_area"), stretch: data.floats("stretch") };
  }

  /** Asked for apart from maps, so that no other choice stops it. */
  async save(kind: string, question: Question): Promise<Blob> {
    return (await this.ask(`save/${kind}`, { ...question, serial: 0, tab: `${this.tab}-saves` })).blob();
  }

  stop(serial: number): void {
    navigator.sendBeacon("stop", JSON.stringify({ tab: this.tab, serial }));
  }

  private async ask(path: string, question?: object, signal?: AbortSignal): Promise<Response> {
    const how = question && { method: "POST", body: JSON.stringify({ tab: this.tab, ...question }), signal };
    const answer = await fetch(path, how).catch((error) => {
      if (signal?.aborted) throw new Replaced();
      throw new Error(`cones view does not answer: is it still running? (${error.message})`);
    });
    if (answer.status === 409) throw new Replaced();
    if (!answer.ok) throw new Refused(await answer.text());
    return answer;
  }
}

/** What a report has of one number of cones. */
interface Level {
  meta: { n: number; cones: Cone[]; predicted: number | null; map: UvMap["meta"] | null; measured?: Measured["meta"] };
  range: { low: number[]; step: number } | null;
}

class Stored implements Source {
  readonly isLive = false;
  private readonly corners: Uint32Array;
  private readonly from: Uint32Array;
  private readonly vertex: Uint32Array;
  private readonly number = new Map<number, number>();

  constructor(private readonly data: Container) {
    const { vertices, triangles } = data.meta;
    [this.corners, this.from] = packed.triangles(data.bytes("triangles"), triangles, vertices);
    this.vertex = packed.sequence(data.bytes("vertex"), vertices);
    this.vertex.forEach((vertex, number) => this.number.set(vertex, number));
  }

  async surface(): Promise<Surface> {
    const { meta } = this.data;
    return {
      ...meta.surface,
      points: packed.values(this.data.bytes("points"), this.from, 3, meta.points),
      factor: packed.values(this.data.bytes("factor"), this.from, 1, meta.factor),
      triangles: this.corners,
      vertex: this.vertex,
      usable: null,
    };
  }

  async foreseen(): Promise<Foreseen> {
    const { extrema, levels } = this.data.meta.foreseen as Foreseen;
    return {
      extrema: extrema.map((one) => ({ ...one, vertex: this.here(one.vertex) })),
      levels: levels.map(({ cones, ...rest }) => ({ ...rest, cones: cones.map(([v, k]) => [this.here(v), k]) })),
    };
  }

  async preview(question: Question): Promise<Preview> {
    const at = this.nearest(question.n, () => true);
    const { cones, predicted } = this.levels[at].meta;
    return { cones: this.cones(cones), predicted, seams: packed.chains(this.data.bytes(`seams.${at}`)) };
  }

  /** The map of the nearest number of cones that one is stored for. */
  async map(question: Question): Promise<UvMap> {
    const at = this.nearest(question.n, (level) => level.range !== null);
    const { meta, range } = this.levels[at];
    const bytes = (name: string) => this.data.bytes(`${name}.${at}`);
    return {
      meta: meta.map!,
      measured: {
        meta: { ...meta.measured!, predicted: meta.predicted },
        logArea: packed.logarithms(bytes("log_area"), this.data.meta.most_log_area),
        stretch: packed.logarithms(bytes("stretch"), this.data.meta.most_log_stretch).map(Math.exp),
      },
      cones: this.cones(meta.cones),
      uv: packed.coordinates(bytes("uv"), bytes("others"), this.from, this.corners, range!),
      island: packed.sequence(bytes("island"), this.corners.length / 3),
      seams: packed.chains(bytes("seams")),
    };
  }

  measured(): Promise<Measured> {
    throw new Error("a report's maps are measured");
  }

  save(): Promise<Blob> {
    throw new Error("a report saves nothing");
  }

  stop(): void {}

  private get levels(): Level[] {
    return this.data.meta.levels;
  }

  private here(vertex: number): number {
    return this.number.get(vertex) ?? 0;
  }

  private cones(cones: Cone[]): Cone[] {
    return cones.map(({ vertex, curvature }) => ({ vertex: this.here(vertex), curvature }));
  }

  private nearest(n: number | null, fits: (level: Level) => boolean): number {
    const wanted = n ?? this.data.meta.surface.chosen.n;
    const away = (level: Level) => (fits(level) ? Math.abs(level.meta.n - wanted) : Infinity);
    return this.levels.reduce((best, level, k) => (away(level) < away(this.levels[best]) ? k : best), 0);
  }
}

/** Where surface and maps come from: the file's own data, if there is any, else the server that the page came from. */
export function source(data: Container | null): Source {
  return data ? new Stored(data) : new Live();
}

/** The file's own data, if there is any. */
export async function stored(): Promise<Container | null> {
  const text = document.getElementById("data")?.textContent?.trim();
  if (!text) return null;
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const inflated = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Container(await new Response(inflated).arrayBuffer());
}
