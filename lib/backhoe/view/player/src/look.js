// Colours, materials and lights: soft daylight, no textures.
import {
  BackSide, BufferAttribute, Color, DirectionalLight, DoubleSide, Fog, HemisphereLight, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, SphereGeometry,
} from "three";

export const themes = {
  light: {
    zenith: "#8fb8de", horizon: "#e9eff2", grass: "#98a183", soil: "#85694e", deep: "#553f2f",
    grid: 0.10, sky: 1.7, sun: 2.6, ground: "#8d8468", trail: "#c2185b",
  },
  dark: {
    zenith: "#0e1826", horizon: "#2c3c4f", grass: "#525a4c", soil: "#6f5843", deep: "#453527",
    grid: 0.16, sky: 1.35, sun: 2.2, ground: "#4a4a44", trail: "#ff7aa8",
  },
};

export function machineMaterial([r, g, b, opacity]) {
  return new MeshLambertMaterial({
    color: new Color().setRGB(r, g, b, "srgb"),
    opacity,
    transparent: opacity < 1,
    side: DoubleSide,
  });
}

// vertex colours, with a metre grid in world coordinates that thins out with distance
export function groundMaterial(strength) {
  const material = new MeshLambertMaterial({ vertexColors: true });
  material.onBeforeCompile = (shader) => {
    shader.uniforms.gridStrength = strength;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec3 metre;")
      .replace(
        "#include <project_vertex>",
        "#include <project_vertex>\nmetre = (modelMatrix * vec4(transformed, 1.0)).xyz;",
      );
    shader.fragmentShader = shader.fragmentShader
      .replace(
        "#include <common>",
        "#include <common>\nvarying vec3 metre;\nuniform float gridStrength;",
      )
      .replace(
        "#include <color_fragment>",
        `#include <color_fragment>
        vec2 width = fwidth(metre.xy) * 1.2 + 0.006;
        vec2 away = abs(fract(metre.xy + 0.5) - 0.5);
        vec2 thin = (1.0 - smoothstep(vec2(0.0), width, away)) * min(vec2(1.0), 0.03 / width);
        diffuseColor.rgb *= 1.0 - gridStrength * 2.5 * max(thin.x, thin.y);`,
      );
  };
  return material;
}

export class Surroundings {
  constructor(scene, radius) {
    const dome = new SphereGeometry(400, 24, 16);
    dome.rotateX(Math.PI / 2);
    dome.setAttribute("color", new BufferAttribute(new Float32Array(dome.attributes.position.count * 3), 3));
    this.sky = new Mesh(
      dome,
      new MeshBasicMaterial({ vertexColors: true, side: BackSide, fog: false, depthWrite: false }),
    );
    this.sky.frustumCulled = false;
    this.hemisphere = new HemisphereLight();
    this.hemisphere.position.set(0, 0, 1);
    this.sun = new DirectionalLight();
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0006;
    this.sun.shadow.normalBias = 0.03;
    Object.assign(this.sun.shadow.camera, {
      left: -radius, right: radius, top: radius, bottom: -radius, near: 1, far: 60,
    });
    scene.fog = new Fog(0, 26, 85);
    this.fog = scene.fog;
    scene.add(this.sky, this.hemisphere, this.sun, this.sun.target);
  }

  use(theme) {
    const horizon = new Color(theme.horizon), zenith = new Color(theme.zenith), mixed = new Color();
    const { position, color } = this.sky.geometry.attributes;
    for (let i = 0; i < position.count; i++) {
      const up = Math.max(0, position.getZ(i) / 400);
      mixed.lerpColors(horizon, zenith, Math.min(1, 1.5 * up) ** 0.7);
      color.setXYZ(i, mixed.r, mixed.g, mixed.b);
    }
    color.needsUpdate = true;
    this.fog.color.copy(horizon);
    this.hemisphere.color.set("#ffffff");
    this.hemisphere.groundColor.set(theme.ground);
    this.hemisphere.intensity = theme.sky;
    this.sun.color.set("#fff3df");
    this.sun.intensity = theme.sun;
  }

  // the shadows follow the machine
  centre(point) {
    this.sun.target.position.copy(point);
    this.sun.position.copy(point).add({ x: -7, y: -9, z: 16 });
  }
}
