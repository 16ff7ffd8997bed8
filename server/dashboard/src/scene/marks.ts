// What a camera does not see and a preview shows: the cameras themselves, and lights without a surface.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, OctahedronGeometry, Vector3 } from "three";
import type { ShadingMesh } from "./shading_mesh";

/** Depth of a drawn frustum and size of a light, in radii of the scene. */
const kFrustum = 0.12;
const kLight = 0.02;
const kUsualAspect = 16 / 9;
const kColour = 0xff8c1a;

export class Marks {
  readonly group = new Group();
  private readonly cameras: LineSegments[] = [];
  private readonly lights: Mesh[] = [];
  private readonly lines = new LineBasicMaterial({ color: kColour });
  private readonly fill = new MeshBasicMaterial({ color: 0xffd84d });

  constructor(private readonly mesh: ShadingMesh, private readonly radius: number) {
    for (const _ of mesh.cameras.names) {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * 2 * 9), 3));
      const lines = new LineSegments(geometry, this.lines);
      lines.frustumCulled = false;
      this.cameras.push(lines);
    }
    for (const _ of mesh.lights.names) this.lights.push(new Mesh(new OctahedronGeometry(kLight * radius), this.fill));
    this.group.add(...this.cameras, ...this.lights);
    this.group.visible = false;
  }

  place(time: number): void {
    const frame = Math.min(Math.round(time), this.mesh.frameCount - 1);
    this.cameras.forEach((lines, camera) => this.placeCamera(lines, camera, frame));
    this.lights.forEach((light, k) => light.position.fromArray(this.mesh.lights.position, 3 * (k * this.mesh.frameCount + frame)));
  }

  dispose(): void {
    for (const { geometry } of [...this.cameras, ...this.lights]) geometry.dispose();
    this.lines.dispose();
    this.fill.dispose();
  }

  /** From the eye to four corners, around them, and a line that says which way is up. */
  private placeCamera(lines: LineSegments, camera: number, frame: number): void {
    const { cameras, frameCount } = this.mesh;
    const at = camera * frameCount + frame;
    const eye = new Vector3().fromArray(cameras.position, 3 * at);
    const along = new Vector3().fromArray(cameras.forward, 3 * at);
    const up = new Vector3().fromArray(cameras.up, 3 * at);
    const [width, height] = [cameras.imageSize[2 * camera] ?? 0, cameras.imageSize[2 * camera + 1] ?? 0];
    const depth = kFrustum * this.radius;
    const y = depth * Math.tan(((cameras.verticalFovDeg[at] ?? 60) * Math.PI) / 360);
    const x = y * (width > 0 && height > 0 ? width / height : kUsualAspect);
    const basis = new Matrix4().makeBasis(along.clone().cross(up), up, along.clone().negate()).setPosition(eye);
    const point = (px: number, py: number) => new Vector3(px, py, -depth).applyMatrix4(basis);
    const [a, b, c, d] = [point(-x, -y), point(x, -y), point(x, y), point(-x, y)];
    const pairs = [eye, a, eye, b, eye, c, eye, d, a, b, b, c, c, d, d, a, point(0, y), point(0, 1.5 * y)];
    const position = lines.geometry.getAttribute("position") as BufferAttribute;
    pairs.forEach((corner, k) => position.setXYZ(k, corner.x, corner.y, corner.z));
    position.needsUpdate = true;
  }
}
