/** Figures that play together: canvases with captions, one clock, one camera, one row of controls. */
import { about, type Clip, load } from "./clips";
import { Clock } from "./clock";
import { draw, type Shares, type View } from "./figure";
import { onTheme } from "./theme";

export interface Cell {
  clip: string;
  /** what is said of it on assistive devices, and under the picture where `caption` gives nothing */
  label: string;
  caption?: Node | null;
  shares?: Shares | null;
  className?: string;
}

interface Shown extends Cell {
  canvas: HTMLCanvasElement;
  loaded: Clip | null;
  failed: boolean;
  seconds: number;
}

const stages = new Set<Stage>();
let running = false;
let last = 0;
let pictures = 0;

/** How many pictures have been drawn; for tests of the frame rate. */
export const drawn = (): number => pictures;

/** Milliseconds that drawing all figures in view takes, the middle of so many times; for tests. */
export function cost(times: number): number {
  const taken = Array.from({ length: times }, () => {
    const start = performance.now();
    for (const stage of stages) stage.redraw();
    for (const stage of stages) stage.step(0);
    return performance.now() - start;
  });
  return taken.sort((a, b) => a - b)[Math.floor(times / 2)];
}

function frame(now: number): void {
  const passed = Math.min((now - last) / 1000, 0.1);
  last = now;
  let more = false;
  for (const stage of stages) more = stage.step(passed) || more;
  running = more;
  if (more) requestAnimationFrame(frame);
}

function wake(): void {
  if (running) return;
  running = true;
  last = performance.now();
  requestAnimationFrame(frame);
}

const calm = matchMedia("(prefers-reduced-motion: reduce)");
const seen = new IntersectionObserver(
  (entries) => {
    for (const entry of entries) {
      for (const stage of stages) if (stage.root === entry.target) stage.visible(entry.isIntersecting);
    }
  },
  { rootMargin: "80px" },
);

export interface Options {
  /** Clips are stretched to the length of the first, so that all begin and end together. */
  stretch?: boolean;
  /** Whether colours can show how much each limb adds to the distance. */
  shares?: boolean;
  clock?: Clock;
}

export class Stage {
  readonly clock: Clock;
  private cells: Shown[] = [];
  private view: View = { yaw: 0, pitch: 0.2, zoom: 1 };
  private inView = false;
  private dirty = true;
  private started = false;
  private stretch: boolean;
  private byShares = false;
  private readonly grid: HTMLDivElement;
  private readonly slider: HTMLInputElement;
  private readonly playButton: HTMLButtonElement;
  private readonly timeText: HTMLOutputElement;

  constructor(
    readonly root: HTMLElement,
    options: Options = {},
  ) {
    this.clock = options.clock ?? new Clock();
    this.stretch = Boolean(options.stretch);
    root.classList.add("stage");
    root.setAttribute("role", "group");
    if (!root.hasAttribute("aria-label")) root.setAttribute("aria-label", "Figures that play");
    this.grid = document.createElement("div");
    this.grid.className = "cells";
    const bar = document.createElement("div");
    bar.className = "bar";
    this.playButton = button("Play", () => this.clock.play(!this.clock.playing));
    this.playButton.classList.add("play");
    this.slider = document.createElement("input");
    this.slider.type = "range";
    this.slider.step = "0.01";
    this.slider.setAttribute("aria-label", "Time in seconds");
    this.slider.addEventListener("input", () => {
      const wanted = Number(this.slider.value); // stopping the clock moves the slider to where the clock is
      this.clock.play(false);
      this.clock.seek(wanted);
    });
    this.timeText = document.createElement("output");
    this.timeText.className = "time";
    bar.append(this.playButton, this.slider, this.timeText);
    bar.append(
      choice("Speed", [["0.25", "¼ speed"], ["0.5", "½ speed"], ["1", "full speed"], ["2", "2 × speed"]], "1", (v) => {
        this.clock.rate = Number(v);
      }),
    );
    if (options.stretch) {
      bar.append(
        choice("Pace", [["stretch", "begin and end together"], ["own", "each at its own pace"]], "stretch", (v) => {
          this.stretch = v === "stretch";
          this.measure();
        }),
      );
    }
    if (options.shares) {
      bar.append(
        choice("Colour", [["sides", "colour: left and right"], ["shares", "colour: share of the distance"]], "sides", (v) => {
          this.byShares = v === "shares";
          root.classList.toggle("by-shares", this.byShares);
          this.redraw();
        }),
      );
    }
    root.replaceChildren(this.grid, bar);
    this.clock.onChange(() => this.told());
    onTheme(() => this.redraw());
    root.addEventListener("keydown", (event) => this.key(event));
    this.orbit();
    new ResizeObserver(() => this.redraw()).observe(root);
    stages.add(this);
    seen.observe(root);
  }

  /** Show these; what the page does not hold is said in words. */
  show(cells: Cell[]): void {
    this.grid.replaceChildren();
    this.cells = cells.map((cell) => {
      const figure = document.createElement("figure");
      figure.className = `cell ${cell.className ?? ""}`;
      const canvas = document.createElement("canvas");
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", cell.label);
      const given = about(cell.clip);
      if (!given) {
        const none = document.createElement("p");
        none.className = "absent";
        none.textContent = "not in this page, to keep it small";
        figure.append(none);
      } else figure.append(canvas);
      const caption = document.createElement("figcaption");
      caption.append(cell.caption ?? cell.label);
      figure.append(caption);
      this.grid.append(figure);
      return { ...cell, canvas, loaded: null, failed: !given, seconds: given?.seconds ?? 0 };
    });
    this.measure();
    if (this.inView) this.decode();
  }

  /** Decode and draw everything now, in view or not. */
  async ready(): Promise<void> {
    await Promise.all(this.decode());
    this.inView = true;
    this.redraw();
  }

  private measure(): void {
    const all = this.cells.map((c) => c.seconds);
    this.clock.span(0, (this.stretch ? all[0] : Math.max(...all, 0)) || Math.max(...all, 0) || 1);
    this.redraw();
  }

  private decode(): Promise<void>[] {
    return this.cells.map(async (cell) => {
      if (cell.loaded || cell.failed) return;
      try {
        cell.loaded = await load(cell.clip);
      } catch (error) {
        cell.failed = true;
        console.error(error);
      }
      this.redraw();
    });
  }

  visible(yes: boolean): void {
    this.inView = yes;
    if (!yes) return;
    this.decode();
    if (!this.started) {
      this.started = true;
      if (!calm.matches && this.root.dataset.still === undefined) this.clock.play(true);
    }
    wake();
  }

  private told(): void {
    this.dirty = true;
    this.slider.min = String(this.clock.start);
    this.slider.max = String(this.clock.end);
    this.slider.value = String(this.clock.time);
    const digits = (x: number): string => x.toFixed(1);
    this.timeText.textContent = `${digits(this.clock.time)} / ${digits(this.clock.end)} s`;
    const words = this.clock.playing ? "Pause" : "Play";
    if (this.playButton.textContent !== words) this.playButton.textContent = words;
    wake();
  }

  redraw(): void {
    this.dirty = true;
    wake();
  }

  /** One step of the animation; false: nothing moves. */
  step(passed: number): boolean {
    if (!this.inView) return false;
    this.clock.advance(passed);
    if (this.dirty) {
      this.dirty = false;
      const share = (this.clock.time - 0) / (this.clock.end || 1);
      for (const cell of this.cells) {
        if (!cell.loaded) continue;
        const at = this.stretch ? share * cell.seconds : this.clock.time;
        draw(cell.canvas, cell.loaded, Math.min(at, cell.seconds), this.view, this.byShares ? (cell.shares ?? null) : null);
        pictures++;
        cell.canvas.dataset.drawn = "yes";
      }
    }
    return this.clock.playing;
  }

  private key(event: KeyboardEvent): void {
    const on = event.target as HTMLElement;
    if (on.tagName === "SELECT" || on.tagName === "A") return;
    const turn = { a: [-0.15, 0], d: [0.15, 0], w: [0, 0.1], s: [0, -0.1] }[event.key];
    if (event.key === " " && on.tagName !== "BUTTON") this.clock.play(!this.clock.playing);
    else if (event.key === "," || event.key === ".") {
      this.clock.play(false);
      this.clock.seek(this.clock.time + (event.key === "," ? -1 : 1) / 30);
    } else if (turn) this.turn(turn[0], turn[1]);
    else if (event.key === "0") this.view = { yaw: 0, pitch: 0.2, zoom: 1 };
    else if (event.key === "+" || event.key === "-") {
      this.view.zoom = Math.min(Math.max(this.view.zoom * (event.key === "+" ? 1.15 : 1 / 1.15), 0.4), 4);
    } else return;
    event.preventDefault();
    this.redraw();
  }

  private turn(yaw: number, pitch: number): void {
    this.view.yaw += yaw;
    this.view.pitch = Math.min(Math.max(this.view.pitch + pitch, -0.3), 1.5);
    this.redraw();
  }

  private orbit(): void {
    let from: { x: number; y: number } | null = null;
    this.grid.addEventListener("pointerdown", (event) => {
      if (!(event.target instanceof HTMLCanvasElement)) return;
      from = { x: event.clientX, y: event.clientY };
      event.target.setPointerCapture(event.pointerId);
    });
    this.grid.addEventListener("pointermove", (event) => {
      if (!from) return;
      this.turn((from.x - event.clientX) * 0.01, event.pointerType === "touch" ? 0 : (event.clientY - from.y) * 0.006);
      from = { x: event.clientX, y: event.clientY };
    });
    for (const name of ["pointerup", "pointercancel"]) this.grid.addEventListener(name, () => (from = null));
    this.grid.addEventListener("dblclick", () => {
      this.view = { yaw: 0, pitch: 0.2, zoom: 1 };
      this.redraw();
    });
  }
}

export function button(words: string, act: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = words;
  made.addEventListener("click", act);
  return made;
}

/** A list to choose from, with a name for assistive devices. */
export function choice(
  name: string,
  options: [string, string][],
  chosen: string,
  act: (value: string) => void,
): HTMLSelectElement {
  const made = document.createElement("select");
  made.setAttribute("aria-label", name);
  fill(made, options, chosen);
  made.addEventListener("change", () => act(made.value));
  return made;
}

export function fill(select: HTMLSelectElement, options: [string, string][], chosen?: string): void {
  select.replaceChildren(
    ...options.map(([value, words]) => {
      const option = document.createElement("option");
      option.value = value;
      option.textContent = words;
      option.selected = value === chosen;
      return option;
    }),
  );
}

/** A choice with its name before it. */
export function labelled(name: string, select: HTMLSelectElement): HTMLLabelElement {
  const label = document.createElement("label");
  label.className = "choice";
  select.removeAttribute("aria-label");
  label.append(`${name} `, select);
  return label;
}
