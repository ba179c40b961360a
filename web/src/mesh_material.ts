// The material of both views: a colour a corner, or a checkerboard by texture coordinates, lit from the eye.

import { DoubleSide, ShaderMaterial } from "three";
import { CHECKER, PLAIN } from "./colours";

const VERTEX = `
attribute vec2 coordinates;
attribute vec3 tint;
varying vec2 vCoordinates;
varying vec3 vTint;
varying vec3 vNormal;
void main() {
  vCoordinates = coordinates;
  vTint = tint;
  vNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const FRAGMENT = `
uniform bool isChecker;
uniform bool isPlain;
uniform vec3 plain;
uniform bool isLit;
uniform float squares;
uniform vec3 even;
uniform vec3 odd;
varying vec2 vCoordinates;
varying vec3 vTint;
varying vec3 vNormal;
void main() {
  vec3 colour = isPlain ? plain : vTint;
  if (isChecker) {
    vec2 at = vCoordinates * squares;
    vec2 width = max(fwidth(at), vec2(1e-5));
    vec2 wave = clamp((abs(fract(0.5 * at) - 0.5) - 0.25) * 2.0 / width, -0.5, 0.5) * 2.0;
    float fade = 1.0 - smoothstep(0.6, 1.6, max(width.x, width.y));
    colour = mix(even, odd, 0.5 + 0.5 * fade * wave.x * wave.y);
  }
  if (isLit) {
    vec3 n = normalize(gl_FrontFacing ? vNormal : -vNormal);
    float light = 0.42 + 0.5 * max(n.z, 0.0) + 0.14 * max(dot(n, normalize(vec3(0.4, 0.8, 0.4))), 0.0);
    if (!gl_FrontFacing) colour = mix(colour, vec3(0.85, 0.73, 0.61), 0.7);
    colour *= light;
  } else if (!gl_FrontFacing) {
    colour = vec3(0.88, 0.11, 0.52);
  }
  gl_FragColor = vec4(colour, 1.0);
}`;

export function meshMaterial(isLit: boolean): ShaderMaterial {
  const [even, odd, plain] = [...CHECKER, PLAIN].map((colour) => colour.map((x) => x / 255));
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: DoubleSide,
    uniforms: {
      isChecker: { value: false },
      isPlain: { value: true },
      plain: { value: plain },
      isLit: { value: isLit },
      squares: { value: 32 },
      even: { value: even },
      odd: { value: odd },
    },
  });
}
