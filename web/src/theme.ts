/** Light and dark: the system's choice until somebody chooses; colours of the style sheet for canvases. */
const listeners = new Set<() => void>();
const dark = matchMedia("(prefers-color-scheme: dark)");
const resolved = new Map<string, string>();

export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : dark.matches;
}

export function onTheme(listener: () => void): void {
  listeners.add(listener);
}

function changed(): void {
  resolved.clear();
  for (const listener of listeners) listener();
}

/** A colour of the style sheet as `rgb(…)`. */
export function colour(name: string): string {
  let found = resolved.get(name);
  if (found === undefined) {
    const probe = document.createElement("span");
    probe.style.color = `var(--${name})`;
    probe.hidden = true;
    document.body.append(probe);
    found = getComputedStyle(probe).color;
    probe.remove();
    resolved.set(name, found);
  }
  return found;
}

export function startTheme(): void {
  const root = document.documentElement;
  const set = (choice: string): void => {
    if (choice) root.dataset.theme = choice;
    else delete root.dataset.theme;
    changed();
  };
  dark.addEventListener("change", changed);
  for (const button of document.querySelectorAll<HTMLButtonElement>("button[data-theme-switch]")) {
    button.hidden = false;
    const show = (): void => {
      button.textContent = isDark() ? "Light" : "Dark";
      button.title = `Switch to the ${isDark() ? "light" : "dark"} theme`;
    };
    onTheme(show);
    button.addEventListener("click", () => set(isDark() ? "light" : "dark"));
    show();
  }
  let before: string | undefined;
  addEventListener("beforeprint", () => {
    before = root.dataset.theme;
    set("light");
    for (const fold of document.querySelectorAll<HTMLDetailsElement>("main details")) fold.open = true;
  });
  addEventListener("afterprint", () => set(before ?? ""));
}
