// A canvas that three.js draws on when something has changed, and that the mouse, fingers and keys look around in.

import { type Camera, MOUSE, Scene, TOUCH, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Backdrop } from "./backdrop";

export class Stage<C extends Camera> {
  /** What is drawn each time, and behind that what is kept. */
  readonly scene = new Scene();
  readonly backdrop = new Backdrop();
  readonly controls: OrbitControls;
  width = 1;
  height = 1;
  /** Called after each picture. */
  onDrawn = () => {};
  /** Called when the window's size has changed. */
  onResize = () => {};
  private readonly renderer: WebGLRenderer;
  private isAsked = false;

  constructor(readonly element: HTMLElement, readonly canvas: HTMLCanvasElement, readonly camera: C, turns: boolean) {
    this.scene.add(this.backdrop.picture);
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.controls = new OrbitControls(camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.enableRotate = turns;
    this.controls.screenSpacePanning = true;
    if (!turns) {
      this.controls.mouseButtons = { LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
      this.controls.touches = { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN };
    }
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
  }

  /** Asks for a picture, in which everything may have changed. */
  draw(): void {
    this.backdrop.change();
    this.drawFront();
  }

  /** Asks for a picture with the same backdrop. */
  drawFront(): void {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.backdrop.update(this.renderer, this.camera);
      this.renderer.render(this.scene, this.camera);
      this.onDrawn();
    });
  }

  /** Where a point is in the element, in pixels. */
  toScreen(point: Vector3): [number, number] {
    const { x, y } = point.clone().project(this.camera);
    return [(0.5 + 0.5 * x) * this.width, (0.5 - 0.5 * y) * this.height];
  }

  /** Where an event is, from -1 to 1. */
  fromEvent(event: { clientX: number; clientY: number }): [number, number] {
    const box = this.canvas.getBoundingClientRect();
    return [(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height];
  }

  private resize(): void {
    this.width = Math.max(1, this.element.clientWidth);
    this.height = Math.max(1, this.element.clientHeight);
    this.renderer.setSize(this.width, this.height, false);
    this.onResize();
    this.draw();
  }
}

/** Whether pictures can be drawn with WebGL here. */
export function hasWebGl(): boolean {
  try {
    return document.createElement("canvas").getContext("webgl2") !== null;
  } catch {
    return false;
  }
}

/** Calls back for a press that is no drag. */
export function onClick(canvas: HTMLCanvasElement, act: (event: PointerEvent) => void): void {
  let down: PointerEvent | null = null;
  canvas.addEventListener("pointerdown", (event) => (down = event.isPrimary ? event : null));
  canvas.addEventListener("pointerup", (event) => {
    if (down && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5) act(event);
    down = null;
  });
}
