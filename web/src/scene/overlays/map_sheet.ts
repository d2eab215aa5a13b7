// A map of cells as a sheet on the ground. Its cells are one byte each on the graphics card, and get their colours there: 4 million cost 4 MB.
import * as THREE from 'three';

/** Stretches per side where there is terrain to follow. */
const FOLDS = 96;

export class MapSheet {
  private mesh: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;
  private readonly dark: { value: number };

  constructor(private readonly parent: THREE.Object3D, dark: { value: number }, private readonly order: number) {
    this.dark = dark;
  }

  /**
   * @param cells  row by row from the corner at the origin, occupancies in percent as bytes; above 100: unknown
   * @param place  from metres in the sheet to a point of the world
   */
  set(width: number, height: number, resolution_m: number, cells: Uint8Array, place: (x_m: number, y_m: number, out: number[]) => void, folded: boolean): void {
    this.mesh ??= this.make();
    const uniform = this.mesh.material.uniforms.cells as { value: THREE.DataTexture | null };
    let texture = uniform.value;
    if (texture === null || texture.image.width !== width || texture.image.height !== height) {
      texture?.dispose();
      texture = uniform.value = new THREE.DataTexture(cells, width, height, THREE.RedFormat, THREE.UnsignedByteType);
      texture.needsUpdate = true;
    } else if (texture.image.data !== cells) {
      texture.image.data = cells;
      texture.needsUpdate = true;
    }
    const folds = folded ? FOLDS : 1;
    const geometry = new THREE.PlaneGeometry(1, 1, folds, folds);
    const position = geometry.getAttribute('position') as THREE.BufferAttribute;
    const uv = geometry.getAttribute('uv') as THREE.BufferAttribute;
    const point = [0, 0, 0];
    for (let v = 0; v < position.count; ++v) {
      const x = position.getX(v) + 0.5, y = position.getY(v) + 0.5;
      place(x * width * resolution_m, y * height * resolution_m, point);
      position.setXYZ(v, point[0], point[1], point[2]);
      uv.setXY(v, x, y);
    }
    this.mesh.geometry.dispose();
    this.mesh.geometry = geometry;
  }

  dispose(): void {
    if (this.mesh === null) return;
    (this.mesh.material.uniforms.cells.value as THREE.DataTexture | null)?.dispose();
    this.mesh.material.dispose();
    this.mesh.geometry.dispose();
    this.parent.remove(this.mesh);
    this.mesh = null;
  }

  private make(): THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> {
    const mesh = new THREE.Mesh(
      new THREE.BufferGeometry(),
      new THREE.ShaderMaterial({
        transparent: true, depthWrite: false, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4,
        uniforms: { cells: { value: null }, dark: this.dark },
        vertexShader: 'varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * viewMatrix * vec4(position, 1.0); }',
        // Free is a bright veil, occupied the opposite of it, costs run from blue over magenta to red, unknown is grey.
        fragmentShader: `varying vec2 at; uniform sampler2D cells; uniform float dark;
          vec4 tone(vec2 uv) {
            float v = 255.0 * texture2D(cells, clamp(uv, 0.0, 0.99999)).r;
            if (v > 127.0) return vec4(0.5, 0.53, 0.58, mix(0.30, 0.22, dark));
            if (v < 0.5) return mix(vec4(1.0, 1.0, 1.0, 0.62), vec4(0.55, 0.68, 0.88, 0.30), dark);
            if (v > 99.5) return mix(vec4(0.06, 0.08, 0.12, 0.95), vec4(0.97, 0.98, 1.0, 0.95), dark);
            float c = v / 99.0;
            vec3 hue = c < 0.5 ? mix(vec3(0.22, 0.47, 0.98), vec3(0.80, 0.22, 0.80), 2.0 * c) : mix(vec3(0.80, 0.22, 0.80), vec3(0.95, 0.20, 0.16), 2.0 * c - 1.0);
            return vec4(hue, 0.35 + 0.5 * c);
          }
          void main() {
            // Nine looks per pixel: edges of cells are smooth, and far away walls of one cell do not flicker.
            vec2 dx = dFdx(at) / 3.0, dy = dFdy(at) / 3.0;
            vec4 sum = vec4(0.0);
            for (int i = -1; i <= 1; ++i)
              for (int j = -1; j <= 1; ++j) {
                vec4 t = tone(at + float(i) * dx + float(j) * dy);
                sum += vec4(t.rgb * t.a, t.a);
              }
            if (sum.a < 0.01) discard;
            // Colours here are as a screen has them: no further conversion.
            gl_FragColor = vec4(sum.rgb / sum.a, sum.a / 9.0);
          }`,
      }),
    );
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.renderOrder = this.order;
    this.parent.add(mesh);
    return mesh;
  }
}
