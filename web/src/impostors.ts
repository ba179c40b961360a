// Spheres and tubes as squares and strips that face the eye, with edges made smooth by themselves. So the canvas needs no several samples a
// pixel, which without a graphics card is half of what a picture costs, and a tube takes two triangles in place of twelve.
//
// A sphere tells its depth at each pixel, so that it dips into the surface as a ball would; a tube's strip lies where its front would be.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, Mesh, type PerspectiveCamera, ShaderMaterial } from "three";

const SPHERE_VERTEX = `
attribute vec4 ball;
attribute vec3 tint;
uniform float pixel;
varying vec2 vAt;
varying vec3 vTint;
varying vec4 vBall;
void main() {
  vBall = vec4((modelViewMatrix * vec4(ball.xyz, 1.0)).xyz, ball.w);
  // A pixel more, for the edge.
  vAt = position.xy * (1.0 - pixel * vBall.z / ball.w);
  vTint = tint;
  gl_Position = projectionMatrix * vec4(vBall.xyz + vec3(vAt * ball.w, 0.0), 1.0);
}`;

const SPHERE_FRAGMENT = `
uniform mat4 projectionMatrix;
uniform vec3 up;
varying vec2 vAt;
varying vec3 vTint;
varying vec4 vBall;
void main() {
  float away = length(vAt);
  float cover = clamp((1.0 - away) / fwidth(away) + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  vec3 normal = vec3(vAt, sqrt(max(0.0, 1.0 - away * away)));
  vec4 clip = projectionMatrix * vec4(vBall.xyz + vBall.w * normal, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  gl_FragColor = vec4(vTint * mix(0.6, 1.0, 0.5 + 0.5 * dot(normal, up)), cover);
}`;

const TUBE_VERTEX = `
attribute vec3 from;
attribute vec3 to;
uniform float radius;
uniform float pixel;
varying float vAcross;
void main() {
  vec3 a = (modelViewMatrix * vec4(from, 1.0)).xyz;
  vec3 b = (modelViewMatrix * vec4(to, 1.0)).xyz;
  vec3 along = normalize(b - a);
  // A little longer, so that there are no gaps where tubes meet.
  vec3 end = mix(a - 0.5 * radius * along, b + 0.5 * radius * along, position.y);
  vec3 across = cross(along, -end);
  across = across / max(length(across), 1e-9);
  vec3 front = cross(across, along);
  vAcross = position.x * (1.0 - pixel * end.z / radius);
  gl_Position = projectionMatrix * vec4(end + radius * (vAcross * across + sign(dot(front, -end)) * front), 1.0);
}`;

const TUBE_FRAGMENT = `
uniform vec3 colour;
varying float vAcross;
void main() {
  float cover = clamp((1.0 - abs(vAcross)) / fwidth(vAcross) + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  gl_FragColor = vec4(colour, cover);
}`;

/**
 * Squares of four corners each, with values that are the same at the four. They are written four times rather than drawn as instances: without
 * a graphics card each instance costs as much as a drawing by itself, 20 ms for the seams of 30 cones on 134,345 vertices.
 */
class Squares {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  private room = 0;

  constructor(private readonly corners: number[], vertexShader: string, fragmentShader: string, uniforms: ShaderMaterial["uniforms"], private readonly widths: Record<string, number>) {
    const material = new ShaderMaterial({ vertexShader, fragmentShader, transparent: true, uniforms: { ...uniforms, pixel: { value: 0 } } });
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  /** How wide a pixel is at a distance of one. */
  resize(camera: PerspectiveCamera, height: number): void {
    this.mesh.material.uniforms.pixel.value = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
  }

  /** Takes values for so many squares: `write` puts those of one into rows of each name, at its place. */
  protected fill(count: number, write: (square: number, put: (name: string, ...values: number[]) => void) => void): void {
    if (count > this.room) this.grow(Math.max(64, 2 * count));
    const { geometry } = this.mesh;
    this.mesh.visible = count > 0;
    geometry.setDrawRange(0, 6 * count);
    let first = 0;
    const put = (name: string, ...values: number[]) => {
      const { array } = geometry.getAttribute(name);
      for (let corner = 0; corner < 4; corner++) (array as Float32Array).set(values, (first + corner) * values.length);
    };
    for (let square = 0; square < count; square++, first += 4) write(square, put);
    for (const name of count ? Object.keys(this.widths) : []) {
      const attribute = geometry.getAttribute(name) as BufferAttribute;
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 4 * count * attribute.itemSize);
      attribute.needsUpdate = true;
    }
  }

  /** Makes room for so many; more than are needed, so that this is seldom. */
  private grow(room: number): void {
    this.room = room;
    const { geometry } = this.mesh;
    // Its buffers are those of the old size.
    geometry.dispose();
    const [corners, sides] = [this.corners, [0, 1, 2, 0, 2, 3]];
    geometry.setAttribute("position", new BufferAttribute(Float32Array.from({ length: 12 * room }, (_, k) => corners[k % 12]), 3));
    geometry.setIndex(new BufferAttribute(Uint32Array.from({ length: 6 * room }, (_, k) => 4 * Math.floor(k / 6) + sides[k % 6]), 1));
    for (const [name, width] of Object.entries(this.widths)) geometry.setAttribute(name, new BufferAttribute(new Float32Array(4 * width * room), width));
  }
}

export interface Ball {
  at: ArrayLike<number>;
  radius: number;
  colour: number;
}

export class Spheres extends Squares {
  constructor() {
    const up = { value: [0, 1, 0] };
    super([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], SPHERE_VERTEX, SPHERE_FRAGMENT, { up }, { ball: 4, tint: 3 });
    this.mesh.renderOrder = 3;
    // Lit from above, wherever that is on the screen.
    this.mesh.onBeforeRender = (_renderer, _scene, camera) => {
      up.value = [4, 5, 6].map((k) => camera.matrixWorldInverse.elements[k]);
    };
  }

  show(balls: Ball[]): void {
    this.fill(balls.length, (k, put) => {
      const { at, radius, colour } = balls[k];
      put("ball", at[0], at[1], at[2], radius);
      // What is drawn is what is said: no conversion.
      put("tint", (colour >> 16) / 255, ((colour >> 8) & 255) / 255, (colour & 255) / 255);
    });
  }
}

export class Tubes extends Squares {
  constructor(radius: number, colour: number, order: number) {
    const value = new Color().setHex(colour, "");
    super([-1, 0, 0, 1, 0, 0, 1, 1, 0, -1, 1, 0], TUBE_VERTEX, TUBE_FRAGMENT, { radius: { value: radius }, colour: { value } }, { from: 3, to: 3 });
    this.mesh.renderOrder = order;
    this.mesh.material.depthWrite = false;
    this.mesh.material.side = DoubleSide;
  }

  /** Chains of vertices, with the points of all vertices. */
  show(points: Float32Array, chains: ArrayLike<number>[]): void {
    const ends: number[] = [];
    for (const chain of chains) {
      for (let i = 1; i < chain.length; i++) ends.push(3 * chain[i - 1], 3 * chain[i]);
    }
    this.fill(ends.length / 2, (k, put) => {
      const [a, b] = [ends[2 * k], ends[2 * k + 1]];
      put("from", points[a], points[a + 1], points[a + 2]);
      put("to", points[b], points[b + 1], points[b + 2]);
    });
  }
}
