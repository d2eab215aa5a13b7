// A line around what is selected or under the pointer: its silhouette is drawn into a mask, and a second pass over the
// whole view colours the mask's edge. Costs nothing while nothing is selected.
import * as THREE from 'three';
import type { Body } from './bodies';

const MASK = `void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;

export class Outline {
  private readonly scene = new THREE.Scene();
  private readonly target = new THREE.WebGLRenderTarget(4, 4, { samples: 4, depthBuffer: false });
  private readonly selected_material = maskMaterial(new THREE.Color(1, 0, 0));
  private readonly hover_material = maskMaterial(new THREE.Color(0, 1, 0));
  private readonly quad: THREE.Mesh<THREE.PlaneGeometry, THREE.ShaderMaterial>;
  private readonly quad_scene = new THREE.Scene();
  private readonly quad_camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
  private readonly proxies: THREE.Mesh[] = [];

  constructor() {
    this.quad = new THREE.Mesh(
      new THREE.PlaneGeometry(2, 2),
      new THREE.ShaderMaterial({
        transparent: true,
        depthTest: false,
        depthWrite: false,
        uniforms: {
          mask: { value: this.target.texture },
          texel: { value: new THREE.Vector2() },
          selected_color: { value: new THREE.Color() },
          hover_color: { value: new THREE.Color() },
        },
        vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
        fragmentShader: `uniform sampler2D mask; uniform vec2 texel; uniform vec3 selected_color; uniform vec3 hover_color; varying vec2 at;
          void main() {
            vec2 inside = texture2D(mask, at).rg;
            vec2 around = vec2(0.0);
            for (int i = 0; i < 12; ++i) {
              float angle = float(i) * 0.5235988;
              around = max(around, texture2D(mask, at + texel * vec2(cos(angle), sin(angle))).rg);
            }
            vec2 edge = clamp(around - inside, 0.0, 1.0);
            float hover = edge.g * 0.75;
            float alpha = max(edge.r, hover);
            if (alpha < 0.01) discard;
            gl_FragColor = vec4(mix(hover_color, selected_color, step(hover, edge.r)), alpha);
            #include <colorspace_fragment>
          }`,
      }),
    );
    this.quad.frustumCulled = false;
    this.quad_scene.add(this.quad);
  }

  setColors(selected: string, hover: string): void {
    (this.quad.material.uniforms.selected_color.value as THREE.Color).set(selected);
    (this.quad.material.uniforms.hover_color.value as THREE.Color).set(hover);
  }

  render(renderer: THREE.WebGLRenderer, camera: THREE.Camera, selected: Body | null, hover: Body | null, line_px: number): void {
    let used = this.put(selected, this.selected_material, 0);
    if (hover !== selected) used = this.put(hover, this.hover_material, used);
    for (let i = used; i < this.proxies.length; ++i) this.proxies[i].visible = false;
    if (used === 0) return;
    const size = renderer.getDrawingBufferSize(new THREE.Vector2());
    if (this.target.width !== size.x || this.target.height !== size.y) this.target.setSize(size.x, size.y);
    (this.quad.material.uniforms.texel.value as THREE.Vector2).set(line_px / size.x, line_px / size.y);
    const clear_alpha = renderer.getClearAlpha();
    renderer.setRenderTarget(this.target);
    renderer.setClearAlpha(0);
    renderer.clear();
    renderer.render(this.scene, camera);
    renderer.setRenderTarget(null);
    renderer.setClearAlpha(clear_alpha);
    // Over what is there already.
    renderer.autoClear = false;
    renderer.render(this.quad_scene, this.quad_camera);
    renderer.autoClear = true;
  }

  dispose(): void {
    this.target.dispose();
    this.quad.geometry.dispose();
    this.quad.material.dispose();
    this.selected_material.dispose();
    this.hover_material.dispose();
  }

  private put(body: Body | null, material: THREE.Material, from: number): number {
    if (body === null) return from;
    for (const slot of body.slots) {
      let proxy = this.proxies[from];
      if (proxy === undefined) {
        proxy = new THREE.Mesh();
        proxy.matrixAutoUpdate = false;
        proxy.frustumCulled = false;
        this.proxies.push(proxy);
        this.scene.add(proxy);
      }
      proxy.visible = true;
      proxy.geometry = slot.batch.geometry;
      proxy.material = material;
      proxy.matrix.fromArray(slot.batch.matrices, 16 * slot.at);
      proxy.matrixWorldNeedsUpdate = true;
      ++from;
    }
    return from;
  }
}

function maskMaterial(color: THREE.Color): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    side: THREE.DoubleSide,
    depthTest: false,
    depthWrite: false,
    blending: THREE.CustomBlending,
    blendEquation: THREE.MaxEquation,
    uniforms: { color: { value: color } },
    vertexShader: MASK,
    fragmentShader: 'uniform vec3 color; void main() { gl_FragColor = vec4(color, 1.0); }',
  });
}
