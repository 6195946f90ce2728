// How the surface is drawn: each triangle looks its corners up in textures, so that a vertex is there once, and has one paint.
import { GLSL3, RawShaderMaterial, DoubleSide, Vector3, type Texture } from "three";

const kVertex = `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform usampler2D corners, paints;
uniform sampler2D places;
uniform int width;
out vec3 seen;
flat out float paint;
ivec2 at(int i) { return ivec2(i % width, i / width); }
float place(int i) { return texelFetch(places, at(i), 0).r; }
void main() {
  int vertex = int(texelFetch(corners, at(gl_VertexID), 0).r) * 3;
  vec4 view = modelViewMatrix * vec4(place(vertex), place(vertex + 1), place(vertex + 2), 1.0);
  seen = view.xyz;
  paint = float(texelFetch(paints, at(gl_VertexID / 3), 0).r);
  gl_Position = projectionMatrix * view;
}`;

// From blue over white to orange; lit as Lambert has it by a lamp at the camera and a sky.
const kFragment = `
precision highp float;
uniform vec3 lamp;
in vec3 seen;
flat in float paint;
out vec4 colour;
void main() {
  float x = paint / 254.0;
  vec3 towards = x < 0.5 ? vec3(40.0, 110.0, 190.0) : vec3(230.0, 130.0, 30.0);
  vec3 own = paint > 254.5 ? vec3(190.0) : mix(vec3(235.0), towards, abs(x - 0.5) * 2.0);
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  vec3 light = own / 255.0 * (0.9 + 2.2 * max(dot(normal, lamp), 0.0)) / 3.14159265;
  vec3 shown = mix(1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, 12.92 * light, lessThanEqual(light, vec3(0.0031308)));
  colour = vec4(shown, 1.0);
}`;

export function surfaceMaterial(width: number): RawShaderMaterial {
  const none = { value: null as Texture | null };
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: kVertex, fragmentShader: kFragment, side: DoubleSide,
    uniforms: { corners: { ...none }, places: { ...none }, paints: { ...none }, width: { value: width },
      lamp: { value: new Vector3(0, 0, 1) } },
  });
}
