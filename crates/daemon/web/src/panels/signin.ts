// Sign-in with the daemon's token. It is sent once; the browser stores the cookie, the page stores nothing.

import { forget } from "./messages.ts";
import { RequestError, sendRequest } from "../api.ts";
import { id, show, text } from "../dom.ts";
import * as fields from "../fields.ts";
import { refused } from "./control.ts";

const dialog = id<HTMLDialogElement>("signin");
const form = id("signin-form");
const field = id<HTMLInputElement>("token");
const wrong = id("signin-wrong");

export function wire(signed: () => void): void {
  // Nothing can be shown without the token, so the dialog stays open.
  dialog.addEventListener("cancel", (event) => event.preventDefault());
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (fields.report(form, true)) void send(signed);
  });
  fields.watch(form);
  id("sign-out").addEventListener("click", () => void sign_out());
}

/** Offers to sign out where a token is needed. */
export async function offer(): Promise<void> {
  try {
    const { signed_in } = await sendRequest<{ signed_in: boolean }>("GET", "/login");
    show(id("sign-out"), signed_in);
  } catch {
    // The next connection asks again.
  }
}

export function open(): void {
  if (!dialog.open) dialog.showModal();
}

async function sign_out(): Promise<void> {
  forget();
  const at = id("sign-out-error");
  show(at, false);
  try {
    await sendRequest("POST", "/logout");
    location.reload();
  } catch (error) {
    refused("Sign out", error, at);
  }
}

async function send(signed: () => void): Promise<void> {
  try {
    await sendRequest("POST", "/login", { token: field.value });
    field.value = "";
    text(wrong, "");
    dialog.close();
    signed();
  } catch (error) {
    text(wrong, error instanceof RequestError ? [error.message, error.help].filter(Boolean).join(": ") : String(error));
    field.select();
  }
}
