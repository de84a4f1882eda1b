// What axe leaves out: targets below 44 px, controls under others, contrast over several layers, scrolling sideways. Runs in the page; gives a list of sentences.
const complaints = [];
const seen = (element) => {
  const box = element.getBoundingClientRect();
  return element.checkVisibility({ visibilityProperty: true }) && box.width > 1 && box.height > 1;
};
const called = (element) => `${element.tagName.toLowerCase()}#${element.id || element.className} "${(element.textContent || "").trim().slice(0, 30)}"`;
for (const element of document.querySelectorAll("svg")) {
  if (element.getAttribute("aria-hidden") !== "true" && element.closest("[aria-hidden=true]") === null) complaints.push("a drawing that is read out");
}
if (document.documentElement.scrollWidth > innerWidth) complaints.push(`scrolls sideways: ${document.documentElement.scrollWidth} of ${innerWidth} px`);

if (innerWidth < 900) {
  for (const element of document.querySelectorAll("button, select, summary, input, label.check")) {
    if (!seen(element)) continue;
    const target = element.matches("input[type=checkbox]") ? element.closest("label") : element;
    const { width, height } = target.getBoundingClientRect();
    if (width < 44 || height < 44) complaints.push(`a target of ${width.toFixed(0)} by ${height.toFixed(0)} px: ${called(element)}`);
  }
}

// Every control can be scrolled to where nothing else covers it, but for open dialogs, an alarm, and open tools on a narrow screen. STOP is under the sign-in alone, without which it has no effect.
const scrollers = [...document.querySelectorAll("*")].filter((element) => element.scrollHeight > element.clientHeight || element.scrollWidth > element.clientWidth);
const before = scrollers.map(({ scrollLeft, scrollTop }) => [scrollLeft, scrollTop]);
for (const element of document.querySelectorAll("button, select, summary, input, textarea")) {
  if (!seen(element) || element.closest(".unseen, .skip")) continue;
  element.scrollIntoView({ block: "center", inline: "center" });
  const { x, y, width, height } = element.getBoundingClientRect();
  const hit = document.elementFromPoint(x + width / 2, y + height / 2);
  if (hit !== null && (element.contains(hit) || (element.closest("label")?.contains(hit) ?? false))) continue;
  if (hit?.closest("dialog:modal") || (element.id !== "stop" && hit?.closest("dialog, .undo, .not-stopped")) || (innerWidth < 900 && hit?.closest(".tools[open]"))) continue;
  complaints.push(`${called(element)} is under ${hit === null ? "nothing: out of the window" : called(hit)}`);
}
scrollers.forEach((element, i) => element.scrollTo({ left: before[i][0], top: before[i][1], behavior: "instant" }));

// Neither do the parts of the view cover each other.
const parts = [".caption", ".legend", ".tools", ".picked", ".bar"].flatMap((css) => [...document.querySelectorAll(css)]).filter(seen);
parts.forEach((one, i) => parts.slice(i + 1).forEach((other) => {
  if (innerWidth < 900 && [one, other].some((part) => part.matches(".tools[open]"))) return;
  const [a, b] = [one.getBoundingClientRect(), other.getBoundingClientRect()];
  const [wide, high] = [Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top)];
  if (wide > 1 && high > 1) complaints.push(`${one.className} and ${other.className} overlap by ${wide.toFixed(0)} by ${high.toFixed(0)} px`);
}));

const rgb = (text) => {
  const srgb = /^color\(srgb ([\d.]+) ([\d.]+) ([\d.]+)(?: \/ ([\d.]+))?\)$/.exec(text);
  if (srgb) return [...srgb.slice(1, 4).map((part) => 255 * part), Number(srgb[4] ?? 1)];
  const parts = text.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0];
  return [parts[0], parts[1], parts[2], parts[3] ?? 1];
};
const over = (top, below) => [0, 1, 2].map((c) => top[c] * top[3] + below[c] * (1 - top[3])).concat(1);
const ground = (element) => {
  const layers = [];
  for (let at = element; at !== null; at = at.parentElement) {
    const colour = rgb(getComputedStyle(at).backgroundColor);
    if (colour[3] > 0) layers.push(colour);
    if (colour[3] === 1) break;
  }
  return layers.reduceRight((below, top) => over(top, below), [255, 255, 255, 1]);
};
const luminance = (colour) => {
  const [r, g, b] = colour.slice(0, 3).map((part) => (part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (texts.nextNode()) {
  const element = texts.currentNode.parentElement;
  if (texts.currentNode.data.trim() === "" || !seen(element) || element.closest("[disabled], option, .unseen, .skip, script, noscript, [data-state=recording]")) continue;
  const below = ground(element);
  const ink = over(rgb(getComputedStyle(element).color), below);
  const [a, b] = [luminance(ink), luminance(below)].sort((x, y) => y - x);
  const ratio = (a + 0.05) / (b + 0.05);
  if (ratio < 4.5) complaints.push(`contrast ${ratio.toFixed(2)}: ${called(element)}`);
}
return complaints;
