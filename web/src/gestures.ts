/** Figures 4, 5 and 6 of [H]: a generated hand beside its curve, against recordings put end to end. */
import { Chart, type Line } from "./chart";
import { button, choice, fill, labelled, Stage } from "./stage";
import { inPage, unpackNumbers } from "./unpack";

interface Curve {
  clip: string;
  numbers: string;
  frames: number;
  boundaries: number[];
}

interface Gesture {
  name: string;
  fps: number;
  unit: number;
  joints: string[];
  joint: number;
  labels: string[];
  generated: Curve;
  spliced: Curve | null;
  mean: string;
  sd: string;
  source: string;
}

export async function gestures(root: HTMLElement, all: Gesture[]): Promise<void> {
  const numbers = async (name: string, frames: number, unit: number): Promise<Float32Array> => {
    const text = inPage("numbers", name);
    if (text === null) throw new Error(`the page holds no numbers ${name}`);
    return unpackNumbers(text, frames, unit);
  };
  const controls = row("controls");
  const stage = new Stage(row("figures"));
  stage.root.setAttribute("aria-label", "The generated hand and the recordings put end to end");
  const left = row("left");
  const [one, two] = [row("box"), row("box")];
  const heads = [one, two].map((box) => {
    const head = document.createElement("h3");
    left.append(head, box);
    return head;
  });
  root.replaceChildren(controls, left, stage.root);
  const [generated, spliced] = [new Chart(one), new Chart(two)];
  const strings = choice("String", all.map((g) => [g.name, g.name.replaceAll("_", " ")]), all[0].name, () => void show());
  const joints = document.createElement("select");
  fill(joints, all[0].joints.map((name, k) => [String(k), name]), String(all[0].joint));
  joints.addEventListener("change", () => void show(true));
  if (all.length > 1) controls.append(labelled("string", strings));
  controls.append(labelled("joint", joints));
  const parts = document.createElement("span");
  parts.className = "parts";
  controls.append(parts);

  async function show(sameString = false): Promise<void> {
    const g = all.find((x) => x.name === strings.value) ?? all[0];
    const width = g.joints.length;
    const j = Number(joints.value);
    const take = (data: Float32Array): number[] => Array.from({ length: data.length / width }, (_, t) => data[t * width + j]);
    const seconds = (n: number): number[] => Array.from({ length: n }, (_, t) => t / g.fps);
    const x = take(await numbers(g.generated.numbers, g.generated.frames, g.unit));
    const mean = take(await numbers(g.mean, g.generated.frames, g.unit));
    const sd = take(await numbers(g.sd, g.generated.frames, g.unit));
    const line = (label: string, values: (number | null)[], colour: string, more: Partial<Line> = {}): Line => ({ label, values, colour, ...more });
    heads[0].textContent = "Generated (figure 4)";
    generated.set({
      label: `Angle ${g.joints[j]} of the generated motion, with mean and deviation of each state`,
      x: seconds(x.length),
      lines: [
        line("generated", x, "curve"),
        line("state's mean", mean, "soft-ink", { steps: true, width: 1 }),
        line("mean + σ", mean.map((m, t) => m + sd[t]), "band", { steps: true, width: 0 }),
        line("mean − σ", mean.map((m, t) => m - sd[t]), "band", { steps: true, width: 0 }),
      ],
      bands: [{ between: [2, 3], colour: "soft-ink" }],
      marks: g.generated.boundaries.slice(0, -1).map((b, k) => ({ at: b / g.fps, words: g.labels[k] })),
      xName: "seconds",
      yName: "degrees",
      clock: stage.clock,
    });
    if (g.spliced) {
      const pieces = take(await numbers(g.spliced.numbers, g.spliced.frames, g.unit));
      const n = Math.max(pieces.length, x.length);
      const padded = (values: number[]): (number | null)[] => Array.from({ length: n }, (_, t) => values[t] ?? null);
      heads[1].textContent = `The same labels cut from ${g.source} intervals and put end to end (figure 5)`;
      spliced.set({
        label: `Angle ${g.joints[j]} of intervals put end to end, beside the generated motion`,
        x: seconds(n),
        lines: [line("put end to end", padded(pieces), "other"), line("generated", padded(x), "curve", { width: 1, dash: [5, 4] })],
        marks: g.spliced.boundaries.slice(0, -1).map((b, k) => ({ at: b / g.fps, words: g.labels[k] })),
        xName: "seconds",
        yName: "degrees",
        clock: stage.clock,
      });
    }
    if (sameString) return;
    const cells = [{ clip: g.generated.clip, label: `generated from ${g.source} intervals` }];
    if (g.spliced) cells.push({ clip: g.spliced.clip, label: `${g.source} intervals put end to end` });
    stage.show(cells);
    const whole = (): void => stage.clock.span(0, Math.max(g.generated.frames, g.spliced?.frames ?? 0) / g.fps);
    whole();
    const changes = g.labels
      .map((label, k) => ({ label, k }))
      .filter(({ label }, k, list) => label.length > 1 && list.findIndex((l) => l.label === label) === k);
    parts.replaceChildren(
      button("all", whole),
      ...changes.map(({ label, k }) =>
        button(label, () => {
          stage.clock.span(Math.max(g.generated.boundaries[k] / g.fps - 0.2, 0), g.generated.boundaries[k + 1] / g.fps + 0.2);
          stage.clock.seek(stage.clock.start);
          stage.clock.play(true);
        }),
      ),
    );
    parts.prepend("repeat: ");
  }
  await show();
}

interface Model {
  label: string;
  corpus: string;
  fps: number | null;
  duration_mean: number[];
  duration_sd: number[];
  log_likelihood: number[];
  mean: number[][];
  sd: number[][];
}

/** A label's model: angles of each state, how long it lasts, likelihood after each iteration. */
export function models(root: HTMLElement, joints: string[], all: Model[], scale: (v: number) => string): void {
  const controls = row("controls");
  const select = choice("Label", all.map((m, k) => [String(k), m.label]), "0", show);
  controls.append(labelled("label", select));
  const likelihood = row("box");
  const durations = row("box");
  const table = document.createElement("table");
  const scroll = row("scroll");
  scroll.tabIndex = 0;
  scroll.setAttribute("role", "region");
  scroll.setAttribute("aria-label", "Angles of each state");
  scroll.append(table);
  const titled = (words: string, box: HTMLElement): HTMLElement => {
    const outer = row("left");
    const head = document.createElement("h3");
    head.textContent = words;
    outer.append(head, box);
    return outer;
  };
  root.replaceChildren(
    controls,
    titled("Likelihood after each iteration", likelihood),
    titled("Durations of the states", durations),
    titled("Angles of the states: mean ± deviation, degrees", scroll),
  );
  root.lastElementChild?.classList.add("wide");
  const [a, b] = [new Chart(likelihood), new Chart(durations)];
  function show(): void {
    const m = all[Number(select.value)];
    a.set({
      label: `Log-likelihood of ${m.label} after each iteration`,
      x: m.log_likelihood.map((_, k) => k),
      lines: [{ label: "log-likelihood", values: m.log_likelihood, colour: "curve", points: true }],
      xName: "iteration",
      yName: "",
      digits: 0,
      whole: true,
      height: 200,
    });
    const states = m.duration_mean.map((_, k) => k + 1);
    b.set({
      label: `Durations of the states of ${m.label}`,
      x: states,
      lines: [
        { label: "mean, frames", values: m.duration_mean, colour: "curve", points: true },
        { label: "mean + σ", values: m.duration_mean.map((d, k) => d + m.duration_sd[k]), colour: "band", width: 0 },
        { label: "mean − σ", values: m.duration_mean.map((d, k) => Math.max(d - m.duration_sd[k], 0)), colour: "band", width: 0 },
      ],
      bands: [{ between: [1, 2], colour: "curve" }],
      xName: "state",
      yName: "frames",
      whole: true,
      height: 200,
    });
    const head = document.createElement("thead");
    const cells = (tag: "th" | "td", words: string[]): HTMLTableRowElement => {
      const made = document.createElement("tr");
      made.append(...words.map((w, k) => Object.assign(document.createElement(k ? tag : "th"), { textContent: w })));
      made.cells[0].scope = "row";
      made.cells[0].className = "names";
      return made;
    };
    head.append(cells("th", ["angle", ...states.map((s) => `state ${s}`)]));
    for (const th of head.querySelectorAll("th")) th.scope = "col";
    const body = document.createElement("tbody");
    const [low, high] = [Math.min(...m.mean.flat()), Math.max(...m.mean.flat())];
    joints.forEach((name, j) => {
      const line = cells("td", [name, ...m.mean.map((s, k) => `${s[j].toFixed(1)} ± ${m.sd[k][j].toFixed(1)}`)]);
      m.mean.forEach((s, k) => {
        const cell = line.cells[k + 1];
        cell.classList.add("n", "heat");
        const bar = document.createElement("i");
        const share = (s[j] - low) / (high - low || 1);
        bar.style.background = scale(share);
        bar.style.inlineSize = `${Math.round(8 + 92 * share)}%`;
        cell.append(bar);
      });
      body.append(line);
    });
    table.replaceChildren(head, body);
  }
  show();
}

export function row(name: string): HTMLDivElement {
  const made = document.createElement("div");
  made.className = name;
  return made;
}
