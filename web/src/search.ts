/** A user's own query beside what was found for it; each clip can be kept as BVH. */
import { row } from "./gestures";
import { Stage } from "./stage";
import { gunzip } from "./unpack";

interface Result {
  rank: number;
  clip: string;
  take: string;
  file: string;
  words: string;
  shares: number[] | null;
}

interface Search {
  query: { clip: string; words: string };
  results: Result[];
}

export function search(root: HTMLElement, found: Search): void {
  const stage = new Stage(row("figures results"), { stretch: true, shares: true });
  stage.root.setAttribute("aria-label", "The query and its first results");
  root.replaceChildren(stage.root);
  stage.show([
    { clip: found.query.clip, label: found.query.words, className: "query" },
    ...found.results.map((r) => ({
      clip: r.clip,
      label: `result ${r.rank}: ${r.take}, ${r.words}`,
      caption: caption(r),
      shares: r.shares,
    })),
  ]);
}

function caption(result: Result): Node {
  const made = document.createDocumentFragment();
  const number = document.createElement("b");
  number.textContent = String(result.rank);
  const words = document.createElement("span");
  words.textContent = result.take;
  const where = document.createElement("small");
  where.textContent = result.words;
  made.append(number, " ", words, document.createElement("br"), where);
  const packed = [...document.querySelectorAll<HTMLScriptElement>("script[data-bvh]")].find((s) => s.dataset.bvh === result.file);
  if (packed) {
    const link = document.createElement("a");
    link.textContent = "BVH";
    link.download = result.file;
    link.setAttribute("aria-label", `Download result ${result.rank} as BVH`);
    link.href = "#";
    link.addEventListener("click", async (event) => {
      if (link.href.startsWith("blob:")) return;
      event.preventDefault();
      const bytes = await gunzip(packed.textContent ?? "");
      link.href = URL.createObjectURL(new Blob([bytes as BlobPart], { type: "text/plain" }));
      link.click();
    });
    made.append(" ", link);
  }
  return made;
}
