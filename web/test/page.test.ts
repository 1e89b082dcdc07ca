/** Run by `npm test`: what the page computes, without a browser. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { centres, sample, type Skeleton } from "../src/clips";
import { Clock } from "../src/clock";
import { cividis, projection } from "../src/geometry";
import { order } from "../src/tables";
import { fromPlanes, unpackJson, unpackNumbers } from "../src/unpack";
import { gzipSync } from "node:zlib";

/** `pack.packed` written out. */
function pack(rows: number[][]): Uint8Array {
  const codes: number[] = [];
  for (let c = 0; c < rows[0].length; c++) {
    let before = 0;
    for (const row of rows) {
      const change = ((row[c] - before) << 16) >> 16;
      before = row[c];
      codes.push(change >= 0 ? 2 * change : -2 * change - 1);
    }
  }
  return Uint8Array.from([...codes.map((c) => c & 255), ...codes.map((c) => c >> 8)]);
}

test("numbers come back as they were packed", async () => {
  const rows = [[0, 32767, -5], [-1, -32767, 300], [70, 12, -32768]];
  const found = fromPlanes(pack(rows), 3, 0.5);
  assert.deepEqual([...found], rows.flat().map((x) => x * 0.5));
  const text = gzipSync(pack(rows)).toString("base64");
  assert.deepEqual([...(await unpackNumbers(`\n${text}\n`, 3, 1))], rows.flat());
});

test("structures come back, with any letters", async () => {
  const value = { "<b>": ["身振り", null, 1.5] };
  assert.deepEqual(await unpackJson(gzipSync(JSON.stringify(value)).toString("base64")), value);
});

test("between frames the curve passes through the frames and a straight line stays straight", () => {
  const out = new Float32Array(2);
  const data = new Float32Array([0, 5, 1, 5, 2, 5, 3, 5]);
  for (const at of [1, 1.25, 1.5, 2]) {
    sample(data, 2, 4, at, out);
    assert.ok(Math.abs(out[0] - at) < 1e-6);
    assert.ok(Math.abs(out[1] - 5) < 1e-6);
  }
  sample(data, 2, 4, 99, out);
  assert.equal(out[0], 3);
  sample(data.slice(0, 2), 2, 1, 0.5, out);
  assert.deepEqual([...out], [0, 5]);
});

test("the camera keeps what it looks at in the middle, and the nearer of two things is larger", () => {
  const place: [number, number, number] = [0, 0, 0];
  for (const [yaw, pitch] of [[0, 0], [1, 0.3], [-2, 1.2]]) {
    const project = projection(yaw, pitch, [1, 2, 3], 100, 6, 200, 100);
    project(1, 2, 3, place);
    assert.ok(Math.hypot(place[0] - 100, place[1] - 50) < 1e-9);
  }
  const ahead = projection(0, 0, [0, 0, 0], 100, 6, 200, 100);
  ahead(1, 0, 2, place);
  const near = place[0] - 100;
  ahead(1, 0, -2, place);
  assert.ok(near > place[0] - 100);
  assert.ok(place[2] < 0);
});

test("who walks is followed, who stands is not", () => {
  const bones: Skeleton = { kind: "body", points: 1, bones: [], radii: [], limbs: [] };
  const still = centres(new Float32Array([0, 0, 0, 0.2, 2, 0]), 2, bones, 2);
  assert.deepEqual([...still].map((x) => Math.round(x * 100)), [10, 100, 0, 10, 100, 0]);
  const walk = centres(Float32Array.from({ length: 30 }, (_, k) => (k % 3 ? 0 : k / 3)), 10, bones, 2);
  assert.ok(walk[0] < 1 && walk[27] > 8);
});

test("time repeats its span, at any rate", () => {
  const clock = new Clock();
  let told = 0;
  clock.onChange(() => told++);
  clock.span(1, 3);
  assert.equal(clock.time, 1);
  clock.advance(5);
  assert.equal(clock.time, 1, "it stands until it plays");
  clock.play(true);
  clock.rate = 2;
  clock.advance(0.75);
  assert.equal(clock.time, 2.5);
  clock.advance(0.5);
  assert.equal(clock.time, 1.5);
  clock.seek(99);
  assert.equal(clock.time, 3);
  assert.ok(told >= 5);
});

test("tables: numbers by size, words by the alphabet, empty cells last", () => {
  const cells = ["10", "9", "", "−3", "1.5"];
  assert.deepEqual(order(cells, true).map((k) => cells[k]), ["−3", "1.5", "9", "10", ""]);
  assert.deepEqual(order(cells, false).map((k) => cells[k]), ["10", "9", "1.5", "−3", ""]);
  assert.deepEqual(order(["b", "a", "a"], true), [1, 2, 0], "equal ones keep their order");
  assert.deepEqual(order(["2", "x", "1"], true), [2, 0, 1]);
});

test("the scale of colours ends where cividis ends and grows lighter", () => {
  assert.equal(cividis(0), "rgb(0, 32, 76)");
  assert.equal(cividis(2), "rgb(255, 233, 69)");
  const light = [0, 0.25, 0.5, 0.75, 1].map((v) => (cividis(v).match(/\d+/g) ?? []).reduce((a, x) => a + Number(x), 0));
  assert.deepEqual([...light].sort((a, b) => a - b), light);
});
