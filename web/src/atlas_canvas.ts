// The map on a plain canvas, where there is no WebGL: slower, the same otherwise.

import { type Atlas, tiles } from "./atlas_view";
import { CHECKER, PLAIN, css } from "./colours";
import { CUT, SPARED, coneColour } from "./geometry";
import type { Paint } from "./mesh_geometry";
import type { Outline } from "./outline";

export class AtlasCanvas implements Atlas {
  onDrawn = () => {};
  private readonly context: CanvasRenderingContext2D;
  private uv: Float32Array = new Float32Array();
  private tint: Uint8Array = new Uint8Array();
  private paintedWith: Paint = "plain";
  private squares = 32;
  private outline: Outline = { segments: new Float32Array(), corners: new Uint32Array(), cones: [] };
  private pins: Float32Array[] = [new Float32Array(), new Float32Array()];
  private extent: [number, number] = [1, 1];
  private isDark = false;
  private centre: [number, number] = [0.5, 0.5];
  private zoom = 1;
  private isAsked = false;

  constructor(private readonly element: HTMLElement, private readonly canvas: HTMLCanvasElement) {
    this.context = canvas.getContext("2d")!;
    new ResizeObserver(() => this.draw()).observe(element);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [x, y] = this.under(event);
      const factor = Math.exp(-0.0015 * event.deltaY);
      this.zoom = Math.min(400, Math.max(0.3, this.zoom * factor));
      this.centre = [x + (this.centre[0] - x) / factor, y + (this.centre[1] - y) / factor];
      this.draw();
    }, { passive: false });
    canvas.addEventListener("pointermove", (event) => {
      if (!event.buttons) return;
      const pixels = this.pixels();
      this.centre = [this.centre[0] - event.movementX / pixels, this.centre[1] + event.movementY / pixels];
      this.draw();
    });
    canvas.addEventListener("keydown", (event) => {
      const step = 0.1 / this.zoom;
      const [x, y] = this.centre;
      if (event.key === "ArrowLeft") this.centre = [x - step, y];
      else if (event.key === "ArrowRight") this.centre = [x + step, y];
      else if (event.key === "ArrowUp") this.centre = [x, y + step];
      else if (event.key === "ArrowDown") this.centre = [x, y - step];
      else if (event.key === "+" || event.key === "=") this.zoom *= 1.2;
      else if (event.key === "-") this.zoom /= 1.2;
      else if (event.key === "f" || event.key === "Home") return this.fit();
      else return;
      event.preventDefault();
      this.draw();
    });
  }

  fit(): void {
    this.zoom = 1;
    this.centre = [0.5 * this.extent[0], 0.5 * this.extent[1]];
    this.draw();
  }

  colour(paint: Paint, tint: Uint8Array): void {
    [this.tint, this.paintedWith] = [tint, paint];
    this.draw();
  }

  show(uv: Float32Array, squares: number, outline: Outline, extent: [number, number], isDark: boolean): void {
    Object.assign(this, { uv, squares, outline, extent, isDark });
    this.draw();
  }

  theme(isDark: boolean): void {
    this.isDark = isDark;
    this.draw();
  }

  showPins(...pins: [Float32Array, Float32Array]): void {
    this.pins = pins;
    this.draw();
  }

  under(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    const pixels = this.pixels();
    const [x, y] = [event.clientX - box.left - box.width / 2, event.clientY - box.top - box.height / 2];
    return [this.centre[0] + x / pixels, this.centre[1] - y / pixels];
  }

  toScreen([x, y]: [number, number]): [number, number] {
    const pixels = this.pixels();
    return [this.element.clientWidth / 2 + (x - this.centre[0]) * pixels, this.element.clientHeight / 2 - (y - this.centre[1]) * pixels];
  }

  /** Pixels for a unit of the map. */
  private pixels(): number {
    const { clientWidth, clientHeight } = this.element;
    return (this.zoom * Math.min(clientWidth / this.extent[0], clientHeight / this.extent[1])) / 1.08;
  }

  drawn(): Promise<void> {
    return new Promise((done) => requestAnimationFrame(() => done()));
  }

  private draw(): void {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.paint();
      this.onDrawn();
    });
  }

  private paint(): void {
    const { canvas, context, element } = this;
    const ratio = devicePixelRatio;
    canvas.width = Math.max(1, element.clientWidth * ratio);
    canvas.height = Math.max(1, element.clientHeight * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (this.paintedWith === "checker") this.paintChecker();
    else this.paintTriangles();
    this.stroke(tiles(this.extent), this.isDark ? "#4a5160" : "#aab0bb", 1);
    this.stroke(this.outline.segments, this.isDark ? "#e6e8ee" : "#1d212b", 1.6);
    [CUT, SPARED].forEach((colour, k) => this.stroke(this.pins[k], hex(colour), 3.4));
    for (const { at, cone } of this.outline.cones) {
      context.fillStyle = hex(coneColour(cone.curvature));
      context.beginPath();
      context.arc(...this.toScreen(at), 5, 0, 2 * Math.PI);
      context.fill();
    }
  }

  private paintTriangles(): void {
    const { context, tint, uv } = this;
    for (let k = 0; k < uv.length; k += 6) {
      const at = (3 * k) / 2;
      context.fillStyle = context.strokeStyle = css(this.paintedWith === "plain" ? PLAIN : [tint[at], tint[at + 1], tint[at + 2]]);
      context.beginPath();
      this.trace(k);
      context.fill();
      // Without it the paper shines through between triangles.
      context.stroke();
    }
  }

  private paintChecker(): void {
    const { context, uv } = this;
    const tile = document.createElement("canvas");
    tile.width = tile.height = 2;
    const two = tile.getContext("2d")!;
    for (let k = 0; k < 4; k++) {
      two.fillStyle = css(CHECKER[((k & 1) + (k >> 1)) & 1]);
      two.fillRect(k & 1, k >> 1, 1, 1);
    }
    const pattern = context.createPattern(tile, "repeat")!;
    const [left, top] = this.toScreen([0, 0]);
    const size = this.pixels() / this.squares;
    pattern.setTransform(new DOMMatrix([size, 0, 0, size, left, top]));
    context.imageSmoothingEnabled = false;
    context.fillStyle = pattern;
    context.beginPath();
    for (let k = 0; k < uv.length; k += 6) this.trace(k);
    context.fill();
  }

  private trace(k: number): void {
    const { context, uv } = this;
    context.moveTo(...this.toScreen([uv[k], uv[k + 1]]));
    for (let i = 2; i < 6; i += 2) context.lineTo(...this.toScreen([uv[k + i], uv[k + i + 1]]));
    context.closePath();
  }

  private stroke(segments: Float32Array, style: string, width: number): void {
    const { context } = this;
    context.strokeStyle = style;
    context.lineWidth = width;
    context.beginPath();
    for (let k = 0; k < segments.length; k += 4) {
      context.moveTo(...this.toScreen([segments[k], segments[k + 1]]));
      context.lineTo(...this.toScreen([segments[k + 2], segments[k + 3]]));
    }
    context.stroke();
    context.lineWidth = 1;
  }
}

function hex(colour: number): string {
  return `#${colour.toString(16).padStart(6, "0")}`;
}
