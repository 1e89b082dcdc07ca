import { cividis } from "./geometry";
import { gestures, models } from "./gestures";
import { retrieval } from "./retrieval";
import { search } from "./search";
import { segmentation } from "./segmentation";
import { cost, drawn } from "./stage";
import { sortable } from "./tables";
import { startTheme } from "./theme";
import { inPage, unpackJson } from "./unpack";

/** What a part of the page does with its packed structure. */
const PARTS: Record<string, (root: HTMLElement, data: any) => void | Promise<void>> = {
  gestures,
  models: (root, data) => models(root, data.joints, data.models, cividis),
  segmentation,
  retrieval: (root, data) => retrieval(root, data.experiments, data.measure),
  search,
};

/** A part is built when it comes near the window. */
function lazily(root: HTMLElement): void {
  const name = root.dataset.part ?? "";
  const watcher = new IntersectionObserver(
    async (entries) => {
      if (!entries.some((e) => e.isIntersecting)) return;
      watcher.disconnect();
      const text = inPage("pack", name);
      if (text === null || !PARTS[name]) return;
      await PARTS[name](root, await unpackJson(text));
      root.dataset.ready = "yes";
    },
    { rootMargin: "300px" },
  );
  watcher.observe(root);
}

function contents(): void {
  const links = [...document.querySelectorAll<HTMLAnchorElement>("nav.contents a[href^='#']")];
  const watcher = new IntersectionObserver(
    (entries) => {
      for (const entry of entries) {
        if (!entry.isIntersecting) continue;
        for (const link of links) {
          if (link.hash === `#${entry.target.id}`) link.setAttribute("aria-current", "true");
          else link.removeAttribute("aria-current");
        }
      }
    },
    { rootMargin: "-10% 0px -80% 0px" },
  );
  for (const section of document.querySelectorAll("main section[id]")) watcher.observe(section);
  const fold = document.querySelector<HTMLDetailsElement>("nav.contents details");
  if (fold && matchMedia("(min-width: 70rem)").matches) fold.open = true;
}

startTheme();
contents();
for (const table of document.querySelectorAll<HTMLTableElement>("table.sortable")) sortable(table);
for (const root of document.querySelectorAll<HTMLElement>("[data-part]")) lazily(root);
(window as unknown as { miburi: object }).miburi = { cost, drawn };
