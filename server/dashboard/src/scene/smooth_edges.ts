// The picture once more, with several samples per pixel.
import { NearestFilter, Vector2, WebGLRenderTarget } from "three";
import type { PerspectiveCamera, Scene, WebGLRenderer } from "three";
import { kCopyFragment } from "./shaders";
import { texelShader, WholeTarget } from "./whole_target";

const kSamples = 4;

export class SmoothEdges {
  private readonly target = new WebGLRenderTarget(1, 1, {
    samples: kSamples, minFilter: NearestFilter, magFilter: NearestFilter, generateMipmaps: false,
  });
  private readonly copy = texelShader(kCopyFragment, { picture: { value: this.target.texture } });
  private readonly whole: WholeTarget;

  constructor(private readonly renderer: WebGLRenderer) {
    this.whole = new WholeTarget(renderer);
  }

  /** Onto the canvas. */
  draw(scene: Scene, camera: PerspectiveCamera): void {
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    if (size.x !== this.target.width || size.y !== this.target.height) this.target.setSize(size.x, size.y);
    this.renderer.setRenderTarget(this.target);
    this.renderer.clear();
    this.renderer.render(scene, camera);
    this.whole.draw(this.copy, {}, null);
  }

  dispose(): void {
    this.target.dispose();
    this.copy.dispose();
    this.whole.dispose();
  }
}
