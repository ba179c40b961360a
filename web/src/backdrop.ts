// A picture with its depths, drawn anew only when something in it or the camera has changed. What moves before and within it costs
// only itself: of 268,686 triangles without a graphics card a picture takes 0.27 s, cones on this one a tenth of that. Without
// several samples a pixel it takes 0.1 s, so where that matters edges are smoothed afterwards (FXAA, T. Lottes 2009), and what can wait is
// drawn in slices, a frame each, while the picture before is shown: whatever else happens on the page waits for one slice at most.

import {
  AlwaysDepth, BufferAttribute, BufferGeometry, type Camera, DepthTexture, Mesh, NoBlending, Scene, ShaderMaterial, type Texture, UnsignedIntType, Vector2,
  type WebGLRenderer, WebGLRenderTarget,
} from "three";
import { FXAAShader } from "three/examples/jsm/shaders/FXAAShader.js";

const VERTEX = `
varying vec2 vUv;
void main() {
  vUv = 0.5 + 0.5 * position.xy;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const FRAGMENT = `
uniform sampler2D colour;
uniform sampler2D depth;
varying vec2 vUv;
void main() {
  gl_FragColor = texture2D(colour, vUv);
  gl_FragDepth = texture2D(depth, vUv).r;
}`;

/** So many slices: each takes 15 ms of 268,686 triangles. */
const SLICES = 8;

export class Backdrop {
  /** What is in it. */
  readonly scene = new Scene();
  /** It as a thing of another scene, behind all others there. */
  readonly picture: Mesh<BufferGeometry, ShaderMaterial>;
  private target: WebGLRenderTarget;
  /** The target that slices are drawn into. */
  private next: WebGLRenderTarget | null = null;
  private readonly smooth: Smooth | null;
  private readonly size = new Vector2();
  private isStale = true;
  /** The slice that is to be drawn. */
  private slice = SLICES;

  /** A backdrop whose edges are smooth by several samples a pixel, or afterwards. */
  constructor(private readonly isQuick: boolean) {
    this.target = this.canvas();
    this.smooth = isQuick ? new Smooth() : null;
    this.picture = whole(new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      depthFunc: AlwaysDepth,
      blending: NoBlending,
      uniforms: { colour: { value: null }, depth: { value: null } },
    }));
    this.picture.renderOrder = -1;
  }

  /** Says that it has changed, and whether that may be seen some frames later. */
  change(isPatient: boolean): void {
    if (isPatient && this.isQuick) this.slice = 0;
    else this.isStale = true;
  }

  /** Draws it if need be, as large as the renderer's canvas; whether there is more to be drawn. */
  update(renderer: WebGLRenderer, camera: Camera): boolean {
    const { x, y } = renderer.getDrawingBufferSize(this.size);
    if (this.isStale || this.target.width !== x || this.target.height !== y) {
      this.isStale = false;
      this.slice = SLICES;
      this.target.setSize(x, y);
      renderer.setRenderTarget(this.target);
      renderer.render(this.scene, camera);
      this.finish(renderer, camera);
    } else if (this.slice < SLICES) {
      this.drawSlice(renderer, camera);
    }
    return this.slice < SLICES;
  }

  private drawSlice(renderer: WebGLRenderer, camera: Camera): void {
    this.next ??= this.canvas();
    this.next.setSize(this.target.width, this.target.height);
    renderer.setRenderTarget(this.next);
    const meshes = this.scene.children.filter((one): one is Mesh => one instanceof Mesh);
    for (const { geometry } of meshes) {
      const triangles = (geometry.index ?? geometry.getAttribute("position"))?.count / 3;
      const [from, to] = [this.slice, this.slice + 1].map((slice) => 3 * Math.floor((triangles * slice) / SLICES));
      geometry.setDrawRange(from, to - from);
    }
    renderer.autoClear = this.slice === 0;
    renderer.render(this.scene, camera);
    renderer.autoClear = true;
    for (const { geometry } of meshes) geometry.setDrawRange(0, Infinity);
    if (++this.slice < SLICES) return renderer.setRenderTarget(null);
    [this.target, this.next] = [this.next, this.target];
    this.finish(renderer, camera);
  }

  private finish(renderer: WebGLRenderer, camera: Camera): void {
    const { uniforms } = this.picture.material;
    uniforms.colour.value = this.smooth?.update(renderer, camera, this.target) ?? this.target.texture;
    uniforms.depth.value = this.target.depthTexture;
    renderer.setRenderTarget(null);
  }

  private canvas(): WebGLRenderTarget {
    return new WebGLRenderTarget(1, 1, { samples: this.isQuick ? 0 : 4, depthTexture: new DepthTexture(1, 1, UnsignedIntType) });
  }
}

/** A picture with smooth edges of one without. */
class Smooth {
  private readonly target = new WebGLRenderTarget(1, 1, { depthBuffer: false });
  private readonly scene = new Scene();
  private readonly pixel = new Vector2();
  private readonly from: { value: Texture | null } = { value: null };

  constructor() {
    this.scene.add(whole(new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FXAAShader.fragmentShader,
      depthTest: false,
      depthWrite: false,
      blending: NoBlending,
      uniforms: { tDiffuse: this.from, resolution: { value: this.pixel } },
    })));
  }

  update(renderer: WebGLRenderer, camera: Camera, { width, height, texture }: WebGLRenderTarget): Texture {
    this.from.value = texture;
    this.target.setSize(width, height);
    this.pixel.set(1 / width, 1 / height);
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, camera);
    return this.target.texture;
  }
}

/** One triangle that covers the picture. */
function whole(material: ShaderMaterial): Mesh<BufferGeometry, ShaderMaterial> {
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  const mesh = new Mesh(new BufferGeometry().setAttribute("position", new BufferAttribute(corners, 3)), material);
  mesh.frustumCulled = false;
  return mesh;
}
