// The viewer itself, on three.js with WebGL 2. Its inputs are arrays, a camera and an element to draw into. It draws only
// after a change, and frees everything when it is disposed of. Only pages with a 3D picture load it.
//
// WebGPU is not used: three.js' renderer for it would double the download, and nothing here would look different.
import {
  AmbientLight,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  ClampToEdgeWrapping,
  Color,
  DirectionalLight,
  DoubleSide,
  FrontSide,
  GreaterDepth,
  Group,
  type Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
  MirroredRepeatWrapping,
  type Object3D,
  OrthographicCamera,
  PerspectiveCamera,
  Plane,
  Points,
  PointsMaterial,
  RepeatWrapping,
  SRGBColorSpace,
  Scene,
  Texture,
  Vector3,
  WebGLRenderer,
  type Wrapping,
} from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LIGHT, toLinear, vertexColors } from "./color";
import { aim, fieldMesh, renumber } from "./field_shader";
import { type Edge, edgesOf, segments, silhouette, strokes } from "./geometry";
import type { DecodedPicture, FieldLayer, Layer, MeshLayer, Paint, Picture, Section } from "./layers";
import { type View, axesOf, eyeOf, focal, fovOf } from "./view";

/** A higher pixel ratio costs time without a visible difference. */
const MOST_DENSITY = 2.5;
/** Anisotropic filtering keeps textures sharp at grazing angles; 4 is cheap on any GPU of the last ten years. */
const MOST_ANISOTROPY = 4;
/** The opacity of the hidden part of a mark. */
const HIDDEN = 0.28;
/** By glTF's numbers. */
const WRAPS: Record<number, Wrapping> = { 33071: ClampToEdgeWrapping, 33648: MirroredRepeatWrapping, 10497: RepeatWrapping };

/** The scene's objects for a layer. */
interface Shown {
  layer: Layer;
  objects: Object3D[];
  /** For a silhouette, which is recomputed for every view. */
  edges?: Edge[];
}

export class Viewer {
  readonly canvas: HTMLCanvasElement;
  /** How often it has drawn; tests check that it draws only after a change. */
  frames = 0;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly perspective = new PerspectiveCamera();
  private readonly parallel = new OrthographicCamera();
  /** The one of the current view. */
  private camera: PerspectiveCamera | OrthographicCamera = this.perspective;
  /** Holds the lights, which turn with the view. */
  private readonly lights = new Group();
  private readonly shown = new Map<string, Shown>();
  private readonly plane = new Plane();
  private readonly sizeObserver = new ResizeObserver(() => this.resize());
  private readonly dark = matchMedia("(prefers-color-scheme: dark)");
  /** The reader's choice of colours is an attribute of the root element. */
  private readonly themeObserver = new MutationObserver(() => this.restyle());
  private section: Section | undefined;
  private picture: Picture = { layers: [] };
  private view: View | undefined;
  private shift: readonly [number, number] = [0, 0];
  private frame = 0;
  private isDisposed = false;
  /** Set by three.js when a program that is drawn for the first time did not compile. */
  private hasShaderError = false;

  /** Draws into an element, which it fills. Throws if the browser has no WebGL 2. */
  constructor(private readonly root: HTMLElement) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "low-power" });
    this.renderer.outputColorSpace = SRGBColorSpace;
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("aria-hidden", "true");
    root.append(this.canvas);
    // three.js divides by π as in Lambert's law, but the intensity in LIGHT is a share.
    const sun = new DirectionalLight(0xffffff, LIGHT.sun * Math.PI);
    sun.position.set(...LIGHT.from);
    this.lights.add(sun, sun.target);
    this.scene.add(this.lights, new AmbientLight(0xffffff, LIGHT.ambient * Math.PI));
    this.renderer.debug.onShaderError = () => {
      this.hasShaderError = true;
    };
    this.canvas.addEventListener("webglcontextlost", this.onLost);
    this.canvas.addEventListener("webglcontextrestored", this.onRestored);
    this.dark.addEventListener("change", this.restyle);
    this.themeObserver.observe(document.documentElement, { attributeFilter: ["data-theme"] });
    this.sizeObserver.observe(root);
    this.resize();
  }

  /** Shows these layers and no others. Draws only if one of them, or the section, differs. */
  draw(picture: Picture): void {
    let isChanged = !isSame(picture.section, this.section, false);
    // A plane that moves is the same object for the materials; one that comes or goes changes which triangles are drawn.
    const isCutAnew = picture.section?.paint !== this.section?.paint;
    this.picture = picture;
    this.section = picture.section;
    this.renderer.localClippingEnabled = this.section !== undefined;
    // three.js cuts away what is behind a plane, a section what is in front of it.
    if (this.section) this.plane.set(new Vector3(...this.section.normal).negate(), this.section.offset);
    const layersById = new Map(picture.layers.map((layer) => [layer.id, layer]));
    for (const [id, shown] of this.shown) {
      const layer = layersById.get(id);
      // If only the arrays differ, as during a drag, the materials are kept: creating them takes milliseconds.
      // The section of a field is a uniform.
      const isCut = isCutAnew && shown.layer.kind !== "field";
      if (!layer || isCut || !isSame(layer, shown.layer, true)) this.remove(id, shown);
      else if (!isSame(layer, shown.layer, false)) this.reshape(shown, layer);
      else continue;
      isChanged = true;
    }
    for (const layer of picture.layers) {
      if (this.shown.has(layer.id)) continue;
      this.add(layer);
      isChanged = true;
    }
    if (isChanged) this.request();
  }

  /** Shows the picture from a view, with its target `shift` pixels to the right of the middle and below it. */
  look(view: View, shift: readonly [number, number] = [0, 0]): void {
    // A page calls this whenever anything of it changes, and without a graphics card a frame takes a tenth of a second.
    if (isSame(view, this.view, false) && isSame(shift, this.shift, false)) return;
    this.view = view;
    this.shift = shift;
    this.request();
  }

  /** Reads the colours of custom properties again. */
  restyle = (): void => {
    const { picture } = this;
    for (const [id, shown] of this.shown) this.remove(id, shown);
    this.draw(picture);
  };

  /** Frees the GPU resources and restores the element. */
  dispose(): void {
    this.isDisposed = true;
    cancelAnimationFrame(this.frame);
    this.sizeObserver.disconnect();
    this.dark.removeEventListener("change", this.restyle);
    this.themeObserver.disconnect();
    this.canvas.removeEventListener("webglcontextlost", this.onLost);
    this.canvas.removeEventListener("webglcontextrestored", this.onRestored);
    for (const [id, shown] of this.shown) this.remove(id, shown);
    this.renderer.dispose();
    // A browser allows few contexts at once, and frees them only when it likes.
    this.renderer.forceContextLoss();
    this.canvas.remove();
  }

  /** The numbers of geometries and textures on the GPU. */
  get held(): { geometries: number; textures: number } {
    const { geometries, textures } = this.renderer.info.memory;
    return { geometries, textures };
  }

  /** Whether the processor does the work of a graphics card, so that a field takes a second for a frame. */
  get isSoftware(): boolean {
    const gl = this.renderer.getContext();
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
  }

  /** How many vectors of four numbers a field's program may have, beside those of the camera and the light. */
  get uniformVectors(): number {
    return this.renderer.capabilities.maxFragmentUniforms - 32;
  }

  /** The number of programs on the GPU. */
  get programs(): number {
    return this.renderer.info.programs?.length ?? 0;
  }

  /** Draws immediately and returns the canvas, whose pixels must be read in the same task. */
  now(): HTMLCanvasElement {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.render();
    return this.canvas;
  }

  // The browser restores a lost context only if its default action is prevented.
  private onLost = (event: Event): void => {
    event.preventDefault();
    for (const shown of this.shown.values()) if (shown.layer.kind === "field") this.hide(shown);
  };
  private onRestored = (): void => {
    for (const shown of this.shown.values()) if (shown.layer.kind === "field") void this.compile(shown);
    this.request();
  };

  /** Compiles the program of a field, without blocking the page if the browser can, and shows the field then. */
  private async compile(shown: Shown): Promise<void> {
    const object = shown.objects[0]!;
    await this.renderer.compileAsync(object, this.camera, this.scene);
    const isShown = [...this.shown.values()].includes(shown);
    if (this.isDisposed || !isShown || this.renderer.getContext().isContextLost()) return;
    object.visible = true;
    this.hasShaderError = false;
    if (!this.view) return;
    this.now();
    if (this.hasShaderError) this.hide(shown);
    else (shown.layer as FieldLayer).drawn?.(true);
  }

  private hide({ layer, objects }: Shown): void {
    objects[0]!.visible = false;
    (layer as FieldLayer).drawn?.(false);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_DENSITY));
    this.renderer.setSize(width, height, false);
    // Immediately: resizing clears the canvas, which would flicker.
    if (this.view) this.now();
  }

  private request(): void {
    if (this.frame || this.isDisposed) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.render();
    });
  }

  private render(): void {
    if (!this.view || this.isDisposed) return;
    const { view } = this;
    this.camera = this.cameraOf(view);
    for (const shown of this.shown.values()) {
      if (shown.layer.kind === "field") this.trace(shown.objects[0] as Mesh);
      else this.outline(shown, view);
    }
    this.renderer.render(this.scene, this.camera);
    this.frames += 1;
  }

  private cameraOf(view: View): PerspectiveCamera | OrthographicCamera {
    const { clientWidth: width, clientHeight: height } = this.root;
    const size = { width, height };
    const eye = new Vector3(...eyeOf(view));
    const axes = axesOf(view).map((axis) => new Vector3(...axis)) as [Vector3, Vector3, Vector3];
    const camera = view.isParallel ? this.parallel : this.perspective;
    camera.position.copy(eye);
    camera.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(...axes));
    this.lights.position.copy(eye);
    this.lights.quaternion.copy(camera.quaternion);
    // As far as the farthest layer: from very near, the shape behind the target is many distances away.
    const far = Math.max(20 * view.distance, this.reach(eye));
    if (camera instanceof OrthographicCamera) {
      const scale = view.distance / focal(size) / 2;
      Object.assign(camera, { left: -width * scale, right: width * scale, top: height * scale, bottom: -height * scale, near: -far, far });
    } else {
      // Relative to the distance, so that depth is as fine for tiny as for huge shapes.
      Object.assign(camera, { aspect: width / height, fov: fovOf(size), near: view.distance / 50, far });
    }
    camera.setViewOffset(width, height, -this.shift[0], -this.shift[1], width, height);
    camera.updateProjectionMatrix();
    return camera;
  }

  /** The distance from the eye to the farthest point of a mesh. */
  private reach(eye: Vector3): number {
    let reach = 0;
    for (const { layer, objects } of this.shown.values()) {
      if (layer.kind !== "mesh") continue;
      const { geometry } = objects[0] as Mesh;
      if (!geometry.boundingSphere) geometry.computeBoundingSphere();
      const { center, radius } = geometry.boundingSphere!;
      reach = Math.max(reach, center.distanceTo(eye) + radius);
    }
    return reach;
  }

  private trace(mesh: Mesh): void {
    this.camera.updateMatrixWorld();
    aim(mesh, this.camera, this.canvas.width, this.section && { of: this.section, color: this.color(this.section.paint) });
  }

  private outline({ layer, objects, edges }: Shown, view: View): void {
    if (layer.kind !== "silhouette" || !edges) return;
    const line = objects[0] as LineSegments2;
    line.geometry.dispose();
    line.geometry = lineGeometry(silhouette(layer.positions, layer.indices, edges, eyeOf(view)));
  }

  private add(layer: Layer): void {
    const shown: Shown = { layer, objects: [] };
    switch (layer.kind) {
      case "mesh":
        shown.objects = this.meshes(layer);
        break;
      case "field":
        shown.objects = [fieldMesh(layer, this.color)];
        break;
      case "points":
        shown.objects = [this.points(layer)];
        break;
      case "silhouette":
        shown.edges = edgesOf(layer.positions, layer.indices);
        shown.objects = [this.line(layer)];
        break;
      default:
        shown.objects = [this.line(layer)];
    }
    if (layer.isMark && layer.kind !== "mesh" && layer.kind !== "field") {
      // Again, faint, only where something is in front of it. Neither writes depth, or marks would hide each other.
      shown.objects.push(layer.kind === "points" ? this.points(layer) : this.line(layer));
      const [seen, hidden] = shown.objects.map((object) => (object as Mesh).material as Material);
      seen!.depthWrite = false;
      Object.assign(hidden!, { depthWrite: false, depthFunc: GreaterDepth, transparent: true, opacity: HIDDEN });
    }
    const order = layer.isOnTop || layer.isMark ? 10 : layer.isUnder ? -10 : 0;
    shown.objects.forEach((object, i) => {
      object.renderOrder = order + i;
      if (layer.isUnder) Object.assign((object as Mesh).material, { depthTest: false, depthWrite: false });
    });
    this.scene.add(...shown.objects);
    this.shown.set(layer.id, shown);
    if (layer.kind === "field") void this.compile(shown);
  }

  /** Replaces the arrays of a layer, and keeps its materials. */
  private reshape(shown: Shown, layer: Layer): void {
    shown.layer = layer;
    if (layer.kind === "field") return renumber(shown.objects[0] as Mesh, layer);
    if (layer.kind === "silhouette") shown.edges = edgesOf(layer.positions, layer.indices);
    shown.objects.forEach((object) => {
      const mesh = object as Mesh;
      mesh.geometry.dispose();
      mesh.geometry = this.geometry(layer);
    });
  }

  private geometry(layer: Exclude<Layer, FieldLayer>): BufferGeometry {
    switch (layer.kind) {
      case "mesh":
        return meshGeometry(layer, this.color);
      case "lines":
        return lineGeometry(layer.positions);
      case "wire":
        return lineGeometry(segments(layer.positions, edgesOf(layer.positions, layer.indices)));
      case "normals":
        return lineGeometry(strokes(layer.at, layer.directions, layer.length));
      case "silhouette":
        // A line without length, until `outline` has a view.
        return lineGeometry(new Float32Array(6));
      case "points":
        return new BufferGeometry().setAttribute("position", new BufferAttribute(layer.positions, 3));
    }
  }

  private remove(id: string, { objects }: Shown): void {
    for (const object of objects as Mesh[]) {
      this.scene.remove(object);
      object.geometry.dispose();
      for (const material of [object.material].flat()) {
        (material as MeshPhongMaterial).map?.dispose();
        material.dispose();
      }
    }
    this.shown.delete(id);
  }

  private meshes(layer: MeshLayer): Object3D[] {
    const geometry = this.geometry(layer);
    const hasColors = geometry.hasAttribute("color");
    const front = layer.sides === "front" || layer.back !== undefined || (this.section && !layer.isWhole) ? FrontSide : DoubleSide;
    const material = (paint: Paint) => this.material(layer, paint, front, hasColors);
    // A geometry with groups has one material per group.
    const isTextured = layer.pictures !== undefined && geometry.groups.length > 0;
    const materials = isTextured ? layer.pictures!.of.map((picture) => this.textured(material(layer.paint), picture)) : material(layer.paint);
    const objects = [new Mesh(geometry, materials)];
    if (this.section && !layer.isWhole) {
      // The inside of a closed mesh, unlit in one tone, looks like a solid cut.
      const inside = new MeshBasicMaterial({ color: this.color(this.section.paint), side: BackSide });
      // With groups it would need a material for each.
      objects.push(new Mesh(ungrouped(geometry), this.clipped(inside, layer)));
    } else if (layer.back !== undefined && layer.sides === "both") {
      objects.push(new Mesh(ungrouped(geometry), this.material(layer, layer.back, BackSide, false)));
    }
    return objects;
  }

  private material(
    layer: MeshLayer,
    paint: Paint,
    side: typeof FrontSide | typeof BackSide | typeof DoubleSide,
    hasColors: boolean,
  ): Material {
    const common = {
      color: hasColors ? new Color(0xffffff) : this.color(paint),
      vertexColors: hasColors,
      side,
      transparent: layer.opacity !== undefined,
      opacity: layer.opacity ?? 1,
      depthTest: !layer.isOnTop,
    };
    const material =
      layer.shading === "none"
        ? new MeshBasicMaterial(common)
        : new MeshPhongMaterial({
            ...common,
            flatShading: layer.shading === "flat",
            shininess: 40,
            specular: new Color(layer.shading === "flat" ? 0 : 0x222222),
          });
    return this.clipped(material, layer);
  }

  private textured(material: Material, picture: DecodedPicture | undefined): Material {
    if (!picture) return material;
    const map = new Texture(picture.image);
    [map.wrapS, map.wrapT] = picture.wrap.map((way) => WRAPS[way] ?? RepeatWrapping) as [Wrapping, Wrapping];
    map.colorSpace = SRGBColorSpace;
    // In glTF v runs down, as in the rows of an image.
    map.flipY = false;
    map.anisotropy = MOST_ANISOTROPY;
    map.needsUpdate = true;
    return Object.assign(material, { map });
  }

  private clipped<M extends Material>(material: M, layer: Layer): M {
    if (this.section && !layer.isWhole) material.clippingPlanes = [this.plane];
    return material;
  }

  private line(layer: Exclude<Layer, { kind: "field" | "mesh" | "points" }>): LineSegments2 {
    const { paint, width, isOnTop } = layer;
    const material = new LineMaterial({ linewidth: width, depthTest: !isOnTop });
    // Edges lie on the triangles and must win the depth test. Wide lines are triangles, too, so the offset is on the lines: if
    // the triangles were moved back instead, those behind them would show along the outline.
    if (!layer.isWhole) Object.assign(material, { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -12 });
    material.color = this.color(paint);
    return new LineSegments2(this.geometry(layer) as LineSegmentsGeometry, this.clipped(material, layer));
  }

  private points(layer: Layer & { kind: "points" }): Points {
    const { paint, size, isOnTop } = layer;
    const material = new PointsMaterial({
      color: this.color(paint),
      // In CSS pixels: three.js multiplies it by the pixel ratio.
      size,
      sizeAttenuation: false,
      depthTest: !isOnTop,
    });
    // Round, and drawn a little nearer, so that a vertex is not half inside its own triangles.
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = shader.vertexShader.replace(
        "#include <project_vertex>",
        "#include <project_vertex>\ngl_Position.z -= 2e-4 * gl_Position.w;",
      );
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <clipping_planes_fragment>",
        "#include <clipping_planes_fragment>\nif (length(gl_PointCoord - 0.5) > 0.5) discard;",
      );
    };
    return new Points(this.geometry(layer), this.clipped(material, layer));
  }

  /** A colour, or the value of a custom property. */
  private color = (paint: Paint): Color => {
    const text = paint.startsWith("--") ? getComputedStyle(this.root).getPropertyValue(paint).trim() : paint;
    return new Color(text || "#888888");
  };
}

function ungrouped(geometry: BufferGeometry): BufferGeometry {
  const copy = geometry.clone();
  copy.clearGroups();
  return copy;
}

/** Whether two layers are the same, or differ only in the numbers of their arrays if `withoutArrays`. */
function isSame(a: unknown, b: unknown, withoutArrays: boolean): boolean {
  if (a === b) return true;
  if (ArrayBuffer.isView(a) && ArrayBuffer.isView(b))
    return withoutArrays || hasSameNumbers(a as Float32Array, b as Float32Array);
  if (typeof a !== "object" || typeof b !== "object" || a === null || b === null) return false;
  // Any other object, such as a bitmap, equals only itself.
  if (!Array.isArray(a) && Object.getPrototypeOf(a) !== Object.prototype) return false;
  const [left, right] = [a as Record<string, unknown>, b as Record<string, unknown>];
  const keys = Object.keys(left);
  return keys.length === Object.keys(right).length && keys.every((key) => isSame(left[key], right[key], withoutArrays));
}

/** Comparing costs a thousandth of uploading the numbers again. */
function hasSameNumbers(a: Float32Array, b: Float32Array): boolean {
  return a.length === b.length && a.every((x, i) => x === b[i]);
}

function lineGeometry(positions: Float32Array): LineSegmentsGeometry {
  // An empty geometry has no bounds.
  return new LineSegmentsGeometry().setPositions(positions.length ? positions : new Float32Array(6));
}

function meshGeometry(layer: MeshLayer, color: (paint: Paint) => Color): BufferGeometry {
  const geometry = new BufferGeometry();
  const colors = vertexColors(layer);
  if (layer.groups && !colors) {
    // A colour per triangle: the corners must not be shared.
    const { of, paints } = layer.groups;
    const palette = paints.map((paint) => color(paint).toArray());
    const rows = layer.indices;
    const unshare = (from: Float32Array, width = 3) => {
      const unshared = new Float32Array(width * rows.length);
      for (let i = 0; i < rows.length; i++) for (let k = 0; k < width; k++) unshared[width * i + k] = from[width * rows[i]! + k]!;
      return unshared;
    };
    geometry.setAttribute("position", new BufferAttribute(unshare(layer.positions), 3));
    if (layer.normals) geometry.setAttribute("normal", new BufferAttribute(unshare(layer.normals), 3));
    const cornerColors = new Float32Array(3 * rows.length);
    for (let i = 0; i < rows.length; i++) cornerColors.set(palette[of[Math.floor(i / 3)]!]!, 3 * i);
    geometry.setAttribute("color", new BufferAttribute(cornerColors, 3));
    if (layer.pictures) {
      geometry.setAttribute("uv", new BufferAttribute(unshare(layer.pictures.uv, 2), 2));
      // One draw for each run of triangles with the same picture.
      for (let face = 0, first = 0; face < of.length; face++) {
        if (face + 1 < of.length && of[face + 1] === of[face]) continue;
        geometry.addGroup(3 * first, 3 * (face + 1 - first), of[face]);
        first = face + 1;
      }
    }
    return geometry;
  }
  geometry.setAttribute("position", new BufferAttribute(layer.positions, 3));
  geometry.setIndex(new BufferAttribute(layer.indices, 1));
  if (layer.normals) geometry.setAttribute("normal", new BufferAttribute(layer.normals, 3));
  else if (layer.shading === "smooth") geometry.computeVertexNormals();
  // three.js takes colours of vertices as linear light.
  if (colors) geometry.setAttribute("color", new BufferAttribute(colors.map(toLinear), 3));
  return geometry;
}
