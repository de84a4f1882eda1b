#!/usr/bin/env node
// Screenshots of the page on the development server: node dev/shots.mjs http://127.0.0.1:8017 FOLDER. Needs chromedriver and chromium.
import { spawn } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";

const [root, folder] = [process.argv[2] ?? "http://127.0.0.1:8017", process.argv[3] ?? "shots"];
const only = process.argv[4];
mkdirSync(folder, { recursive: true });
const audit = readFileSync(new URL("../../../../tests/foreign/browser/audit.js", import.meta.url), "utf8");
const DRIVER = 9517;
const driver = spawn("chromedriver", [`--port=${DRIVER}`], { stdio: "ignore" });
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const ask = async (method, path, body) => {
  const answer = await fetch(`http://127.0.0.1:${DRIVER}${path}`, { method, body: body === undefined ? null : JSON.stringify(body) });
  const { value } = await answer.json();
  if (!answer.ok) throw new Error(JSON.stringify(value));
  return value;
};
const SIZES = { desktop: [1280, 800, 1], phone: [390, 844, 2], small: [360, 640, 2] };
const MODES = { idle: 4000, live: 6000, fault: 3000, absent: 2500, gone: 6000, token: 2500 };
try {
  for (let tries = 0; tries < 50; tries += 1) {
    if (await ask("GET", "/status").then(() => true, () => false)) break;
    await wait(100);
  }
  for (const [size, [width, height, deviceScaleFactor]] of Object.entries(SIZES)) {
    for (const theme of ["dark", "light"]) {
      for (const [mode, ms] of Object.entries(MODES)) {
        const name = `${size}-${theme}-${mode}`;
        if (only !== undefined && !new RegExp(only).test(name)) continue;
        await fetch(`${root}/dev/${mode === "gone" ? "idle" : mode === "live" ? "idle" : mode}`);
        const { sessionId } = await ask("POST", "/session", { capabilities: { alwaysMatch: {
          browserName: "chrome", "goog:loggingPrefs": { browser: "ALL" },
          "goog:chromeOptions": { args: ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", `--window-size=${width},${height}`] },
        } } });
        const at = `/session/${sessionId}`;
        const cdp = (cmd, params) => ask("POST", `${at}/goog/cdp/execute`, { cmd, params });
        await cdp("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor, mobile: size !== "desktop" });
        await cdp("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: theme }] });
        await ask("POST", `${at}/url`, { url: root });
        if (mode === "gone" || mode === "live") {
          await wait(1500);
          await fetch(`${root}/dev/${mode}`);
        }
        await wait(ms);
        if (mode === "idle" && size !== "desktop") {
          const { contentSize } = await cdp("Page.getLayoutMetrics", {});
          const whole = await cdp("Page.captureScreenshot", { captureBeyondViewport: true, clip: { x: 0, y: 0, width, height: contentSize.height, scale: 1 } });
          writeFileSync(`${folder}/${name}-whole.png`, Buffer.from(whole.data, "base64"));
        }
        writeFileSync(`${folder}/${name}.png`, Buffer.from(await ask("GET", `${at}/screenshot`), "base64"));
        const log = (await ask("POST", `${at}/se/log`, { type: "browser" })).filter((line) => mode !== "gone" && mode !== "token" && !/openapi/.test(line.message));
        if (log.length > 0) console.log(name, log.map((line) => line.message));
        const complaints = await ask("POST", `${at}/execute/sync`, { script: audit, args: [] });
        if (complaints.length > 0) console.log(name, complaints);
        await ask("DELETE", at);
      }
    }
  }
} finally {
  driver.kill();
}
