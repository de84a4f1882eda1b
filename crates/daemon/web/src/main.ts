// Starts the page: that of a daemon, or of files that `velomotion view` serves.

import * as daemon from "./daemon.ts";
import { id, show, text } from "./dom.ts";
import * as files from "./files.ts";
import { Viewer } from "./viewer.ts";

const of_files = document.body.dataset["page"] === "files";
let viewer: Viewer | null = null;
try {
  viewer = new Viewer((shown) => (of_files ? files.setCurrent(shown) : daemon.setCurrent(shown)));
} catch (error) {
  text(id("view-failed"), `No 3D view: this browser has no WebGL2.${of_files ? "" : " Everything else works."}`);
  show(id("view-failed"), true);
  show(id("view-empty"), false);
  console.error(error);
}
if (of_files) files.start(viewer);
else daemon.start(viewer);
