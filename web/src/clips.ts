/** Motions of the page: what is known of each at once, and its points once they are decoded. */
import { inPage, unpackNumbers } from "./unpack";

export interface Skeleton {
  kind: "hand" | "body";
  points: number;
  bones: [number, number][];
  radii: number[];
  limbs: number[];
}

export interface About {
  skeleton: number;
  frames: number;
  fps: number;
  unit: number;
  floor: number;
  front: number;
}

export interface Clip extends About {
  name: string;
  bones: Skeleton;
  seconds: number;
  /** frames × points × 3, metres */
  data: Float32Array;
  /** height of the highest point of all frames, metres */
  top: number;
  /** where the camera looks at each frame: x, y, z */
  centre: Float32Array;
}

interface Facts {
  skeletons: Skeleton[];
  clips: Record<string, About>;
}

let facts: Facts | null = null;
const decoded = new Map<string, Promise<Clip>>();

function known(): Facts {
  facts ??= JSON.parse(document.getElementById("clips")?.textContent ?? '{"skeletons":[],"clips":{}}') as Facts;
  return facts;
}

export function about(name: string): (About & { seconds: number }) | null {
  const found = known().clips[name];
  return found ? { ...found, seconds: found.frames / found.fps } : null;
}

/** Decode a clip; the same clip is decoded once. */
export function load(name: string): Promise<Clip> {
  let clip = decoded.get(name);
  if (!clip) {
    clip = decode(name);
    decoded.set(name, clip);
  }
  return clip;
}

async function decode(name: string): Promise<Clip> {
  const given = about(name);
  const text = inPage("clip", name);
  if (!given || text === null) throw new Error(`the page holds no motion ${name}`);
  const bones = known().skeletons[given.skeleton];
  const data = await unpackNumbers(text, given.frames, given.unit);
  let top = -Infinity;
  for (let k = 1; k < data.length; k += 3) top = Math.max(top, data[k]);
  return { ...given, name, bones, data, top, centre: centres(data, given.frames, bones, given.fps) };
}

/** Middle of the figure over time, smoothed over a second, so that who walks stays in the picture. */
export function centres(data: Float32Array, frames: number, bones: Skeleton, fps: number): Float32Array {
  const width = bones.points * 3;
  const out = new Float32Array(frames * 3);
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < data.length; k++) {
    const axis = k % 3;
    low[axis] = Math.min(low[axis], data[k]);
    high[axis] = Math.max(high[axis], data[k]);
  }
  const still = bones.kind === "hand" || Math.hypot(high[0] - low[0], high[2] - low[2]) < 2.4;
  const reach = Math.round(fps / 2);
  for (let t = 0; t < frames; t++) {
    const first = Math.max(0, t - reach);
    const last = Math.min(frames - 1, t + reach);
    let x = 0;
    let z = 0;
    for (let s = first; s <= last; s++) {
      x += data[s * width];
      z += data[s * width + 2];
    }
    const n = last - first + 1;
    out[t * 3] = still ? (low[0] + high[0]) / 2 : x / n;
    out[t * 3 + 1] = (low[1] + high[1]) / 2;
    out[t * 3 + 2] = still ? (low[2] + high[2]) / 2 : z / n;
  }
  return out;
}

/** Values between two frames: a Catmull-Rom curve through the frames. */
export function sample(data: Float32Array, width: number, frames: number, at: number, out: Float32Array): void {
  const t = Math.min(Math.max(at, 0), frames - 1);
  const k = Math.min(Math.floor(t), Math.max(frames - 2, 0));
  const u = t - k;
  const a = Math.max(k - 1, 0) * width;
  const b = k * width;
  const c = Math.min(k + 1, frames - 1) * width;
  const d = Math.min(k + 2, frames - 1) * width;
  const u2 = u * u;
  const u3 = u2 * u;
  const wa = -0.5 * u3 + u2 - 0.5 * u;
  const wb = 1.5 * u3 - 2.5 * u2 + 1;
  const wc = -1.5 * u3 + 2 * u2 + 0.5 * u;
  const wd = 0.5 * u3 - 0.5 * u2;
  for (let i = 0; i < width; i++) out[i] = wa * data[a + i] + wb * data[b + i] + wc * data[c + i] + wd * data[d + i];
}
