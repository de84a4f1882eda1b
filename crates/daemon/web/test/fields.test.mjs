import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { above, expected } = await load("fields.ts");

const field = (more) => ({ validity: { valid: false }, type: "number", min: "", max: "", step: "any", title: "", ...more });

test("errors of fields say what is expected, with limits and unit", () => {
  for (const [more, unit, words] of [
    [{ validity: { valid: true } }, "", null],
    [{ min: "-45", max: "0" }, "°", "a number from −45 to 0°"],
    [{ min: "0.05", max: "98" }, "°/s", "a number from 0.05 to 98°/s"],
    [{ min: "1", max: "10000", step: "1" }, "", "a whole number from 1 to 10000"],
    [{ min: "0.01" }, "m", "a number of at least 0.01 m"],
    [{}, "°", "a number"],
    [{ type: "text", validity: { valid: false, patternMismatch: true }, title: "letters" }, "", "letters"],
    [{ type: "password" }, "", "a text"],
  ]) assert.equal(expected(field(more), unit), words);
});

test("an upper limit is above the lower one", () => {
  for (const [low, high] of [["", ""], ["1", ""], ["", "1"], ["-2", "-1.5"], ["9", "10"]]) assert.equal(above(low, high), null);
  assert.equal(above("-1.5", "-2"), "a number above −1.5");
  assert.equal(above("3", "3"), "a number above 3");
});
