// A canvas that three.js draws on when something has changed, and that the mouse, fingers and keys look around in.

import { type Camera, MOUSE, PerspectiveCamera, Scene, TOUCH, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Backdrop } from "./backdrop";

/** A backdrop of more triangles than these is drawn quickly where there is no graphics card: it takes 40 ms in place of 100 then. */
const LARGE = 100_000;
/** What draws without a graphics card calls itself. */
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

export class Stage<C extends Camera> {
  /** What is drawn each time, and behind that what is kept. */
  readonly scene = new Scene();
  readonly backdrop: Backdrop;
  readonly controls: OrbitControls;
  /** Whether what is before the backdrop is a part of it, so that both are shown at once. */
  isOnePiece = false;
  width = 1;
  height = 1;
  /** Called after each picture. */
  onDrawn = () => {};
  /** Called when the window's size has changed. */
  onResize = () => {};
  private readonly renderer: WebGLRenderer;
  private isAsked = false;
  private readonly awaited: (() => void)[] = [];

  /** A stage on a canvas that has a [context](webGl), for a backdrop of so many triangles. */
  constructor(readonly element: HTMLElement, readonly canvas: HTMLCanvasElement, readonly camera: C, triangles: number) {
    const context = webGl(canvas)!;
    this.backdrop = new Backdrop(triangles > LARGE && isSoftware(context));
    this.scene.add(this.backdrop.picture);
    this.renderer = new WebGLRenderer({ canvas, context });
    // They are known to be right; to ask is to wait for all that is being drawn.
    this.renderer.debug.checkShaderErrors = false;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.controls = new OrbitControls(camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.enableRotate = camera instanceof PerspectiveCamera;
    this.controls.screenSpacePanning = true;
    if (!this.controls.enableRotate) {
      this.controls.mouseButtons = { LEFT: MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: MOUSE.PAN };
      this.controls.touches = { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_PAN };
    }
    this.controls.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(element);
    this.resize();
  }

  /** Asks for a picture, in which everything may have changed; where drawing takes long a patient one is seen some frames later. */
  draw(isPatient = false): void {
    this.backdrop.change(isPatient);
    this.drawFront();
  }

  /** Asks for a picture with the same backdrop. */
  drawFront(): void {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      const isMore = this.backdrop.update(this.renderer, this.camera);
      if (!(isMore && this.isOnePiece)) {
        this.renderer.render(this.scene, this.camera);
        this.onDrawn();
      }
      if (isMore) this.drawFront();
      else this.awaited.splice(0).forEach((done) => done());
    });
  }

  /** Waits until all is drawn that has been asked for, which is later than that it is sent to be. */
  async drawn(): Promise<void> {
    await new Promise<void>((done) => {
      this.awaited.push(done);
      this.drawFront();
    });
    const context = this.renderer.getContext() as WebGL2RenderingContext;
    const fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
    context.flush();
    while (fence && !context.isContextLost() && context.getSyncParameter(fence, context.SYNC_STATUS) !== context.SIGNALED) {
      await new Promise((done) => setTimeout(done, 8));
    }
    context.deleteSync(fence);
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

  /** How many pixels the canvas is high. */
  get pixelsHigh(): number {
    return this.height * this.renderer.getPixelRatio();
  }

  private resize(): void {
    const [width, height] = [Math.max(1, this.element.clientWidth), Math.max(1, this.element.clientHeight)];
    if (width === this.width && height === this.height) return;
    [this.width, this.height] = [width, height];
    this.renderer.setSize(width, height, false);
    this.onResize();
    this.draw();
  }
}

/** What a canvas is drawn on with; none where there is no WebGL. Asked again it is the same, however smooth. */
export function webGl(canvas: HTMLCanvasElement, isSmooth = true): WebGL2RenderingContext | null {
  try {
    return canvas.getContext("webgl2", { alpha: true, antialias: isSmooth });
  } catch {
    return null;
  }
}

function isSoftware(context: WebGL2RenderingContext): boolean {
  const names = context.getExtension("WEBGL_debug_renderer_info");
  return SOFTWARE.test(String(context.getParameter(names?.UNMASKED_RENDERER_WEBGL ?? context.RENDERER)));
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
