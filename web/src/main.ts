// The page: one choice of cones, shown as a surface, as a map, and in numbers.

import { AtlasCanvas } from "./atlas_canvas";
import { type Atlas, AtlasView } from "./atlas_view";
import { CurveChart, DiagramChart } from "./charts";
import { type Mode, cornerColours, scale } from "./colours";
import type { Cone, Edge, Foreseen, ForeseenLevel, Preview, Question, Surface, UvMap } from "./data";
import { FieldApp } from "./field_app";
import * as geometry from "./geometry";
import type { Place } from "./geometry";
import { History } from "./history";
import { type Outline, onMap, outline } from "./outline";
import * as page from "./page";
import { byId, counted } from "./page";
import * as pins from "./pins";
import { Refused, Replaced, type Source, source, stored } from "./source";
import { onClick, webGl } from "./stage";
import { SurfaceView } from "./surface_view";

/** A map is asked for when the choice has stood so long, in milliseconds; when it has stood so long while the slider is still held. */
const PATIENCE = 120;
const HELD = 400;
/** And it rests, as far as the list of cones goes. */
const REST = 250;
/** The area distortion that is aimed at where no number of cones is chosen. */
const TARGET = 1.25;

/** Buttons and what they are for. */
const TOOLS = [["edit", "cones"], ["cut", "cut"], ["avoid", "avoid"]] as const;
const KEYS: Record<string, "cones" | pins.Pin> = { e: "cones", c: "cut", n: "avoid" };
const HINTS = {
  cones: "click adds a cone, drag moves one",
  cut: "click where the cut goes on, or twice on a seam",
  avoid: "click along what stays whole, or twice on a seam",
};
const NO_EDGES = "edges cannot be pinned here: maps are computed on even triangles, which have other edges";
/** A vertex on a seam of the map is taken hold of within so many pixels. */
const REACH = 9;
/** The clicks of a double click come within so many milliseconds. */
const DOUBLE = 500;

class App {
  private readonly corners: geometry.Corners;
  private readonly boundary: number[];
  private readonly view: SurfaceView | null;
  private readonly atlas: Atlas;
  private readonly curve: CurveChart;
  private readonly diagram: DiagramChart;
  private readonly history = new History<Question>();
  private readonly known = new Map<string, Foreseen>();
  /** The distortion of the maps that were made, by method and number. */
  private readonly measured = new Map<string, Map<number, number>>();
  private readonly pressMode: (mode: Mode) => void;
  private question: Question;
  private cones: Cone[] = [];
  private predicted: number | null = null;
  private map: UvMap | null = null;
  /** The question that the map answers. */
  private mapOf = "";
  private readonly asked = new Map<string, Promise<void>>();
  /** What finds triangles of the map, once it is asked. */
  private grid: geometry.MapGrid | null = null;
  private drawn: Outline | null = null;
  /** The pins that are shown, and on which map. */
  private pinsShown: { cut: Edge[]; avoid: Edge[]; uv: UvMap["uv"] | undefined } = { cut: [], avoid: [], uv: undefined };
  private mode: Mode = "checker";
  private isDark = false;
  /** What a click on the surface does. */
  private tool: "" | "cones" | pins.Pin = "";
  /** Where the chain that is being pinned goes on from. */
  private chainEnd: number | null = null;
  /** When the surface or the map was last clicked to pin something, and the choice before that: the click may be half of a double one. */
  private clicked: { at: number; before: Question | null } = { at: 0, before: null };
  /** The vertex of the cone that is selected. Cones are exchanged at any time, so that their places tell nothing. */
  private selected: number | null = null;
  /** The cone that is dragged, by its place, and the cones that there are if nothing comes of it: others wait until it is let go. */
  private dragged: { k: number; isMoved: boolean; otherwise: Cone[] } | null = null;
  /** Why the last choice was refused. */
  private refusal = "";
  private serial = Date.now();
  private running: AbortController | null = null;
  /** Whether the source may be at work on what was asked. */
  private isAsking = false;
  /** What is asked next, and when. */
  private waiting: { timer: number; begin: () => void } | null = null;
  private isHeld = false;
  private listing = 0;
  /** When there was the last sign of somebody who is about to do something. */
  private moved = 0;
  /** What was found of the cones and seams of a method with certain pins, for each number. */
  private readonly previews = { of: "", found: new Map<number, Preview>() };
  private marked: Place | null = null;
  private pinned: Place | null = null;

  constructor(private readonly source: Source, private readonly surface: Surface) {
    this.corners = geometry.cornersAt(surface);
    this.boundary = geometry.boundary(surface, this.corners);
    // What is written above the views comes first: it says how high these are.
    this.pressMode = page.modeButtons((mode) => this.colour(mode));
    page.about(surface);
    page.warnings(surface.warnings);
    this.showLegend();
    const canvasOf = (id: string) => byId(id).querySelector("canvas")!;
    this.view = webGl(canvasOf("surface"), false) ? new SurfaceView(byId("surface"), canvasOf("surface"), surface) : null;
    this.atlas = webGl(canvasOf("atlas"))
      ? new AtlasView(byId("atlas"), canvasOf("atlas"), surface)
      : new AtlasCanvas(byId("atlas"), canvasOf("atlas"));
    if (!this.view) page.message(byId("surface"), "This browser has no WebGL, so the surface cannot be shown. The map and all numbers are here.");
    this.question = { ...surface.chosen, given: null, recipe: null, cut: [], avoid: [] };
    this.curve = new CurveChart(byId("curve"), (n) => this.choose({ n, given: null }));
    this.diagram = new DiagramChart(byId("diagram"));
    this.listen();
    page.theme((isDark) => {
      this.isDark = isDark;
      this.atlas.theme(isDark);
    });
    this.colour("checker");
    this.restart();
  }

  /** Takes another choice of cones, which can be undone. What a file says holds until cones change. */
  private choose(change: Partial<Question>): void {
    const next = { ...this.question, ...("given" in change && { recipe: null }), ...change };
    if (JSON.stringify(next) === JSON.stringify(this.question)) return;
    this.history.keep(this.question);
    this.question = next;
    this.restart();
  }

  private go(to: Question | undefined): void {
    if (!to) return;
    this.question = to;
    this.restart();
  }

  /** Shows at once what is known of the choice, then asks for its map. */
  private restart(refusal = ""): void {
    this.running?.abort();
    const { signal } = (this.running = new AbortController());
    const serial = ++this.serial;
    this.refusal = refusal;
    this.selected = this.dragged = this.predicted = null;
    this.showControls();
    // All numbers take as much computing as a third of the first map, which comes first.
    if (!this.isOpening()) void this.learn();
    this.stale(true);
    this.foresee();
    clearTimeout(this.waiting?.timer);
    this.tell("computing the map …", "busy");
    if (this.isAsking) this.source.stop(serial);
    this.isAsking = false;
    const begin = () => {
      this.waiting = null;
      this.isAsking = true;
      void this.ask(serial, signal);
    };
    if (!this.map) return begin();
    this.waiting = { timer: window.setTimeout(begin, this.isHeld ? HELD : PATIENCE), begin };
  }

  /** Tells how far the map is, or why it is not that of the last choice. */
  private tell(text: string, how: "" | "busy" = ""): void {
    page.status(this.refusal || text, this.refusal ? "failed" : how);
  }

  /** Other cones take the place of those that there are. */
  private takeCones(cones: Cone[]): void {
    if (this.dragged) {
      this.dragged.otherwise = cones;
      return;
    }
    this.cones = cones;
    if (this.selectedAt() === null) this.selected = null;
  }

  private selectedAt(): number | null {
    const k = this.cones.findIndex(({ vertex }) => vertex === this.selected);
    return k < 0 ? null : k;
  }

  /** Whether the first map is still to come, and nothing else was chosen. */
  private isOpening(): boolean {
    return this.source.isLive && !this.map && !this.history.canUndo;
  }

  /** The slider is let go: what is waited for begins after so many milliseconds. */
  private release(patience: number): void {
    this.isHeld = false;
    if (!this.waiting) return;
    clearTimeout(this.waiting.timer);
    this.waiting.timer = window.setTimeout(this.waiting.begin, patience);
    this.rest();
  }

  /** The cones that are foreseen, until there is better. */
  private foresee(): void {
    const { n, given } = this.question;
    const level = this.level();
    const preview = given || !level ? undefined : this.previewsHere().get(level.n);
    if (preview && (n === null || level!.n === n)) {
      this.takeCones(preview.cones);
      this.predicted = preview.predicted;
    } else if (given) {
      const known = new Map(this.cones.map((cone) => [cone.vertex, cone.curvature]));
      this.takeCones(given.map(([vertex, curvature]) => ({ vertex, curvature: curvature ?? known.get(vertex) ?? NaN })));
    } else if (level && (n === null || level.n === n)) {
      this.takeCones(level.cones.map(([vertex, curvature]) => ({ vertex, curvature: curvature ?? NaN })));
      this.predicted = level.predicted_area;
    } else return;
    this.view?.showSeams(preview?.seams ?? []);
    this.showCones();
  }

  private previewsHere(): Map<number, Preview> {
    const { cut, avoid } = this.question;
    const of = this.methodKey() + JSON.stringify([cut, avoid]);
    if (of !== this.previews.of) this.previews.found.clear();
    this.previews.of = of;
    return this.previews.found;
  }

  /** Finds the seams of other numbers of cones while nothing else is to be done, the nearest first: the slider shows them at once then. */
  private async prepare(serial: number, signal: AbortSignal): Promise<void> {
    const { question } = this;
    const known = this.previewsHere();
    const away = ({ n }: ForeseenLevel) => Math.abs(n - this.count());
    for (const level of (this.foreseen()?.levels ?? []).toSorted((a, b) => away(a) - away(b))) {
      if (known.has(level.n)) continue;
      while (this.isHeld || performance.now() - this.moved < HELD) await new Promise((done) => setTimeout(done, HELD));
      if (serial !== this.serial) return;
      const found = await this.source.preview(withCones(question, level), serial, signal);
      if (serial !== this.serial) return;
      known.set(level.n, found);
    }
  }

  private async ask(serial: number, signal: AbortSignal): Promise<void> {
    const question = { ...this.question };
    const isNewest = () => serial === this.serial;
    const fail = (error: unknown) => {
      if (!isNewest() || error instanceof Replaced) return;
      const told = String((error as Error).message ?? error);
      // What cannot be had is not chosen: the choice before it stands again.
      const before = error instanceof Refused ? this.history.drop() : undefined;
      if (before) {
        this.question = before;
        return this.restart(told);
      }
      page.status(told, "failed");
      void this.learn();
    };
    const early = this.early(question);
    const preview = early && this.source.preview(early, serial, signal).then((found) => {
      if (!isNewest()) return;
      if (this.source.isLive && !question.given) this.previewsHere().set(found.cones.length, found);
      // A map that was made before may be there first.
      if (this.mapIsOf(question)) return;
      this.predicted = found.predicted;
      this.takeCones(found.cones);
      this.showCones();
      this.view?.showSeams(found.seams);
    });
    const map = this.source.map(question, serial, signal).then(async (map) => {
      if (!isNewest()) return;
      this.takeMap(map, question);
      // Whoever measures wants the processor that what draws may need.
      await Promise.all([this.view?.stage.drawn(), this.atlas.drawn()]);
      document.body.dataset.maps = String(Number(document.body.dataset.maps ?? 0) + 1);
      if (!isNewest()) return;
      const learnt = this.learn();
      if (!map.measured) {
        const measured = await this.source.measured(question, serial, signal);
        if (!isNewest()) return;
        this.takeMeasures({ ...map, measured }, question);
      }
      await learnt;
      if (this.source.isLive && isNewest()) await this.prepare(serial, signal).catch(() => {});
    });
    // Cones that cannot be had are told of by both.
    await Promise.all([preview?.catch((error) => this.source.isLive || fail(error)), map.catch(fail)]);
  }

  /** What to ask for a preview of: cones that are known cost little. */
  private early(question: Question): Question | null {
    // What else was done to the surface only a map tells.
    if (question.recipe !== null) return null;
    if (!this.source.isLive || question.given) return question;
    const level = this.level();
    return level && !this.previewsHere().has(level.n) ? withCones(question, level) : null;
  }

  private mapIsOf(question: Question): boolean {
    return this.mapOf === JSON.stringify(question);
  }

  private takeMap(map: UvMap, question: Question): void {
    this.map = map;
    const isNear = this.isNear(map, question);
    // The first one is waited for.
    const isPatient = this.mapOf !== "";
    this.mapOf = JSON.stringify(question);
    if (!isNear) {
      this.takeCones(map.cones);
      this.view?.showSeams(map.seams);
    }
    // What was predicted until now is that of other cones, or may be.
    this.predicted = null;
    this.stale(false);
    const extent = geometry.extent(map.uv);
    this.grid = null;
    const squares = checkerSquares(map.uv);
    this.view?.coordinates(map.uv, squares, isPatient);
    this.drawn = outline(this.surface, this.corners, this.boundary, map);
    this.atlas.show(map.uv, squares, this.drawn, extent, this.isDark, isPatient);
    const badge = byId("badge");
    badge.hidden = !isNear;
    badge.textContent = `the map with ${counted(map.cones.length, "cone", "cones")}`;
    // Colours of what is not measured yet come with the measures.
    if (map.measured || !isOfMeasures(this.mode)) this.colour(this.mode, isPatient);
    this.showControls();
    this.showCones();
    page.warnings([...new Set([...this.surface.warnings, ...map.meta.warnings])]);
    if (map.measured) this.takeMeasures(map, question);
    else this.tell("measuring the map …", "busy");
    this.mark(this.pinned, this.pinned);
  }

  /** What the map is like. */
  private takeMeasures(map: UvMap, question: Question): void {
    this.map = map;
    this.predicted = map.measured!.meta.predicted;
    const isNear = this.isNear(map, question);
    if (!isNear && !question.given) this.measuredHere().set(map.cones.length, map.measured!.meta.distortion.area_mean);
    if (isOfMeasures(this.mode)) this.colour(this.mode, true);
    else this.showLegend();
    this.showCurve();
    if (this.marked) this.mark(this.marked === this.pinned ? null : this.marked);
    this.tell(isNear ? `no map is stored for ${counted(question.n ?? 0, "cone", "cones")}` : "exact map");
    this.isAsking = false;
  }

  /** Whether a map is that of another number of cones, for want of one. */
  private isNear(map: UvMap, question: Question): boolean {
    return !this.source.isLive && question.n !== null && map.cones.length !== question.n;
  }

  /** What is foreseen of the method's cones. */
  private foreseen(): Foreseen | undefined {
    return this.known.get(this.methodKey());
  }

  /** The chosen number of cones; where none is chosen, as few as promise little distortion. */
  private level(): ForeseenLevel | undefined {
    const { n } = this.question;
    return this.foreseen()?.levels.find((level) => (n === null ? level.predicted_area <= TARGET : level.n === n));
  }

  private methodKey(): string {
    const { method, angles } = this.question;
    return JSON.stringify([method, angles]);
  }

  /** How many cones there are: where no number was chosen, those of the map, or those that are foreseen. */
  private count(): number {
    const { n, given } = this.question;
    return given?.length ?? n ?? (this.cones.length || this.surface.least);
  }

  private measuredHere(): Map<number, number> {
    const key = this.methodKey();
    const here = this.measured.get(key) ?? new Map<number, number>();
    this.measured.set(key, here);
    return here;
  }

  /** Asks once for what is foreseen of a method; waits until it is known, or cannot be. */
  private learn(): Promise<void> {
    const key = this.methodKey();
    const asked = this.asked.get(key) ?? this.learnOf(key);
    this.asked.set(key, asked);
    return asked;
  }

  private async learnOf(key: string): Promise<void> {
    const [method, angles] = JSON.parse(key);
    try {
      this.known.set(key, await this.source.foreseen(method, angles));
      if (key !== this.methodKey()) return;
      if (this.mapIsOf(this.question)) this.showCones();
      else this.foresee();
    } catch (error) {
      this.asked.delete(key);
      page.status((error as Error).message, "failed");
    }
  }

  private showCurve(): void {
    this.curve.show(this.foreseen()?.levels ?? null, this.measuredHere(), this.count(), this.surface.most);
    page.numbers(this.mapIsOf(this.question) ? this.map : null, this.predicted);
  }

  private showCones(): void {
    this.view?.showCones(this.cones, this.selectedAt());
    byId<HTMLButtonElement>("remove").disabled = this.selected === null;
    this.showCurve();
    // What is not looked at while the slider moves waits until it rests: a smaller part of the window is drawn so.
    clearTimeout(this.listing);
    if (this.isHeld) this.listing = window.setTimeout(() => this.rest(), REST);
    else this.list();
  }

  /** The slider rests, or is let go. */
  private rest(): void {
    clearTimeout(this.listing);
    this.list();
    this.showCurve();
  }

  /** Tells by its look whether the map that is shown is of another choice. */
  private stale(isStale: boolean): void {
    byId("atlas").classList.toggle("stale", isStale);
  }

  private list(): void {
    this.stale(!this.mapIsOf(this.question));
    page.coneList(this.cones, this.selectedAt(), (v) => this.name(v), (k) => this.select(k));
    this.diagram.show(this.foreseen()?.extrema ?? null, this.cones.map(({ vertex }) => vertex));
  }

  private showControls(): void {
    const { given, method, angles } = this.question;
    const count = this.count();
    for (const id of ["slider", "count"]) {
      const input = byId<HTMLInputElement>(id);
      [input.min, input.max] = [String(this.surface.least), String(this.surface.most)];
      input.value = String(count);
    }
    byId("auto").setAttribute("aria-pressed", String(this.question.n === null && !given));
    byId<HTMLSelectElement>("method").value = given ? "" : method;
    byId<HTMLSelectElement>("angles").value = angles;
    const { cut, avoid } = this.question;
    this.showPins(cut, avoid);
    for (const id of ["unpin", "save-pins"]) byId<HTMLButtonElement>(id).disabled = !cut.length && !avoid.length;
    byId<HTMLButtonElement>("undo").disabled = !this.history.canUndo;
    byId<HTMLButtonElement>("redo").disabled = !this.history.canRedo;
  }

  /** Shows what is pinned, where that or the map is another: the map is drawn anew for it. */
  private showPins(cut: Edge[], avoid: Edge[]): void {
    const { map, pinsShown } = this;
    // The measures of a map come later, with its coordinates as they were.
    if (pinsShown.cut === cut && pinsShown.avoid === avoid && pinsShown.uv === map?.uv) return;
    this.pinsShown = { cut, avoid, uv: map?.uv };
    this.view?.showPins(cut, avoid);
    if (map) this.atlas.showPins(onMap(this.surface, this.corners, map.uv, cut), onMap(this.surface, this.corners, map.uv, avoid));
  }

  private colour(mode: Mode, isPatient = false): void {
    this.mode = mode;
    this.pressMode(mode);
    const paint = mode === "plain" || (mode === "checker" && !this.map) ? "plain" : mode === "checker" ? "checker" : "tint";
    const tint = paint === "tint" ? cornerColours(mode, this.surface, this.map) : new Uint8Array();
    this.view?.colour(paint, tint, isPatient);
    this.atlas.colour(paint, tint, isPatient);
    this.showLegend();
  }

  private showLegend(): void {
    page.legend(this.mode, scale(this.mode, this.surface), this.map?.measured?.meta.islands ?? null);
  }

  private name(vertex: number): number {
    return this.surface.vertex ? this.surface.vertex[vertex] : vertex;
  }

  // Marks

  private mark(place: Place | null, pinned = this.pinned): void {
    this.marked = place ?? pinned;
    this.pinned = pinned;
    this.placeMarks();
    byId("place").textContent = this.marked ? this.describe(this.marked) : "";
  }

  private placeMarks(): void {
    const put = (id: string, at: [number, number] | null, isBehind = false) => {
      const mark = byId(id).querySelector<HTMLElement>(".mark")!;
      mark.hidden = !at;
      if (!at) return;
      mark.style.transform = `translate(${at[0]}px, ${at[1]}px)`;
      mark.classList.toggle("behind", isBehind);
      mark.classList.toggle("pinned", this.marked === this.pinned);
    };
    const seen = this.marked && this.view?.onScreen(this.marked);
    put("surface", seen ? [seen.x, seen.y] : null, seen?.isBehind);
    put("atlas", this.marked && this.map ? this.atlas.toScreen(geometry.uvOf(this.map.uv, this.marked)) : null);
  }

  private describe(place: Place): string {
    const { triangle, weights } = place;
    const { surface, map } = this;
    const phi = weights.reduce((sum, w, k) => sum + w * surface.factor[surface.triangles[3 * triangle + k]], 0);
    const vertex = geometry.vertexOf(surface, place);
    const cone = this.cones.find((cone) => cone.vertex === vertex);
    const parts = [`vertex ${this.name(vertex)}`];
    if (cone) parts.push(`cone of ${page.turns(cone.curvature)}`);
    parts.push(`φ ${phi.toFixed(3)}`);
    if (map?.measured) parts.push(`area × ${Math.exp(map.measured.logArea[triangle]).toPrecision(3)}`, `σ₁/σ₂ ${map.measured.stretch[triangle].toFixed(3)}`);
    if (map) parts.push(`island ${map.island[triangle] + 1}`);
    return parts.join("  ·  ");
  }

  // What the user does

  private listen(): void {
    const input = (id: string) => byId<HTMLInputElement>(id);
    const number = (id: string) => Math.min(this.surface.most, Math.max(this.surface.least, Math.round(Number(input(id).value) || 0)));
    input("slider").addEventListener("input", () => {
      page.bound("");
      this.choose({ n: number("slider"), given: null });
    });
    for (const begin of ["pointerdown", "keydown"]) input("slider").addEventListener(begin, () => (this.isHeld = true));
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => this.isHeld && this.release(0));
    for (const end of ["keyup", "blur"]) input("slider").addEventListener(end, () => this.isHeld && this.release(PATIENCE));
    for (const sign of ["pointermove", "pointerdown", "keydown"]) addEventListener(sign, () => (this.moved = performance.now()), true);
    input("count").addEventListener("change", () => {
      const asked = input("count").valueAsNumber;
      if (!Number.isNaN(asked)) this.choose({ n: number("count"), given: null });
      // What was typed may come to the choice that there is.
      this.showControls();
      const { least, most } = this.surface;
      page.bound(asked > most ? `the page shows ${most} at most` : asked < least ? `${least} at least are needed` : "");
    });
    byId("auto").addEventListener("click", () => {
      page.bound("");
      this.choose({ n: null, given: null });
    });
    const method = byId<HTMLSelectElement>("method");
    method.append(new Option("by hand", "", false, false), ...this.surface.methods.map(({ name, description }) => {
      const option = new Option(name, name);
      option.title = description;
      return option;
    }));
    method.options[0].disabled = true;
    const isLive = this.source.isLive;
    document.body.classList.toggle("file", !isLive);
    method.disabled = byId<HTMLSelectElement>("angles").disabled = !isLive;
    method.addEventListener("change", () => this.choose({ method: method.value, given: null, n: this.question.given ? this.cones.length : this.question.n }));
    byId("angles").addEventListener("change", () => this.choose({ angles: byId<HTMLSelectElement>("angles").value, given: this.withoutCurvatures() }));
    byId("undo").addEventListener("click", () => this.go(this.history.undo(this.question)));
    byId("redo").addEventListener("click", () => this.go(this.history.redo(this.question)));
    for (const [id, tool] of TOOLS) byId(id).addEventListener("click", () => this.take(tool));
    for (const id of this.surface.refined ? ["cut", "avoid"] : []) {
      byId<HTMLButtonElement>(id).disabled = true;
      byId(id).title = NO_EDGES;
    }
    byId("unpin").addEventListener("click", () => this.choose({ cut: [], avoid: [] }));
    byId("save-pins").addEventListener("click", () => this.savePins());
    byId("remove").addEventListener("click", () => this.remove());
    for (const kind of ["cones", "obj", "glb"] as const) byId(`save-${kind}`).addEventListener("click", () => void this.save(kind));
    byId("load").addEventListener("click", () => input("file").click());
    input("file").addEventListener("change", () => void this.load(input("file")));
    byId("add").addEventListener("submit", (event) => {
      event.preventDefault();
      this.add(Number(input("vertex").value));
    });
    document.addEventListener("keydown", (event) => this.key(event));
    byId("surface").querySelector(".fit")!.addEventListener("click", () => this.view?.fit());
    byId("atlas").querySelector(".fit")!.addEventListener("click", () => this.atlas.fit());
    this.listenToAtlas(byId("atlas").querySelector("canvas")!);
    if (this.view) this.listenToSurface(this.view);
  }

  private listenToAtlas(canvas: HTMLCanvasElement): void {
    const under = (event: PointerEvent) => {
      if (!this.map) return null;
      this.grid ??= new geometry.MapGrid(this.map.uv, geometry.extent(this.map.uv));
      return this.grid.at(...this.atlas.under(event));
    };
    canvas.addEventListener("pointermove", (event) => event.buttons || this.mark(under(event)));
    canvas.addEventListener("pointerleave", () => this.mark(null));
    onClick(canvas, (event) => {
      const place = under(event);
      const vertex = this.tool ? this.vertexOnMap(event, place) : null;
      if (vertex !== null) return this.use(vertex);
      if (place) this.view?.face(place);
      this.mark(place, place);
    });
    canvas.addEventListener("dblclick", (event) => this.pinSeam(this.vertexOnMap(event, null)));
    this.atlas.onDrawn = () => this.placeMarks();
  }

  private listenToSurface(view: SurfaceView): void {
    const { canvas, controls } = view.stage;
    canvas.addEventListener("pointerdown", (event) => {
      if (this.tool !== "cones" || !event.isPrimary) return;
      const k = view.coneUnder(event, view.under(event));
      if (k === null) return;
      this.dragged = { k, isMoved: false, otherwise: this.cones };
      controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
      this.select(k);
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      const { dragged } = this;
      const place = !dragged && event.buttons ? null : view.under(event);
      const vertex = dragged && place && this.nearestUsable(geometry.vertexOf(this.surface, place));
      if (dragged && vertex !== null) {
        dragged.isMoved = true;
        this.selected = vertex;
        this.cones = this.cones.with(dragged.k, { ...this.cones[dragged.k], vertex });
        view.showCones(this.cones, dragged.k);
      }
      if (!event.buttons) this.mark(place);
    });
    for (const end of ["pointerup", "pointercancel"] as const) {
      canvas.addEventListener(end, () => {
        controls.enabled = true;
        this.letGo(end === "pointerup");
      });
    }
    canvas.addEventListener("pointerleave", () => this.mark(null));
    onClick(canvas, (event) => {
      const place = view.under(event);
      if (!place || !this.tool) this.mark(place, place);
      else if (this.tool !== "cones" || view.coneUnder(event, place) === null) this.use(geometry.vertexOf(this.surface, place));
    });
    canvas.addEventListener("dblclick", (event) => {
      const place = view.under(event);
      if (place) this.pinSeam(geometry.vertexOf(this.surface, place));
    });
    view.stage.onDrawn = () => this.placeMarks();
  }

  /** The vertex of the map under an event: one on a seam or a boundary that is near, else the nearest of the triangle there. */
  private vertexOnMap(event: { clientX: number; clientY: number }, place: Place | null): number | null {
    const { map, drawn, surface } = this;
    if (!map || !drawn) return null;
    const box = byId("atlas").getBoundingClientRect();
    let [nearest, found]: [number, number | null] = [REACH, null];
    for (const corner of drawn.corners) {
      for (const c of [corner, geometry.follow(corner)]) {
        const [x, y] = this.atlas.toScreen([map.uv[2 * c], map.uv[2 * c + 1]]);
        const away = Math.hypot(x + box.left - event.clientX, y + box.top - event.clientY);
        if (away < nearest) [nearest, found] = [away, surface.triangles[c]];
      }
    }
    return found ?? (place && geometry.vertexOf(surface, place));
  }

  /** Does at a vertex what the tool is for. */
  private use(vertex: number): void {
    if (this.tool === "cones") this.add(this.name(this.nearestUsable(vertex) ?? vertex));
    else if (this.tool) this.pin(this.tool, vertex);
  }

  /** The vertex nearest to one that can be a cone. */
  private nearestUsable(vertex: number): number | null {
    const { usable } = this.surface;
    return usable ? geometry.nearestVertex(this.surface, this.corners, vertex, (v) => usable[v] > 0) : vertex;
  }

  /** Ends a drag: the cone stays where it is, or all are as if it had not been dragged. */
  private letGo(isMeant: boolean): void {
    const { dragged } = this;
    if (!dragged) return;
    this.dragged = null;
    if (dragged.isMoved && isMeant) return this.chooseCones(this.cones, this.cones[dragged.k].vertex);
    this.takeCones(dragged.otherwise);
    this.showCones();
  }

  private key(event: KeyboardEvent): void {
    const isTyping = event.target instanceof HTMLInputElement && event.target.type === "number";
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      this.go(event.shiftKey ? this.history.redo(this.question) : this.history.undo(this.question));
    } else if ((event.ctrlKey || event.metaKey) && event.key === "y") {
      event.preventDefault();
      this.go(this.history.redo(this.question));
    } else if (event.key === "Escape") {
      this.selected = this.chainEnd = null;
      this.mark(null, null);
      this.showCones();
    } else if (event.key === "f" && !isTyping && !event.ctrlKey && !event.metaKey && !(event.target instanceof HTMLCanvasElement)) {
      // A view that has the focus fits itself.
      this.view?.fit();
      this.atlas.fit();
    } else if (isTyping || event.ctrlKey || event.metaKey || event.altKey || !this.source.isLive) return;
    else if (event.key in KEYS && !(event.target instanceof HTMLSelectElement)) this.take(KEYS[event.key]);
    else if (event.key === "Delete" && this.selected !== null) this.remove();
  }

  // Cones by hand

  /** Takes a tool, or lays it down. */
  private take(tool: "cones" | pins.Pin): void {
    if (this.surface.refined && tool !== "cones") return page.status(NO_EDGES, "failed");
    this.tool = this.tool === tool ? "" : tool;
    this.chainEnd = null;
    for (const [id, one] of TOOLS) byId(id).setAttribute("aria-pressed", String(one === this.tool));
    page.hint(this.tool && HINTS[this.tool]);
    for (const canvas of document.querySelectorAll("canvas")) canvas.style.cursor = this.tool ? "crosshair" : "";
  }

  private select(k: number): void {
    const { vertex } = this.cones[k];
    this.selected = this.selected === vertex && this.tool !== "cones" ? null : vertex;
    this.showCones();
    const corner = this.corners.corner[this.corners.start[vertex]];
    const weights = [0, 1, 2].map((i) => Number(i === corner % 3)) as geometry.Vec3;
    const place = { triangle: Math.floor(corner / 3), weights };
    if (this.tool !== "cones") this.view?.face(place);
    this.mark(place, place);
  }

  private add(vertex: number): void {
    const { start } = this.corners;
    if (!(start[vertex] < start[vertex + 1])) {
      return page.status(`cone ${vertex} is not a vertex of any face (vertices are numbered from 0 to ${start.length - 2})`, "failed");
    }
    const { usable } = this.surface;
    if (usable && !usable[vertex]) return page.status(`no cone can be at vertex ${vertex}: the even triangles that maps are computed on do not have it`, "failed");
    if (this.cones.some((cone) => cone.vertex === vertex)) return;
    this.chooseCones([...this.cones, { vertex, curvature: NaN }], vertex);
  }

  /** Takes cones by hand, and selects the one that was added or moved: it may be removed at once. */
  private chooseCones(cones: Cone[], selected: number): void {
    this.choose({ given: this.free(cones) });
    this.selected = selected;
    this.showCones();
  }

  private remove(): void {
    if (this.selected === null) return;
    this.choose({ given: this.free(this.cones.filter(({ vertex }) => vertex !== this.selected)) });
  }

  /** Cones whose curvatures follow the rule, none twice. */
  private free(cones: Cone[]): [number, null][] {
    return Array.from(new Set(cones.map(({ vertex }) => vertex)), (vertex) => [vertex, null]);
  }

  private withoutCurvatures(): Question["given"] {
    return this.question.given && this.free(this.cones);
  }

  /** Goes on with a chain of edges, or begins one. */
  private pin(pin: pins.Pin, vertex: number): void {
    const from = this.chainEnd;
    this.chainEnd = vertex;
    const now = performance.now();
    this.clicked = { at: now, before: now - this.clicked.at < DOUBLE ? this.clicked.before : this.question };
    const corner = this.corners.corner[this.corners.start[vertex]];
    const place = { triangle: Math.floor(corner / 3), weights: [0, 1, 2].map((i) => Number(i === corner % 3)) as geometry.Vec3 };
    this.mark(place, place);
    if (from === null || from === vertex) return;
    const way = pins.chain(this.surface, this.corners, from, vertex);
    if (way) this.choose(pins.pinned(this.question, pin, way));
    else page.status("no edges lead there: it is another part", "failed");
  }

  /** Pins the seam of the map that a vertex is on, from end to end. */
  private pinSeam(vertex: number | null): void {
    const seam = vertex === null ? undefined : this.map?.seams.find((chain) => chain.includes(vertex));
    if (!seam || !this.tool || this.tool === "cones") return;
    this.chainEnd = null;
    this.takeBackClicks();
    this.choose(pins.pinned(this.question, this.tool, Array.from(seam)));
  }

  /** The clicks that a double click begins with have gone on with a chain, which was not meant. */
  private takeBackClicks(): void {
    const { at, before } = this.clicked;
    if (performance.now() - at > DOUBLE) return;
    while (before && this.question !== before) {
      const last = this.history.drop();
      if (!last) return;
      this.go(last);
    }
  }

  private savePins(): void {
    for (const pin of ["cut", "avoid"] as const) {
      const edges = this.question[pin];
      const name = `${this.surface.name.replace(/(\.\w+)?(\.gz)?$/, "")}-${pin === "cut" ? "seams" : "avoid"}.txt`;
      if (edges.length) page.save(new Blob([pins.text(pin, edges)]), name);
    }
  }

  private async load(input: HTMLInputElement): Promise<void> {
    const [file] = input.files ?? [];
    input.value = "";
    if (!file) return;
    try {
      const text = await file.text();
      const edges = pins.read(text, this.surface, this.corners);
      if (edges) return this.choose({ [edges.pin]: edges.edges });
      const given = page.readCones(text);
      if (!given.length && !text.includes("#:")) throw new Error("the file lists no cone");
      const least = this.surface.points.length / 3;
      if (given.some(([vertex]) => vertex >= least)) throw new Error("the file's cones are of another surface");
      this.choose({ given, recipe: text });
    } catch (error) {
      page.status(`${file.name}: ${(error as Error).message}`, "failed");
    }
  }

  private async save(kind: "cones" | "obj" | "glb"): Promise<void> {
    const name = this.surface.name.replace(/(\.\w+)?(\.gz)?$/, "");
    try {
      const blob = await this.source.save(kind, this.question);
      page.save(blob, kind === "cones" ? `${name}-cones.txt` : `${name}-uv.${kind}`);
    } catch (error) {
      page.status(`not saved: ${(error as Error).message}`, "failed");
    }
  }
}

/** The same question with the cones of a level, whose curvatures follow the rule. */
function withCones(question: Question, { cones }: ForeseenLevel): Question {
  return { ...question, given: cones.map(([vertex]) => [vertex, null]), recipe: null };
}

/** Whether a colour tells what is measured of a map. */
function isOfMeasures(mode: Mode): boolean {
  return mode === "area" || mode === "stretch";
}

/** So many squares to a unit of the map that they are small against its islands, as in pictures. */
function checkerSquares(uv: Float32Array): number {
  let area = 0;
  for (let k = 0; k < uv.length; k += 6) {
    area += Math.abs((uv[k + 2] - uv[k]) * (uv[k + 5] - uv[k + 1]) - (uv[k + 3] - uv[k + 1]) * (uv[k + 4] - uv[k]));
  }
  return 2 * Math.round(Math.min(128, Math.max(32, 30 / Math.sqrt(Math.max(1e-4, area / 2)))) / 2);
}

stored()
  .then(async (data) => {
    if (data?.meta.field) return new FieldApp(data);
    page.status("reading the surface …", "busy");
    const from = source(data);
    return new App(from, await from.surface());
  })
  .catch((error: Error) => page.status(error.message, "failed"));
