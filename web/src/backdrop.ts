// A picture with its depths, drawn anew only when something in it or the camera has changed. What moves before and within it costs
// only itself: of 268,686 triangles without a graphics card a picture takes 0.27 s, cones on this one a tenth of that. Without
// several samples a pixel it takes 0.1 s, so where that matters edges are smoothed afterwards (FXAA, T. Lottes 2009).

import {
  AlwaysDepth, BufferAttribute, BufferGeometry, type Camera, DepthTexture, Mesh, NoBlending, Scene, ShaderMaterial, UnsignedIntType, Vector2,
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

export class Backdrop {
  /** What is in it. */
  readonly scene = new Scene();
  /** It as a thing of another scene, behind all others there. */
  readonly picture: Mesh;
  private readonly target: WebGLRenderTarget;
  private readonly smooth: Smooth | null;
  private readonly size = new Vector2();
  private isStale = true;

  /** A backdrop whose edges are smooth by several samples a pixel, or afterwards. */
  constructor(isQuick: boolean) {
    this.target = new WebGLRenderTarget(1, 1, { samples: isQuick ? 0 : 4, depthTexture: new DepthTexture(1, 1, UnsignedIntType) });
    this.smooth = isQuick ? new Smooth(this.target) : null;
    const { texture } = this.smooth?.target ?? this.target;
    this.picture = whole(new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      depthFunc: AlwaysDepth,
      blending: NoBlending,
      uniforms: { colour: { value: texture }, depth: { value: this.target.depthTexture } },
    }));
    this.picture.renderOrder = -1;
  }

  /** Says that it has changed. */
  change(): void {
    this.isStale = true;
  }

  /** Draws it if need be, as large as the renderer's canvas. */
  update(renderer: WebGLRenderer, camera: Camera): void {
    const { x, y } = renderer.getDrawingBufferSize(this.size);
    if (!this.isStale && this.target.width === x && this.target.height === y) return;
    this.isStale = false;
    this.target.setSize(x, y);
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, camera);
    this.smooth?.update(renderer, camera);
    renderer.setRenderTarget(null);
  }
}

/** A picture with smooth edges of one without. */
class Smooth {
  readonly target = new WebGLRenderTarget(1, 1, { depthBuffer: false });
  private readonly scene = new Scene();
  private readonly pixel = new Vector2();

  constructor(private readonly from: WebGLRenderTarget) {
    this.scene.add(whole(new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FXAAShader.fragmentShader,
      depthTest: false,
      depthWrite: false,
      blending: NoBlending,
      uniforms: { tDiffuse: { value: from.texture }, resolution: { value: this.pixel } },
    })));
  }

  update(renderer: WebGLRenderer, camera: Camera): void {
    const { width, height } = this.from;
    this.target.setSize(width, height);
    this.pixel.set(1 / width, 1 / height);
    renderer.setRenderTarget(this.target);
    renderer.render(this.scene, camera);
  }
}

/** One triangle that covers the picture. */
function whole(material: ShaderMaterial): Mesh {
  const corners = new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]);
  const mesh = new Mesh(new BufferGeometry().setAttribute("position", new BufferAttribute(corners, 3)), material);
  mesh.frustumCulled = false;
  return mesh;
}
