/** A camera that orbits, and a scale of colours; without a browser. */

const SCALE = [
  [0, 32, 76],
  [86, 92, 108],
  [163, 153, 112],
  [255, 233, 69],
]; // cividis, made for colour-blind readers

/** A colour of cividis for a value from 0 to 1. */
export function cividis(value: number): string {
  const x = Math.min(Math.max(value, 0), 1) * (SCALE.length - 1);
  const k = Math.min(Math.floor(x), SCALE.length - 2);
  const mix = SCALE[k].map((low, i) => Math.round(low + (SCALE[k + 1][i] - low) * (x - k)));
  return `rgb(${mix.join(", ")})`;
}

/** Where a point is on the canvas, pixels, and how near it is (larger is nearer); written to `out`. */
export interface Projection {
  (x: number, y: number, z: number, out: [number, number, number]): void;
}

/** An orbiting camera that looks at a point; nearer things are larger. */
export function projection(
  yaw: number,
  pitch: number,
  centre: readonly [number, number, number],
  pixels: number,
  distance: number,
  width: number,
  height: number,
): Projection {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return (x, y, z, out) => {
    const [dx, dy, dz] = [x - centre[0], y - centre[1], z - centre[2]];
    const right = cy * dx - sy * dz;
    const ahead = sy * dx + cy * dz;
    const up = cp * dy - sp * ahead;
    const near = sp * dy + cp * ahead;
    const scale = (pixels * distance) / Math.max(distance - near, 0.2 * distance);
    out[0] = width / 2 + right * scale;
    out[1] = height / 2 - up * scale;
    out[2] = near;
  };
}
