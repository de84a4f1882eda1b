import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { repeatStop, TRY_MS } = await load("stop.ts");

/** Lets promises settle, then moves the clock. */
async function pass(context, ms) {
  for (let step = 0; step < ms; step += 50) {
    for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
    context.mock.timers.tick(50);
  }
  for (let turn = 0; turn < 10; turn += 1) await Promise.resolve();
}

/** A daemon that never answers: a request ends when it is aborted. */
const silent = (signal) => new Promise((_, fail) => signal.addEventListener("abort", () => fail(new Error("no answer"))));

test("an answered stop is sent once and raises no alarm", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  let sent = 0;
  const alarms = [];
  const stopped = await repeatStop(async () => { sent += 1; }, (why) => alarms.push(why), new AbortController().signal);
  await pass(context, 3 * TRY_MS);
  assert.deepEqual([stopped, sent, alarms.length], [true, 1, 0]);
});

test("a silent daemon is asked at least every 2.2 s, without end, and raises the alarm after 2 s", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  let sent = 0;
  let alarms = 0;
  const ended = new AbortController();
  const stop = repeatStop((signal) => { sent += 1; return silent(signal); }, () => { alarms += 1; }, ended.signal);
  await pass(context, TRY_MS - 50);
  assert.deepEqual([sent, alarms], [1, 0]);
  await pass(context, 100);
  assert.ok(alarms > 0);
  await pass(context, 60_000);
  assert.ok(sent >= 27, `${sent} requests in a minute`);
  ended.abort();
  await pass(context, 300);
  assert.equal(await stop, false);
});

test("errors are no acknowledgement", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  let sent = 0;
  const alarms = [];
  const stop = repeatStop(async () => {
    sent += 1;
    if (sent < 12) throw new Error(`refused ${sent}`);
  }, (why) => alarms.push(why.message), new AbortController().signal);
  await pass(context, 3_000);
  assert.equal(await stop, true);
  assert.equal(sent, 12);
  assert.equal(alarms.at(-1), "refused 11");
});
