// Errors of input fields, in the page's words, beside them.

import { attribute, h, show, text } from "./dom.ts";

/** What is expected of a field with this value; null if the value is valid. */
export function expected(field: Pick<HTMLInputElement, "validity" | "type" | "min" | "max" | "step" | "title">, unit: string): string | null {
  const { validity, type, min, max, step, title } = field;
  if (validity.valid) return null;
  if (validity.patternMismatch) return title;
  if (type !== "number") return "a text";
  const kind = step === "any" ? "a number" : "a whole number";
  const [from, to] = [min, max].map((limit) => limit.replace("-", "\u2212"));
  const range = min !== "" && max !== "" ? ` from ${from} to ${to}` : min !== "" ? ` of at least ${from}` : max !== "" ? ` of at most ${to}` : "";
  return `${kind}${range}${range !== "" && unit !== "" ? `${unit.startsWith("\u00b0") ? "" : " "}${unit}` : ""}`;
}

/** What is expected of the upper of two limits; null if it is above the lower one. */
export function above(low: string, high: string): string | null {
  return low === "" || high === "" || Number(high) > Number(low) ? null : `a number above ${low.replace("-", "\u2212")}`;
}

/** What is expected of a field; null if its value is valid. `data-above` names the field of the lower limit. */
function wanted(field: HTMLInputElement, unit: string): string | null {
  const low = document.getElementById(field.dataset["above"] ?? "");
  return expected(field, unit) ?? (low instanceof HTMLInputElement ? above(low.value, field.value) : null);
}

/** Name of a field for the user. */
function title(field: HTMLInputElement): string {
  return field.getAttribute("aria-label") ?? field.labels?.[0]?.firstChild?.textContent?.trim() ?? field.name;
}

/** Shows or removes the error of a field; true if its value is valid. */
function check(field: HTMLInputElement): boolean {
  const known = `${field.id}-wrong`;
  let wrong = document.getElementById(known);
  const unit = field.parentElement?.classList.contains("unit") === true ? (field.nextElementSibling?.textContent ?? "") : "";
  const words = wanted(field, unit);
  if (wrong === null) {
    if (words === null) return true;
    wrong = h("p", { class: "wrong", id: known });
    (field.closest(".side") ?? field.closest(".pair, .speed, .box, label") ?? field).after(wrong);
    // Hints that describe the field stay.
    attribute(field, "aria-describedby", [field.getAttribute("aria-describedby"), known].filter(Boolean).join(" "));
  }
  attribute(field, "aria-invalid", String(words !== null));
  text(wrong, words === null ? "" : `${title(field)}: expected ${words}`);
  show(wrong, words !== null);
  return words === null;
}

const fields = (form: HTMLElement) => [...form.querySelectorAll<HTMLInputElement>("input[id]:not([type=range])")];

/** Checks each field when its value is complete, and one with an error at each change. */
export function watch(form: HTMLElement): void {
  if (form instanceof HTMLFormElement) form.noValidate = true;
  const look = (event: Event) => {
    const field = event.target;
    if (!(field instanceof HTMLInputElement) || field.id === "") return;
    const upper = form.querySelector<HTMLInputElement>(`[data-above="${field.id}"]`);
    for (const one of [field, upper]) if (one !== null && (event.type === "change" || one.getAttribute("aria-invalid") === "true")) check(one);
  };
  form.addEventListener("input", look);
  form.addEventListener("change", look);
}

/** Whether all fields are valid. */
export const valid = (form: HTMLElement) => fields(form).every((field) => wanted(field, "") === null);

/** The same; shows the errors of the others, and with `focus` the first of those. */
export function report(form: HTMLElement, focus = false): boolean {
  const wrong = fields(form).filter((field) => !check(field));
  const [first] = wrong;
  if (first === undefined) return true;
  if (focus) {
    // A folded section hides its fields.
    for (let folded = first.closest("details"); folded !== null; folded = folded.parentElement?.closest("details") ?? null) folded.open = true;
    first.focus();
  }
  return false;
}
