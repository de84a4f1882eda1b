import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { expected } = await load("fields.ts");

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
