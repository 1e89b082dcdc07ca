/** One figure on a canvas: a grid on the ground, its shadow, bones from the back to the front. */
import { type Clip, sample } from "./clips";
import { cividis, type Projection, projection } from "./geometry";
import { colour } from "./theme";

export interface View {
  /** radians about the vertical from where the camera stands at first, and upwards */
  yaw: number;
  pitch: number;
  zoom: number;
}

/** Share of each limb in the distance, in the order trunk, left arm, right arm, left leg, right leg. */
export type Shares = readonly number[];

const SIDES = ["trunk", "left", "right", "left", "right"];
const FINGERS = ["trunk", "finger1", "finger2", "finger3", "finger4", "finger5"];
const points = new Float32Array(3 * 512);

/** Draw a clip at a time (seconds from its beginning). */
export function draw(
  canvas: HTMLCanvasElement,
  clip: Clip,
  seconds: number,
  view: View,
  shares: Shares | null,
): void {
  const context = canvas.getContext("2d");
  if (!context) return;
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (!width || !height) return;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const { bones, radii, limbs, points: n, kind } = clip.bones;
  const hand = kind === "hand";
  const at = seconds * clip.fps;
  sample(clip.data, n * 3, clip.frames, at, points);
  const middle = new Float32Array(3);
  sample(clip.centre, 3, clip.frames, at, middle);
  const tall = hand ? 0.23 : Math.max(1.9, 1.22 * (clip.top - clip.floor));
  const look: [number, number, number] = hand
    ? [middle[0], middle[1], middle[2]]
    : [middle[0], clip.floor + 0.42 * tall, middle[2]];
  const pixels = (view.zoom * Math.min(height, width * 1.25)) / tall;
  const project = projection(clip.front + view.yaw, view.pitch, look, pixels, tall * 3.2, width, height);
  ground(context, project, look, clip.floor, hand);
  const place: [number, number, number] = [0, 0, 0];
  const screen: number[] = new Array(n * 3);
  for (let p = 0; p < n; p++) {
    project(points[3 * p], points[3 * p + 1], points[3 * p + 2], place);
    [screen[3 * p], screen[3 * p + 1], screen[3 * p + 2]] = place;
  }
  if (!hand) shadow(context, project, clip, points);
  const names = hand ? FINGERS : SIDES;
  const paper = colour("paper");
  const sorted = bones
    .map((_, k) => k)
    .sort((a, b) => depth(screen, bones[a]) - depth(screen, bones[b]));
  context.lineCap = "round";
  context.lineJoin = "round";
  const most = shares ? Math.max(...shares, 1e-9) : 1;
  for (const k of sorted) {
    const [a, b] = bones[k];
    const thick = Math.max(2 * radii[k] * pixels * (hand ? 1.15 : 1.45), 1.6);
    const tint = shares && !hand ? cividis(shares[limbs[k]] / most) : colour(names[limbs[k]] ?? "trunk");
    // an outline, so that limbs pass before one another; around thin bones less, or it would cut a limb at each joint
    line(context, screen, a, b, thick + Math.min(2.4, 0.4 * thick), shares && !hand ? colour("mark") : paper);
    line(context, screen, a, b, thick, tint);
    // the right side is told apart by more than its colour: a light line along it
    const right = hand ? false : limbs[k] === 2 || limbs[k] === 4;
    if (right && thick > 4) line(context, screen, a, b, Math.max(thick * 0.16, 0.9), paper);
  }
}

function depth(screen: number[], bone: [number, number]): number {
  return screen[3 * bone[0] + 2] + screen[3 * bone[1] + 2];
}

function line(
  context: CanvasRenderingContext2D,
  screen: number[],
  a: number,
  b: number,
  thick: number,
  tint: string,
): void {
  context.beginPath();
  context.moveTo(screen[3 * a], screen[3 * a + 1]);
  context.lineTo(screen[3 * b], screen[3 * b + 1]);
  context.lineWidth = thick;
  context.strokeStyle = tint;
  context.stroke();
}

/** A round piece of a grid about the figure; it stands still while the figure walks over it. */
function ground(
  context: CanvasRenderingContext2D,
  project: Projection,
  look: readonly number[],
  floor: number,
  hand: boolean,
): void {
  const cell = hand ? 0.02 : 0.5;
  const reach = hand ? 0.1 : 1.6;
  const a: [number, number, number] = [0, 0, 0];
  const b: [number, number, number] = [0, 0, 0];
  context.strokeStyle = colour("floor");
  context.lineWidth = 1;
  context.beginPath();
  for (const along of [0, 2]) {
    const across = 2 - along;
    for (let k = Math.ceil((look[across] - reach) / cell); k * cell <= look[across] + reach; k++) {
      const half = Math.sqrt(Math.max(reach ** 2 - (k * cell - look[across]) ** 2, 0));
      const from = [0, floor, 0];
      const to = [0, floor, 0];
      from[across] = to[across] = k * cell;
      from[along] = look[along] - half;
      to[along] = look[along] + half;
      project(from[0], from[1], from[2], a);
      project(to[0], to[1], to[2], b);
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
    }
  }
  context.stroke();
}

const TOUCHES = 0.075; // metres above the ground at which a foot's joints are when it stands

/** The figure's shadow on the ground, and a ring under each foot that stands on it. */
function shadow(context: CanvasRenderingContext2D, project: Projection, clip: Clip, at: Float32Array): void {
  const { bones, radii, limbs, points: n } = clip.bones;
  const a: [number, number, number] = [0, 0, 0];
  const b: [number, number, number] = [0, 0, 0];
  context.lineCap = "round";
  context.strokeStyle = colour("shadow");
  const unit = unitPixels(project, clip.floor, at);
  bones.forEach(([p, q], k) => {
    project(at[3 * p], clip.floor, at[3 * p + 2], a);
    project(at[3 * q], clip.floor, at[3 * q + 2], b);
    context.lineWidth = Math.max(2 * radii[k] * unit, 1);
    context.beginPath();
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
    context.stroke();
  });
  const lowest = new Map<number, number>();
  bones.forEach(([, q], k) => {
    if (limbs[k] < 3 || q >= n) return;
    const best = lowest.get(limbs[k]);
    if (best === undefined || at[3 * q + 1] < at[3 * best + 1]) lowest.set(limbs[k], q);
  });
  context.lineWidth = 2;
  context.strokeStyle = colour("contact");
  for (const point of lowest.values()) {
    if (at[3 * point + 1] - clip.floor > TOUCHES) continue;
    context.beginPath();
    for (let k = 0; k <= 20; k++) {
      const turn = (k / 20) * 2 * Math.PI;
      project(at[3 * point] + 0.1 * Math.cos(turn), clip.floor, at[3 * point + 2] + 0.1 * Math.sin(turn), a);
      if (k) context.lineTo(a[0], a[1]);
      else context.moveTo(a[0], a[1]);
    }
    context.stroke();
  }
}

function unitPixels(project: Projection, floor: number, at: Float32Array): number {
  const a: [number, number, number] = [0, 0, 0];
  const b: [number, number, number] = [0, 0, 0];
  project(at[0], floor, at[2], a);
  project(at[0], floor + 1, at[2], b);
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
