// What is drawn over the points: axes, scale bar, picked points. A picture for the eye; texts say the same beside it.

import { attribute } from "../dom.ts";
import type { Picked } from "../picked.ts";
import { scaleBar } from "./measure.ts";
import type { Stage } from "./stage.ts";

const SVG = "http://www.w3.org/2000/svg";
const AXIS_PX = 26;
const BAR_PX = 96;
const MARGIN_PX = 16;

function part<K extends keyof SVGElementTagNameMap>(tag: K, to: Element, name = ""): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  if (name !== "") element.setAttribute("class", name);
  to.append(element);
  return element;
}

export class Overlay {
  private readonly axes: { line: SVGLineElement; name: SVGTextElement }[];
  private readonly bar: { path: SVGPathElement; words: SVGTextElement };
  private readonly measured: SVGLineElement;
  private readonly marks: { circle: SVGCircleElement; name: SVGTextElement }[];

  constructor(private readonly svg: SVGSVGElement) {
    this.axes = ["x", "y", "z"].map((axis) => {
      const made = { line: part("line", svg, `axis axis-${axis}`), name: part("text", svg, `axis-name axis-${axis}`) };
      made.name.textContent = axis;
      return made;
    });
    this.bar = { path: part("path", svg, "scale"), words: part("text", svg, "scale-words") };
    this.measured = part("line", svg, "measured");
    this.marks = ["A", "B"].map((letter) => {
      const made = { circle: part("circle", svg, "pick"), name: part("text", svg, "pick-name") };
      made.name.textContent = letter;
      made.circle.setAttribute("r", "7");
      return made;
    });
  }

  draw(stage: Stage, picks: Picked[]): void {
    const { clientWidth: width, clientHeight: height } = this.svg;
    const place = (element: Element, values: Record<string, number>) => {
      for (const [name, value] of Object.entries(values)) attribute(element, name, value.toFixed(1));
    };
    const [x, y] = [width - MARGIN_PX - AXIS_PX - 8, height - MARGIN_PX - AXIS_PX - 34];
    stage.axes().forEach(([right, down], i) => {
      const axis = this.axes[i];
      if (axis === undefined) return;
      place(axis.line, { x1: x, y1: y, x2: x + AXIS_PX * right, y2: y + AXIS_PX * down });
      place(axis.name, { x: x + (AXIS_PX + 9) * right, y: y + (AXIS_PX + 9) * down + 4 });
    });
    const scale = scaleBar(stage.metres_per_px, BAR_PX, stage.orbit.parallel);
    const [end, foot] = [width - MARGIN_PX, height - MARGIN_PX];
    attribute(this.bar.path, "d", `M${(end - scale.px).toFixed(1)} ${foot - 6}v6H${end}v-6`);
    place(this.bar.words, { x: end - scale.px / 2, y: foot - 7 });
    this.bar.words.textContent = scale.words;
    const places = [0, 1].map((i) => {
      const pick = picks[i];
      return pick === undefined ? null : stage.project(pick.position);
    });
    this.marks.forEach(({ circle, name }, i) => {
      const at = places[i];
      for (const element of [circle, name]) element.style.display = at == null ? "none" : "";
      if (at == null) return;
      place(circle, { cx: at[0], cy: at[1] });
      place(name, { x: at[0] + 11, y: at[1] - 8 });
    });
    const [a, b] = places;
    this.measured.style.display = a == null || b == null ? "none" : "";
    if (a != null && b != null) place(this.measured, { x1: a[0], y1: a[1], x2: b[0], y2: b[1] });
  }
}
