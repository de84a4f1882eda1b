// Colour maps for any colour vision: their lightness rises evenly. 64 samples of matplotlib's (CC0).

export type MapName = "viridis" | "cividis" | "grey";

const SAMPLES: Record<Exclude<MapName, "grey">, string> = {
  viridis:
    "44015446075a470d6047136548186a481d6f482374482878472d7b46327e453781443b844240864045883e49893d4e8a" +
    "3a538b38588c365c8d34608d32648e31688e2f6c8e2d708e2c738e2a778e297b8e277f8e26828e24868e238a8d218e8d" +
    "20928c1f968b1f9a8a1f9e891fa18721a58523a98326ad812ab07f2fb47c35b7793bbb7542be714ac16d52c5695ac864" +
    "65cb5e6ece5877d15381d34d8bd64695d840a0da39aadc32b5de2bc0df25cae11fd5e21adfe318eae51af4e61efde725",
  cividis:
    "00224e00255400285b002b62002e6a0030700533711235701a386f213b6e273e6e2d416d32436d36466c3b496c3f4c6c" +
    "444f6c48526c4c556c50576c545a6d575d6d5b606e5e636f62656f656870696b716c6e727071737374757777767a7a78" +
    "7e7d788280798683798a86788e8978928c78958f779992779d9576a19975a59c74a99f73ada272b1a570b6a96fbaac6d" +
    "bfb06bc3b369c7b767ccba64d0be62d4c15fd9c55cddc858e1cc55e6d051ead34cefd748f3db42f8df3cfde334fee838",
};

type Rgb = [number, number, number];

/** Colours of values below and above manual limits, sky blue and vermilion: no map has them, and any colour vision tells them apart (Okabe and Ito 2008). */
export const MARKS: [Rgb, Rgb] = [[0.34, 0.71, 0.91], [0.84, 0.37, 0]];

function samples(name: MapName): Rgb[] {
  if (name === "grey") return Array.from({ length: 64 }, (_, i) => [4 * i, 4 * i, 4 * i]);
  const hex = SAMPLES[name];
  const part = (at: number) => Number.parseInt(hex.slice(at, at + 2), 16);
  return Array.from({ length: hex.length / 6 }, (_, i) => [part(6 * i), part(6 * i + 2), part(6 * i + 4)]);
}

/** Steps of the colour table. */
export const STEPS = 256;

/** The table as RGBA bytes, without the end of the map that is invisible on the background. */
export function table(name: MapName, dark: boolean): Uint8Array {
  const colours = samples(name);
  const [low, high] = dark ? [name === "grey" ? 0.25 : 0.1, 1] : [0, name === "grey" ? 0.75 : 0.86];
  const out = new Uint8Array(4 * STEPS);
  for (let i = 0; i < STEPS; i += 1) {
    const at = (low + ((high - low) * i) / (STEPS - 1)) * (colours.length - 1);
    const below = colours[Math.floor(at)] ?? [0, 0, 0];
    const above = colours[Math.ceil(at)] ?? below;
    for (const c of [0, 1, 2] as const) out[4 * i + c] = Math.round(below[c] + (above[c] - below[c]) * (at % 1));
    out[4 * i + 3] = 255;
  }
  return out;
}

/** Draws the colours of a legend from left to right. */
export function bar(canvas: HTMLCanvasElement, colours: Uint8Array): void {
  const context = canvas.getContext("2d");
  for (let i = 0; context !== null && i < canvas.width; i += 1) {
    context.fillStyle = css(colours, i / (canvas.width - 1));
    context.fillRect(i, 0, 1, 1);
  }
}

/** A colour of the table. */
export function css(colours: Uint8Array, share: number): string {
  const at = 4 * Math.round(Math.min(1, Math.max(0, share)) * (STEPS - 1));
  return `rgb(${colours[at]},${colours[at + 1]},${colours[at + 2]})`;
}
