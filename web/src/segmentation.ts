/** A take's curve H with its cuts, what people called its parts, and the pieces to play. */
import { Chart } from "./chart";
import { row } from "./gestures";
import { button, choice, fill, labelled, Stage } from "./stage";

interface Take {
  corpus: string;
  take: string;
  seconds: number;
  t: number[];
  h: (number | null)[];
  cuts: number[];
  human: [number, number, string][];
  pieces: [number, number, string, string][];
}

export function segmentation(root: HTMLElement, takes: Take[]): void {
  const controls = row("controls");
  const select = choice("Take", takes.map((t, k) => [String(k), `${t.take} (${t.corpus})`]), "0", show);
  const piece = document.createElement("select");
  controls.append(labelled("take", select), labelled("piece", piece));
  const box = row("box");
  const lanes = row("lanes");
  const left = row("left");
  left.append(box, lanes);
  const stage = new Stage(row("figures"));
  stage.root.setAttribute("aria-label", "The piece that was chosen");
  root.replaceChildren(controls, left, stage.root);
  const chart = new Chart(box);
  function show(): void {
    const take = takes[Number(select.value)];
    chart.set({
      label: `Curve H of ${take.take}; cuts are vertical lines`,
      x: take.t,
      lines: [{ label: "H", values: take.h, colour: "curve" }],
      marks: take.cuts.map((at) => ({ at, words: "" })),
      xName: "seconds",
      yName: "H (logarithmic)",
      log: true,
      range: [0, take.seconds],
      placed: (start, width) => {
        lanes.style.marginLeft = `${start}px`;
        lanes.style.width = `${width}px`;
      },
    });
    const names = take.pieces.map(([start, end, , keyword], k) => `${k + 1}: ${span(start, end)}${keyword ? `, ${keyword}` : ""}`);
    fill(piece, names.map((name, k) => [String(k), name]));
    piece.onchange = () => play(Number(piece.value));
    const pieces = take.pieces.map(([start, end, clip, keyword], k) => {
      const made = button(keyword || String(k + 1), () => play(k));
      made.title = `piece ${names[k]}`;
      made.dataset.clip = clip;
      made.style.left = `${(100 * start) / take.seconds}%`;
      made.style.width = `${(100 * (end - start)) / take.seconds}%`;
      return made;
    });
    function play(k: number): void {
      const [start, end, clip, keyword] = take.pieces[k];
      pieces.forEach((p, i) => p.setAttribute("aria-pressed", String(i === k)));
      piece.value = String(k);
      stage.show([{ clip, label: `${take.take}, ${span(start, end)}${keyword ? `: ${keyword}` : ""}` }]);
    }
    const human = take.human.map(([start, end, keyword]) => {
      const made = document.createElement("span");
      made.textContent = keyword;
      made.title = `${keyword}: ${span(start, end)}`;
      made.style.left = `${(100 * start) / take.seconds}%`;
      made.style.width = `${(100 * (end - start)) / take.seconds}%`;
      return made;
    });
    lanes.replaceChildren(lane("pieces found (click to play)", pieces));
    if (human.length) lanes.append(lane("annotated", human));
    play(0);
  }
  show();
}

function span(start: number, end: number): string {
  return `${start.toFixed(1)} to ${end.toFixed(1)} s`;
}

function lane(name: string, parts: HTMLElement[]): HTMLElement {
  const made = row("lane");
  const title = document.createElement("p");
  title.textContent = name;
  const track = row("track");
  track.append(...parts);
  made.append(title, track);
  return made;
}
