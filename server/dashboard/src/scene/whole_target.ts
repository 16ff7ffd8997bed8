// A shader run once for every texel of a target.
import { BufferAttribute, BufferGeometry, Camera, GLSL3, Mesh, NoBlending, RawShaderMaterial } from "three";
import type { WebGLRenderer, WebGLRenderTarget } from "three";
import { kWholeTargetVertex } from "./shaders";

export function texelShader(fragmentShader: string, uniforms: Record<string, { value: unknown }>, defines: Record<string, number> = {}): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: kWholeTargetVertex, fragmentShader, uniforms, defines,
    blending: NoBlending, depthTest: false, depthWrite: false,
  });
}

export class WholeTarget {
  private readonly mesh = new Mesh<BufferGeometry, RawShaderMaterial>(new BufferGeometry());
  private readonly camera = new Camera();

  constructor(private readonly renderer: WebGLRenderer) {
    this.mesh.geometry.setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.mesh.frustumCulled = false;
  }

  /** `into`: null is the canvas. */
  draw(material: RawShaderMaterial, uniforms: Record<string, unknown>, into: WebGLRenderTarget | null): void {
    for (const [name, value] of Object.entries(uniforms)) material.uniforms[name]!.value = value;
    this.mesh.material = material;
    this.renderer.setRenderTarget(into);
    this.renderer.render(this.mesh, this.camera);
    this.renderer.setRenderTarget(null);
  }

  dispose(): void {
    this.mesh.geometry.dispose();
  }
}
