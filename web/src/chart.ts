/** Curves by uPlot: read by hovering, a line at the time that the figures beside them show. */
import uPlot from "uplot";
import type { Clock } from "./clock";
import { colour, onTheme } from "./theme";

export interface Line {
  label: string;
  values: (number | null)[];
  colour: string;
  dash?: number[];
  width?: number;
  /** steps instead of a smooth line */
  steps?: boolean;
  points?: boolean;
}

export interface Spec {
  label: string;
  x: number[];
  lines: Line[];
  /** pairs of lines (by place) with the colour between them */
  bands?: { between: [number, number]; colour: string }[];
  /** vertical lines with words */
  marks?: { at: number; words: string }[];
  xName: string;
  yName: string;
  log?: boolean;
  height?: number;
  clock?: Clock;
  digits?: number;
  /** x is counted in whole numbers */
  whole?: boolean;
  /** first and last x; without it those of the data */
  range?: [number, number];
  /** told where the plot begins in its box and how wide it is, in pixels, so that others can stand below it */
  placed?: (left: number, width: number) => void;
}

/** A chart in a box; `set` shows other data. */
export class Chart {
  private plot: uPlot | null = null;
  private spec: Spec | null = null;
  private readonly needle = document.createElement("div");

  constructor(readonly box: HTMLElement) {
    box.classList.add("chart");
    this.needle.className = "needle";
    onTheme(() => this.build());
    let width = 0;
    new ResizeObserver(() => {
      if (box.clientWidth !== width && this.plot && this.spec) {
        width = box.clientWidth;
        this.plot.setSize({ width, height: this.spec.height ?? 240 });
        this.follow();
      }
    }).observe(box);
  }

  set(spec: Spec): void {
    const first = this.spec?.clock !== spec.clock;
    this.spec = spec;
    if (first && spec.clock) spec.clock.onChange(() => this.follow());
    this.build();
  }

  private follow(): void {
    const { plot, spec } = this;
    if (!plot || !spec?.clock) return;
    this.needle.style.transform = `translateX(${plot.valToPos(spec.clock.time, "x")}px)`;
  }

  private build(): void {
    const spec = this.spec;
    if (!spec) return;
    this.plot?.destroy();
    const ink = colour("soft-ink");
    const grid = { stroke: colour("grid"), width: 1 };
    const axis = { stroke: ink, grid, ticks: grid, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif" };
    const digits = spec.digits ?? 1;
    const shown = (_: uPlot, v: number | null): string => (v === null || v === undefined ? "–" : v.toFixed(digits));
    const data = [spec.x, ...spec.lines.map((l) => l.values)] as uPlot.AlignedData;
    this.plot = new uPlot(
      {
        width: this.box.clientWidth || 600,
        height: spec.height ?? 240,
        cursor: { drag: { x: false, y: false }, points: { size: 7 } },
        legend: { live: true },
        scales: { x: { time: false, ...(spec.range ? { range: spec.range } : {}) }, y: spec.log ? { distr: 3 } : {} },
        axes: [
          { ...axis, label: spec.xName, labelSize: 18, size: 30, ...(spec.whole ? { incrs: [1, 2, 5, 10, 20, 50] } : {}) },
          { ...axis, label: spec.yName, labelSize: 18, size: 52 },
        ],
        bands: (spec.bands ?? []).map((b) => ({
          series: [b.between[0] + 1, b.between[1] + 1] as [number, number],
          fill: alpha(colour(b.colour), 0.18),
        })),
        series: [
          { label: spec.xName, value: (_, v) => (v === null || v === undefined ? "–" : v.toFixed(2)) },
          ...spec.lines.map((line): uPlot.Series => ({
            label: line.label,
            stroke: colour(line.colour),
            width: line.width ?? 2,
            dash: line.dash,
            points: { show: Boolean(line.points) },
            value: shown,
            ...(line.steps ? { paths: uPlot.paths.stepped?.({ align: 1 }) } : {}),
          })),
        ],
        hooks: { drawAxes: [(u) => marks(u, spec)], drawClear: [(u) => spec.placed?.(u.over.offsetLeft, u.over.offsetWidth)] },
      },
      data,
      this.box,
    );
    const over = this.plot.over;
    const canvas = this.box.querySelector("canvas");
    canvas?.setAttribute("role", "img");
    canvas?.setAttribute("aria-label", spec.label);
    if (spec.clock) {
      over.append(this.needle);
      const clock = spec.clock;
      const seek = (event: PointerEvent): void => {
        if (event.type === "pointerdown" || event.buttons & 1) {
          clock.play(false);
          const x = event.clientX - over.getBoundingClientRect().left;
          clock.seek(this.plot?.posToVal(x, "x") ?? 0);
        }
      };
      over.addEventListener("pointerdown", seek);
      over.addEventListener("pointermove", seek);
      this.follow();
    }
  }
}

function alpha(rgb: string, a: number): string {
  const parts = rgb.match(/[\d.]+/g) ?? [];
  return `rgba(${parts.slice(0, 3).join(", ")}, ${a})`;
}

function marks(u: uPlot, spec: Spec): void {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.strokeStyle = colour("mark");
  ctx.fillStyle = colour("soft-ink");
  ctx.lineWidth = devicePixelRatio;
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textBaseline = "top";
  ctx.textAlign = "left";
  let free = -Infinity;
  for (const { at, words } of spec.marks ?? []) {
    const x = Math.round(u.valToPos(at, "x", true));
    if (x < bbox.left - 1 || x > bbox.left + bbox.width + 1) continue;
    ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    if (words && x >= free) {
      ctx.fillText(words, x + 3 * devicePixelRatio, bbox.top + 2 * devicePixelRatio);
      free = x + ctx.measureText(words).width + 6 * devicePixelRatio;
    }
  }
  ctx.restore();
}
