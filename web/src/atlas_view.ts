// The map in the plane.

import { CircleGeometry, Color, InstancedMesh, Matrix4, MeshBasicMaterial, OrthographicCamera, Vector3 } from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { CUT, SPARED, coneColour } from "./geometry";
import type { Surface } from "./data";
import { type Paint, TriangleMesh } from "./mesh_geometry";
import { meshMaterial } from "./mesh_material";
import type { Outline } from "./outline";
import { Stage } from "./stage";

/** What shows a map: WebGL, or a plain canvas where that is missing. */
export interface Atlas {
  fit(): void;
  colour(paint: Paint, tint: Uint8Array, isPatient?: boolean): void;
  show(uv: Float32Array, squares: number, outline: Outline, extent: [number, number], isDark: boolean, isPatient: boolean): void;
  theme(isDark: boolean): void;
  /** Edges that are pinned, both sides of each: those that are cut, and those that are not. */
  showPins(cut: Float32Array, avoid: Float32Array): void;
  /** The point of the map under an event. */
  under(event: { clientX: number; clientY: number }): [number, number];
  toScreen(at: [number, number]): [number, number];
  /** Waits until all is drawn that has been asked for. */
  drawn(): Promise<void>;
  onDrawn: () => void;
}

const DISC = 5.5;
const INK = [0x1d212b, 0xe6e8ee];
const FRAME = [0xaab0bb, 0x4a5160];

export class AtlasView implements Atlas {
  onDrawn = () => {};
  private readonly stage: Stage<OrthographicCamera>;
  private readonly material = meshMaterial(false);
  private readonly lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: 1.6 }));
  private readonly frame = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: 1 }));
  private readonly pins = [CUT, SPARED].map((color) => new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ color, linewidth: 3.4 })));
  private readonly triangles: TriangleMesh;
  private discs: InstancedMesh | null = null;
  private outline: Outline = { segments: new Float32Array(), corners: new Uint32Array(), cones: [] };
  private extent: [number, number] = [1, 1];

  constructor(element: HTMLElement, canvas: HTMLCanvasElement, surface: Surface) {
    this.stage = new Stage(element, canvas, new OrthographicCamera(0, 1, 1, 0, -10, 10), surface.triangles.length / 3);
    this.triangles = new TriangleMesh(surface, this.material);
    this.stage.backdrop.scene.add(this.triangles.mesh);
    for (const [k, one] of this.allLines.entries()) {
      one.frustumCulled = false;
      one.renderOrder = k + 1;
      one.material.depthTest = false;
      this.stage.scene.add(one);
    }
    this.showPins(new Float32Array(), new Float32Array());
    (this.material as { depthTest: boolean }).depthTest = false;
    this.stage.isOnePiece = true;
    this.stage.onResize = () => this.resize();
    this.stage.onDrawn = () => this.onDrawn();
    this.stage.controls.minZoom = 0.3;
    this.stage.controls.maxZoom = 400;
    this.stage.controls.addEventListener("change", () => this.placeDiscs());
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.resize();
    this.fit();
  }

  fit(): void {
    const { camera, controls } = this.stage;
    camera.zoom = 1;
    camera.updateProjectionMatrix();
    controls.target.set(0.5 * this.extent[0], 0.5 * this.extent[1], 0);
    camera.position.set(0.5 * this.extent[0], 0.5 * this.extent[1], 5);
    controls.update();
    this.resize();
    this.stage.draw();
  }

  colour(paint: Paint, tint: Uint8Array, isPatient = false): void {
    this.triangles.paint(paint, tint);
    this.stage.draw(isPatient);
  }

  drawn(): Promise<void> {
    return this.stage.drawn();
  }

  show(uv: Float32Array, squares: number, outline: Outline, extent: [number, number], isDark: boolean, isPatient: boolean): void {
    const position = (corner: number, into: Float32Array, at: number) => {
      for (let i = 0; i < 2; i++) into[at + i] = uv[2 * corner + i];
    };
    this.triangles.shape({ position, normals: null, coordinates: uv });
    this.material.uniforms.squares.value = squares;
    this.outline = outline;
    segments(this.lines, outline.segments);
    const isOther = extent[0] !== this.extent[0] || extent[1] !== this.extent[1];
    this.extent = extent;
    segments(this.frame, tiles(extent));
    this.theme(isDark);
    this.makeDiscs();
    if (isOther) this.fit();
    this.stage.draw(isPatient);
  }

  showPins(...pins: [Float32Array, Float32Array]): void {
    this.pins.forEach((lines, k) => segments(lines, pins[k]));
    this.stage.drawFront();
  }

  /** The lowest first. */
  private get allLines() {
    return [this.frame, this.lines, ...this.pins];
  }

  theme(isDark: boolean): void {
    this.lines.material.color.set(INK[Number(isDark)]);
    this.frame.material.color.set(FRAME[Number(isDark)]);
    this.stage.drawFront();
  }

  under(event: { clientX: number; clientY: number }): [number, number] {
    const { x, y } = new Vector3(...this.stage.fromEvent(event), 0).unproject(this.stage.camera);
    return [x, y];
  }

  toScreen([x, y]: [number, number]): [number, number] {
    return this.stage.toScreen(new Vector3(x, y, 0));
  }

  private makeDiscs(): void {
    const { cones } = this.outline;
    if (!this.discs || this.discs.instanceMatrix.count < cones.length) {
      if (this.discs) {
        this.stage.scene.remove(this.discs);
        this.discs.geometry.dispose();
        this.discs.dispose();
      }
      this.discs = new InstancedMesh(new CircleGeometry(1, 24), new MeshBasicMaterial({ depthTest: false }), Math.max(256, 2 * cones.length));
      this.discs.frustumCulled = false;
      this.discs.renderOrder = 8;
      this.stage.scene.add(this.discs);
    }
    cones.forEach(({ cone }, k) => this.discs!.setColorAt(k, new Color(coneColour(cone.curvature))));
    this.discs.count = cones.length;
    if (this.discs.instanceColor) this.discs.instanceColor.needsUpdate = true;
    this.placeDiscs();
  }

  /** Discs keep their size on the screen. */
  private placeDiscs(): void {
    if (!this.discs) return;
    const { camera, height } = this.stage;
    const crowd = Math.min(1, Math.sqrt(120 / Math.max(1, this.outline.cones.length)));
    const radius = (DISC * crowd * (camera.top - camera.bottom)) / camera.zoom / height;
    this.outline.cones.forEach(({ at }, k) => this.discs!.setMatrixAt(k, new Matrix4().makeScale(radius, radius, 1).setPosition(at[0], at[1], 0)));
    this.discs.instanceMatrix.needsUpdate = true;
  }

  private resize(): void {
    const { camera, width, height } = this.stage;
    const half = 0.54 * Math.max(this.extent[1], (this.extent[0] * height) / width);
    [camera.top, camera.bottom, camera.right, camera.left] = [half, -half, (half * width) / height, (-half * width) / height];
    camera.updateProjectionMatrix();
    for (const lines of this.allLines) lines.material.resolution.set(width, height);
    this.placeDiscs();
  }

  private key(event: KeyboardEvent): void {
    const { camera, controls } = this.stage;
    const step = 0.1 / camera.zoom;
    const moves: Record<string, [number, number]> = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
    if (event.key in moves) {
      const [x, y] = moves[event.key];
      const shift = new Vector3(x, y, 0);
      camera.position.add(shift);
      controls.target.add(shift);
    } else if (event.key === "+" || event.key === "=") camera.zoom = Math.min(400, camera.zoom * 1.2);
    else if (event.key === "-") camera.zoom = Math.max(0.3, camera.zoom / 1.2);
    else if (event.key === "f" || event.key === "Home") return this.fit();
    else return;
    event.preventDefault();
    camera.updateProjectionMatrix();
    controls.update();
    this.placeDiscs();
    this.stage.draw();
  }
}

function segments(lines: LineSegments2, flat: Float32Array): void {
  const positions = new Float32Array(1.5 * flat.length);
  for (let k = 0; 2 * k < flat.length; k++) {
    positions[3 * k] = flat[2 * k];
    positions[3 * k + 1] = flat[2 * k + 1];
  }
  lines.geometry.dispose();
  lines.geometry = new LineSegmentsGeometry();
  if (positions.length) lines.geometry.setPositions(positions);
  lines.visible = positions.length > 0;
}

/** The borders of the tiles. */
export function tiles([across, up]: [number, number]): Float32Array {
  const all: number[] = [];
  for (let k = 0; k <= across; k++) all.push(k, 0, k, up);
  for (let k = 0; k <= up; k++) all.push(0, k, across, k);
  return Float32Array.from(all);
}
