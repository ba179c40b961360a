// The surface in space, with cones as spheres and seams as tubes.

import { PerspectiveCamera, Quaternion, Spherical, Vector3 } from "three";
import type { Cone, Edge, Surface } from "./data";
import { CUT, type Place, SPARED, type Vec3, coneColour, cornerNormals, hitSurface, pointOf } from "./geometry";
import { Spheres, Tubes } from "./impostors";
import { type Paint, TriangleMesh } from "./mesh_geometry";
import { meshMaterial } from "./mesh_material";
import { Stage } from "./stage";

const CONE = 0.013;
const TUBE = 0.0028;
/** Pins are thicker than seams. */
const PIN = 0.0045;
/** A cone is taken hold of within so many pixels. */
const REACH = 14;

export class SurfaceView {
  readonly stage: Stage<PerspectiveCamera>;
  private readonly material = meshMaterial(true);
  private readonly triangles: TriangleMesh;
  private readonly normals: Float32Array;
  private readonly up: Vector3;
  private radius = 1;
  private readonly spheres = new Spheres();
  private readonly seams = new Tubes(TUBE, 0x1d212b, 1);
  private readonly cuts = new Tubes(PIN, CUT, 2);
  private readonly spared = new Tubes(PIN, SPARED, 2);
  private cones: Cone[] = [];

  constructor(element: HTMLElement, canvas: HTMLCanvasElement, private readonly surface: Surface) {
    this.stage = new Stage(element, canvas, new PerspectiveCamera(32, 1, 0.01, 50), surface.triangles.length / 3);
    this.triangles = new TriangleMesh(surface, this.material);
    this.normals = cornerNormals(surface);
    this.shape(null);
    this.stage.backdrop.scene.add(this.triangles.mesh);
    this.stage.scene.add(...this.fronts.map(({ mesh }) => mesh));
    const size = [0, 1, 2].map((i) => {
      let [low, high] = [Infinity, -Infinity];
      for (const v of surface.triangles) {
        low = Math.min(low, surface.points[3 * v + i]);
        high = Math.max(high, surface.points[3 * v + i]);
      }
      return high - low;
    });
    this.radius = 0.5 * Math.hypot(...size);
    // y is up as in most files, but in a landscape, wide in x and y.
    const isLandscape = size[2] < 0.5 * Math.min(size[0], size[1]);
    this.up = isLandscape ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
    this.stage.camera.up.copy(this.up);
    this.stage.onResize = () => this.resize();
    this.stage.controls.minDistance = 0.02;
    this.stage.controls.maxDistance = 12;
    this.resize();
    this.fit();
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  /** Shows all of it from its corner. */
  fit(): void {
    const { camera, controls } = this.stage;
    const front = this.up.z ? new Vector3(0, -1, 0) : new Vector3(0, 0, 1);
    const side = new Vector3(1, 0, 0);
    const turn = (32 * Math.PI) / 180;
    const from = front.multiplyScalar(Math.cos(turn)).addScaledVector(side, Math.sin(turn)).addScaledVector(this.up, 0.42);
    const half = (0.5 * camera.fov * Math.PI) / 180;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * camera.aspect));
    controls.target.set(0, 0, 0);
    camera.position.copy(from.normalize().multiplyScalar((0.98 * this.radius) / Math.sin(narrow)));
    controls.update();
    this.stage.draw();
  }

  /** Paints the surface; a tint has three bytes for each corner. */
  colour(paint: Paint, tint: Uint8Array, isPatient = false): void {
    this.triangles.paint(paint, tint);
    this.stage.draw(isPatient);
  }

  /** The map's coordinates, for the checkerboard. */
  coordinates(uv: Float32Array, squares: number, isPatient: boolean): void {
    this.shape(uv);
    this.material.uniforms.squares.value = squares;
    this.stage.draw(isPatient);
  }

  private shape(coordinates: Float32Array | null): void {
    const { points, triangles } = this.surface;
    const position = (corner: number, into: Float32Array, at: number) => {
      const from = 3 * triangles[corner];
      for (let i = 0; i < 3; i++) into[at + i] = points[from + i];
    };
    this.triangles.shape({ position, normals: this.normals, coordinates });
  }

  showCones(cones: Cone[], selected: number | null): void {
    this.cones = cones;
    const crowd = Math.min(1, Math.sqrt(40 / Math.max(1, cones.length)));
    this.spheres.show(cones.map(({ vertex, curvature }, k) => {
      const known = Number.isNaN(curvature) ? 1 : Math.min(1.6, Math.sqrt(Math.abs(curvature) / Math.PI) + 0.5);
      const radius = CONE * crowd * known * (k === selected ? 1.5 : 1);
      return { at: this.at(vertex).toArray(), radius, colour: k === selected ? 0xffc400 : coneColour(curvature) };
    }));
    this.stage.drawFront();
  }

  showSeams(seams: Uint32Array[]): void {
    this.seams.show(this.surface.points, seams);
    this.stage.drawFront();
  }

  /** Edges that are pinned: those that are cut, and those that are not. */
  showPins(cut: Edge[], avoid: Edge[]): void {
    this.cuts.show(this.surface.points, cut);
    this.spared.show(this.surface.points, avoid);
    this.stage.drawFront();
  }

  /** The point of the surface under an event. */
  under(event: { clientX: number; clientY: number }): Place | null {
    const [x, y] = this.stage.fromEvent(event);
    const { camera } = this.stage;
    const direction = new Vector3(x, y, 0.5).unproject(camera).sub(camera.position).normalize();
    return hitSurface(this.surface, camera.position.toArray() as Vec3, direction.toArray() as Vec3);
  }

  /** The cone under an event that is in sight. */
  coneUnder(event: { clientX: number; clientY: number }, place: Place | null): number | null {
    const box = this.stage.canvas.getBoundingClientRect();
    const { camera } = this.stage;
    const depth = place && new Vector3(...pointOf(this.surface, place)).distanceTo(camera.position);
    let found: number | null = null;
    let nearest = REACH;
    this.cones.forEach(({ vertex }, k) => {
      const point = this.at(vertex);
      const [x, y] = this.stage.toScreen(point);
      const away = Math.hypot(x + box.left - event.clientX, y + box.top - event.clientY);
      const isInSight = depth === null || point.distanceTo(camera.position) < depth + 3 * CONE;
      if (isInSight && away < nearest) [nearest, found] = [away, k];
    });
    return found;
  }

  /** Turns until a place is in front. */
  face(place: Place): void {
    const { camera, controls } = this.stage;
    const normal = new Vector3().fromArray(this.normals, 9 * place.triangle);
    const direction = camera.position.clone().sub(controls.target);
    if (normal.dot(direction.clone().normalize()) > 0.3) return;
    const target = normal.multiplyScalar(direction.length());
    // Not from straight above or below: the model stands upright.
    if (Math.abs(target.clone().normalize().dot(this.up)) > 0.95) target.addScaledVector(direction, 0.4).setLength(direction.length());
    camera.position.copy(controls.target).add(target);
    controls.update();
    this.stage.draw();
  }

  /** Where a place is on the screen, and whether it is on the far side. */
  onScreen(place: Place): { x: number; y: number; isBehind: boolean } {
    const point = new Vector3(...pointOf(this.surface, place));
    const [x, y] = this.stage.toScreen(point);
    const { camera } = this.stage;
    const direction = point.clone().sub(camera.position);
    const first = hitSurface(this.surface, camera.position.toArray() as Vec3, direction.toArray() as Vec3);
    const isBehind = !!first && new Vector3(...pointOf(this.surface, first)).distanceTo(point) > 0.02;
    return { x, y, isBehind };
  }

  coneOnScreen(cone: Cone): [number, number] {
    return this.stage.toScreen(this.at(cone.vertex));
  }

  private at(vertex: number): Vector3 {
    return new Vector3().fromArray(this.surface.points, 3 * vertex);
  }

  private get fronts() {
    return [this.seams, this.cuts, this.spared, this.spheres];
  }

  private resize(): void {
    this.stage.camera.aspect = this.stage.width / this.stage.height;
    this.stage.camera.updateProjectionMatrix();
    for (const one of this.fronts) one.resize(this.stage.camera, this.stage.pixelsHigh);
  }

  private key(event: KeyboardEvent): void {
    const { camera, controls } = this.stage;
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1],
    };
    const offset = camera.position.clone().sub(controls.target);
    if (event.key in turns) {
      const upright = new Quaternion().setFromUnitVectors(this.up, new Vector3(0, 1, 0));
      const at = new Spherical().setFromVector3(offset.applyQuaternion(upright));
      at.theta += turns[event.key][0];
      at.phi = Math.min(Math.PI - 0.05, Math.max(0.05, at.phi + turns[event.key][1]));
      offset.setFromSpherical(at).applyQuaternion(upright.invert());
    } else if (event.key === "+" || event.key === "=") offset.multiplyScalar(0.88);
    else if (event.key === "-") offset.multiplyScalar(1.14);
    else if (event.key === "f" || event.key === "Home") return this.fit();
    else return;
    event.preventDefault();
    camera.position.copy(controls.target).add(offset);
    controls.update();
    this.stage.draw();
  }
}
