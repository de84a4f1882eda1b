// Saves the view as a picture, with what is needed to read it.

import { h, id } from "./dom.ts";

const LINE_PX = 20;

/** What is drawn besides the points. */
export interface Notes {
  lines: string[];
  legend: { low: string; high: string };
  scale: { px: number; words: string };
  /** Places of the picked points. */
  picks: ([number, number] | null)[];
}

/** A text in lines that fit, broken between words. */
export function wrapped(text: string, fits: (line: string) => boolean): string[] {
  const lines: string[] = [];
  for (const word of text.split(" ")) {
    const longer = lines.length === 0 ? word : `${lines.at(-1)} ${word}`;
    if (lines.length > 0 && fits(longer)) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

/** Draws scale and picked points over the points, title and legend below them, and saves that as PNG. */
export async function save(points: HTMLCanvasElement, name: string, { lines: texts, legend, scale: bar, picks }: Notes): Promise<void> {
  const scale = points.width / Math.max(1, points.clientWidth);
  const font = `14px ${getComputedStyle(document.body).fontFamily}`;
  const measured = h("canvas").getContext("2d");
  if (measured !== null) measured.font = font;
  const lines = texts.flatMap((line) => wrapped(line, (part) => (measured?.measureText(part).width ?? 0) <= points.clientWidth - 20));
  const canvas = h("canvas", { width: points.width, height: points.height + Math.round(scale * (LINE_PX * lines.length + 44)) });
  const context = canvas.getContext("2d");
  if (context === null) throw new Error("this browser cannot draw the picture");
  const style = getComputedStyle(document.body);
  context.fillStyle = style.backgroundColor;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(points, 0, 0);
  context.scale(scale, scale);
  context.fillStyle = style.color;
  context.font = font;
  const [width, height] = [points.width / scale, points.height / scale];
  context.fillRect(width - 16 - bar.px, height - 16, bar.px, 2);
  context.textAlign = "right";
  context.fillText(bar.words, width - 16, height - 22);
  context.textAlign = "left";
  context.strokeStyle = context.fillStyle = style.getPropertyValue("--pick");
  context.lineWidth = 2;
  context.beginPath();
  picks.forEach((place, i) => {
    if (place === null) return;
    const [x, y] = place;
    if (i > 0) context.lineTo(x, y);
    context.moveTo(x + 7, y);
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.moveTo(x, y);
    context.fillText("AB"[i] ?? "", x + 11, y - 8);
  });
  context.stroke();
  context.fillStyle = style.color;
  let y = height + 18;
  for (const line of lines) {
    context.fillText(line, 10, y);
    y += LINE_PX;
  }
  context.drawImage(id<HTMLCanvasElement>("legend-bar"), 10, y - 10, 240, 12);
  context.fillText(legend.low, 10, y + 18);
  context.textAlign = "right";
  context.fillText(legend.high, 250, y + 18);
  const png = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (png === null) throw new Error("this browser cannot make the picture");
  const href = URL.createObjectURL(png);
  h("a", { href, download: `${name.replace(/[^\w.-]+/g, "_")}.png` }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}
