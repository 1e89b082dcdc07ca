/** What report/pack.py packed: base64 of gzip, taken apart by the browser when it is needed. */

export async function gunzip(text: string): Promise<Uint8Array> {
  const bytes = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Rows × columns of numbers, row after row; the counterpart of `pack.packed`. */
export async function unpackNumbers(text: string, rows: number, unit: number): Promise<Float32Array> {
  return fromPlanes(await gunzip(text), rows, unit);
}

export function fromPlanes(data: Uint8Array, rows: number, unit: number): Float32Array {
  const count = data.length / 2;
  const columns = count / rows;
  const out = new Float32Array(count);
  for (let c = 0, k = 0; c < columns; c++) {
    let value = 0;
    for (let r = 0; r < rows; r++, k++) {
      const code = data[k] | (data[count + k] << 8);
      value = ((value + ((code >>> 1) ^ -(code & 1))) << 16) >> 16;
      out[r * columns + c] = value * unit;
    }
  }
  return out;
}

export async function unpackJson<T>(text: string): Promise<T> {
  return JSON.parse(new TextDecoder().decode(await gunzip(text))) as T;
}

/** The packed text of that name in the page; null where the page has none. */
export function inPage(kind: "clip" | "pack" | "numbers", name: string): string | null {
  for (const script of document.querySelectorAll<HTMLScriptElement>(`script[data-${kind}]`)) {
    if (script.dataset[kind] === name) return script.textContent;
  }
  return null;
}
