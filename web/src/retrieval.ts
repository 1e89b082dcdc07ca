/** A query played beside what a measure ranks first for it. */
import { row } from "./gestures";
import { button, type Cell, choice, fill, labelled, Stage } from "./stage";

/** take, first and last second, clip, keywords */
type Segment = [string, number, number, string, string];

interface Query {
  name: string;
  protocol: number;
  keyword: string;
  user: string;
  style: string;
  clip: string;
  target: number | null;
}

interface Experiment {
  name: string;
  corpus: string;
  segments: Record<string, Segment>;
  queries: Query[];
  measures: { name: string; first: number[][]; score: number[][]; rank: number[] }[];
  shares: Record<string, Record<string, number[]>>;
}

const MEANING: Record<number, string> = {
  1: "1: the clip was shown",
  2: "2: only the keyword",
  3: "3: other people's motion",
};

export function retrieval(root: HTMLElement, all: Experiment[], preferred: string): void {
  const controls = row("controls");
  const about = document.createElement("p");
  about.className = "about";
  about.setAttribute("aria-live", "polite");
  const stage = new Stage(row("figures results"), { stretch: true, shares: true });
  stage.root.setAttribute("aria-label", "The query and its first ten results");
  const selects = {
    experiment: choice("", all.map((e, k) => [String(k), e.name]), "0", () => experiment()),
    protocol: document.createElement("select"),
    keyword: document.createElement("select"),
    user: document.createElement("select"),
    measure: document.createElement("select"),
  };
  for (const [name, select] of Object.entries(selects)) {
    if (name !== "experiment") select.addEventListener("change", () => (name === "measure" ? show() : narrow(name)));
    controls.append(labelled(name, select));
  }
  controls.append(button("another query", another));
  root.replaceChildren(controls, about, stage.root);
  const now = (): Experiment => all[Number(selects.experiment.value)];

  function experiment(): void {
    const e = now();
    const protocols = [...new Set(e.queries.map((q) => q.protocol))];
    fill(selects.protocol, protocols.map((p) => [String(p), MEANING[p] ?? String(p)]));
    const names = e.measures.map((m) => m.name);
    const best = [preferred, selects.measure.value].find((m) => names.includes(m)) ?? names[0];
    fill(selects.measure, names.map((m) => [m, m]), best);
    narrow("protocol");
  }

  function narrow(changed: string): void {
    const e = now();
    const fits = e.queries.filter((q) => String(q.protocol) === selects.protocol.value);
    if (changed === "protocol") {
      const keywords = [...new Set(fits.map((q) => q.keyword))];
      fill(selects.keyword, keywords.map((k) => [k, k]), keywords.includes(selects.keyword.value) ? selects.keyword.value : keywords[0]);
    }
    if (changed !== "user") {
      const users = fits.filter((q) => q.keyword === selects.keyword.value);
      const kept = users.find((q) => q.user === selects.user.value);
      fill(selects.user, users.map((q) => [q.user, `${q.user.replace(/^.*-(?=\D+-\d+$|\d+$)/, "")} (${q.style})`]), (kept ?? users[0])?.user);
    }
    show();
  }

  function another(): void {
    const e = now();
    const place = e.queries.findIndex((q) => q === current());
    const next = e.queries[(place + 1) % e.queries.length];
    selects.protocol.value = String(next.protocol);
    narrow("protocol");
    selects.keyword.value = next.keyword;
    narrow("keyword");
    selects.user.value = next.user;
    show();
  }

  function current(): Query | undefined {
    return now().queries.find(
      (q) => String(q.protocol) === selects.protocol.value && q.keyword === selects.keyword.value && q.user === selects.user.value,
    );
  }

  function show(): void {
    const e = now();
    const query = current();
    const measure = e.measures.find((m) => m.name === selects.measure.value);
    if (!query || !measure) return;
    const place = e.queries.indexOf(query);
    const shares = e.shares[query.name] ?? {};
    const found = measure.first[place] ?? [];
    const cells: Cell[] = [
      { clip: query.clip, label: `query: a simulated user plays “${query.keyword}”`, className: "query" },
    ];
    if (query.target !== null && e.segments[query.target]) {
      const target = e.segments[query.target];
      cells.push({ clip: target[3], label: `the clip that was shown: ${span(target)}`, className: "query" });
    }
    found.forEach((i, k) => {
      const segment = e.segments[i];
      if (!segment) return;
      const right = segment[4].split(", ").includes(query.keyword);
      const isTarget = i === query.target;
      cells.push({
        clip: segment[3],
        label: `result ${k + 1}: ${span(segment)}, ${segment[4] || "no keyword"}`,
        caption: caption(k + 1, segment, measure.score[place][k], right, isTarget),
        shares: shares[i] ?? null,
        className: right ? "hit" : "miss",
      });
    });
    const hits = found.filter((i) => e.segments[i]?.[4].split(", ").includes(query.keyword)).length;
    const rank = measure.rank[place];
    about.textContent =
      `${hits} of the first ${found.length} have the keyword “${query.keyword}”` +
      (query.target !== null && rank > 0 ? `; the clip that was shown is ranked ${rank}` : "") +
      `. Ranked by ${measure.name} in ${e.corpus}.`;
    stage.show(cells);
  }
  experiment();
}

function span(segment: Segment): string {
  return `${segment[0]}, ${segment[1].toFixed(1)}–${segment[2].toFixed(1)} s`;
}

function caption(rank: number, segment: Segment, score: number, right: boolean, target: boolean): Node {
  const made = document.createDocumentFragment();
  const number = document.createElement("b");
  number.textContent = `${rank} ${right ? "✓" : "·"}`;
  const words = document.createElement("span");
  words.textContent = `${segment[4] || "no keyword"}${target ? " (the shown clip)" : ""}`;
  const where = document.createElement("small");
  where.textContent = `${span(segment)}; distance ${score.toPrecision(3)}`;
  made.append(number, " ", words, document.createElement("br"), where);
  return made;
}
