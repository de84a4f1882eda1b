import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { found } = await load("found.ts");
const scan = (id, more) => ({ id, state: "whole", started_s: 0, simulated: false, ...more });
const scans = [
  scan("2026-a", { name: "Hall 10", started_s: 3, duration_s: 5, points: 100, notes: "Door open\nn\u00f6rdlich" }),
  scan("2026-b", { name: "hall 9", started_s: 1, duration_s: 50, points: 20 }),
  scan("2026-c", { started_s: 2, points: null, state: "failed" }),
];
const ids = (words, by = "time", down = true) => found(scans, words, { by, down }).map(({ id }) => id.slice(-1)).join("");

test("scans are found by words of name, id and notes, whatever their case and accents", () => {
  assert.equal(ids(""), "acb");
  assert.equal(ids("HALL"), "ab");
  assert.equal(ids("  hall open "), "a");
  assert.equal(ids("nordlich"), "a");
  assert.equal(ids("N\u00d6RDLICH"), "a");
  assert.equal(ids("2026-c"), "c");
  assert.equal(ids("hall closed"), "");
});

test("scans are sorted by each value, numbers in names by their size, and those without it are last", () => {
  assert.equal(ids("", "time", false), "bca");
  assert.equal(ids("", "name", false), "cba");
  assert.equal(ids("", "name", true), "abc");
  assert.equal(ids("", "duration", true), "bac");
  assert.equal(ids("", "duration", false), "abc");
  assert.equal(ids("", "points", true), "abc");
  assert.equal(ids("", "points", false), "bac");
});
