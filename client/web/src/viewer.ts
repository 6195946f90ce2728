// The surface in three.js, drawn when something has changed and never else.
import {
  Box3, Box3Helper, BufferAttribute, BufferGeometry, Color, DataTexture, FloatType, Group, LineBasicMaterial, LineSegments,
  Mesh, PerspectiveCamera, RedFormat, RedIntegerFormat, Scene, UnsignedByteType, UnsignedIntType, Vector3, WebGLRenderer,
  type PixelFormat, type TextureDataType } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { kTextureWidth, type Surface } from "./drawing";
import { standingAlert } from "./page";
import { surfaceMaterial } from "./surface_material";

// Where the lamp is, beside the camera.
const kLamp = new Vector3(0.4, 0.7, 1);

/** What is shown of a mesh. */
export interface Picture {
  clear(): void;
  /** Draws a surface. Its arrays are dropped when the canvas has them, and `taken` is called. */
  show(surface: Surface, taken: () => void): void;
  /** Marks what deserves a look: boxes, and lines by their ends. Seen through the surface. */
  mark(boxes: [number[], number[]][], ends: Float32Array): void;
  /** Looks at a box from the front, or with `near` from close by. */
  look(low: number[], high: number[], near?: boolean): void;
}

/** Shows nothing, and takes every surface at once, so that the next may come. */
const kNoPicture: Picture = { clear: () => {}, show: (_, taken) => taken(), mark: () => {}, look: () => {} };

/** The picture on a canvas. A browser without WebGL 2 has none, which the page says; all else works without. */
export function pictureOn(canvas: HTMLCanvasElement): Picture {
  try {
    return new Viewer(canvas);
  } catch (error) {
    canvas.hidden = true;
    standingAlert("Meshes are made and saved but not shown: this browser has no WebGL 2 " +
      `(${(error as Error).message})`);
    return kNoPicture;
  }
}

class Viewer implements Picture {
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(40, 1, 0.01, 1000);
  private readonly renderer: WebGLRenderer;
  private readonly controls: OrbitControls;
  private readonly material = surfaceMaterial(kTextureWidth);
  private readonly mesh = new Mesh(new BufferGeometry(), this.material);
  private readonly marks = new Group();
  private pending = false;
  private frames = 0;
  /** Called once the canvas has the surface. */
  private taken?: () => void;
  /** What was measured of the last frame. */
  last = { triangles: 0, calls: 0, ms: 0 };

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.mesh.visible = false;
    this.mesh.frustumCulled = false;  // its geometry has no positions
    this.scene.add(this.mesh, this.marks, this.camera);
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    canvas.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("visibilitychange", () => document.hidden && this.tellTaken());
    canvas.addEventListener("webglcontextlost", () => (this.mesh.visible = false));  // with its textures
    this.draw();
  }

  clear(): void {
    this.mesh.visible = false;
    this.clearMarks();
    this.draw();
  }

  show(surface: Surface, taken: () => void): void {
    this.put("corners", surface.corners, RedIntegerFormat, UnsignedIntType);
    this.put("places", surface.places, RedFormat, FloatType);
    this.put("paints", surface.paints, RedIntegerFormat, UnsignedByteType);
    this.mesh.geometry.setDrawRange(0, surface.triangles * 3);
    this.mesh.visible = surface.triangles > 0;
    this.taken = taken;
    // What nobody sees is taken when somebody looks.
    if (this.canvas.clientWidth === 0 || document.hidden || !this.mesh.visible) this.tellTaken();
    this.draw();
  }

  private put(name: string, data: Uint32Array | Float32Array | Uint8Array, format: PixelFormat,
      type: TextureDataType): void {
    const uniform = this.material.uniforms[name]!;
    (uniform.value as DataTexture | null)?.dispose();
    const height = Math.min(data.length / kTextureWidth, this.renderer.capabilities.maxTextureSize);
    const texture = new DataTexture(data.subarray(0, height * kTextureWidth), kTextureWidth, height, format, type);
    texture.onUpdate = () => ((texture.image as { data: unknown }).data = null);
    texture.needsUpdate = true;
    uniform.value = texture;
  }

  private tellTaken(): void {
    const taken = this.taken;
    this.taken = undefined;
    taken?.();
  }

  /** Three.js keeps what it has of a mark until it is told that nobody wants it. */
  private clearMarks(): void {
    for (const mark of this.marks.children as LineSegments<BufferGeometry, LineBasicMaterial>[]) {
      mark.geometry.dispose();
      mark.material.dispose();
    }
    this.marks.clear();
  }

  mark(boxes: [number[], number[]][], ends: Float32Array): void {
    this.clearMarks();
    for (const [low, high] of boxes) {
      this.marks.add(new Box3Helper(new Box3(new Vector3(...low), new Vector3(...high)), 0xe8a000));
    }
    if (ends.length > 0) {
      const lines = new BufferGeometry().setAttribute("position", new BufferAttribute(ends, 3));
      this.marks.add(new LineSegments(lines, new LineBasicMaterial({ color: 0xff3b30, depthTest: false })));
    }
    this.canvas.dataset["marks"] = String(boxes.length + ends.length / 6);
    this.draw();
  }

  look(low: number[], high: number[], near = false): void {
    const box = new Box3(new Vector3(...low), new Vector3(...high));
    const middle = box.getCenter(new Vector3());
    const size = Math.max(box.getSize(new Vector3()).length(), 1e-9);
    const away = near ? this.camera.position.clone().sub(middle).normalize() : new Vector3(0.5, 0.35, 1).normalize();
    this.camera.near = size / 100;
    this.camera.far = size * 100;
    this.camera.position.copy(middle).addScaledVector(away, size * 1.1);
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(middle);
    this.controls.update();
    this.draw();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;  // the browser's own
    const turns: Record<string, [number, number]> = {
      ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12] };
    const offset = this.camera.position.clone().sub(this.controls.target);
    const turn = turns[event.key];
    if (turn) {
      offset.applyAxisAngle(new Vector3(0, 1, 0), turn[0]);
      offset.applyAxisAngle(new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion), turn[1]);
    } else if (event.key === "+" || event.key === "-") {
      offset.multiplyScalar(event.key === "+" ? 0.9 : 1.1);
    } else {
      return;
    }
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  draw(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.drawNow();
    });
  }

  /** The lamp shines from beside the camera towards the origin. */
  private aimLamp(): void {
    this.camera.updateMatrixWorld();
    const lamp = this.material.uniforms["lamp"]!.value as Vector3;
    lamp.copy(kLamp).applyMatrix4(this.camera.matrixWorld).transformDirection(this.camera.matrixWorldInverse);
  }

  private drawNow(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return this.tellTaken();
    const start = performance.now();
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.renderer.setClearColor(new Color(getComputedStyle(this.canvas).backgroundColor));
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.aimLamp();
    this.renderer.render(this.scene, this.camera);
    this.tellTaken();
    const { triangles, calls } = this.renderer.info.render;
    this.last = { triangles, calls, ms: performance.now() - start };
    // What a test may wait for.
    this.canvas.dataset["drawn"] = String(this.mesh.visible ? triangles : 0);
    this.canvas.dataset["frames"] = String(++this.frames);
    this.canvas.dataset["calls"] = String(calls);
    this.canvas.dataset["geometries"] = String(this.renderer.info.memory.geometries);
    this.canvas.dataset["drawMs"] = this.last.ms.toFixed(1);
  }
}
