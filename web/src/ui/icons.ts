/** Icons of the toolbar, on a grid of 16. */
const PATHS = {
  run: "M4.5 2.8v10.4l8.5-5.2z",
  stop: "M4 3h3v10H4zM9 3h3v10H9z",
  restart: "M8 3a5 5 0 1 1-4.7 3.3M3 2.5v4h4",
  rebuild: "M2.5 5.2 8 2.3l5.5 2.9v5.6L8 13.7l-5.5-2.9zM2.5 5.2 8 8.1l5.5-2.9M8 8.1v5.6",
  grab: "M5.5 8.5V4a1 1 0 0 1 2 0v3.5V3a1 1 0 0 1 2 0v4.5V4a1 1 0 0 1 2 0v6c0 2.5-1.5 4-4 4-2 0-3-.8-3.8-2.3L2.4 9.4c-.5-1 .8-1.8 1.5-1z",
  push: "M2 8h8M7 4.5 10.5 8 7 11.5M13 3v10",
  camera: "M2 5h3l1-1.7h4L11 5h3v8H2zM8 6.6a2.3 2.3 0 1 0 0 4.6 2.3 2.3 0 0 0 0-4.6z",
  record: "M8 4a4 4 0 1 0 0 8 4 4 0 0 0 0-8z",
  help: "M5.8 6.2a2.2 2.2 0 1 1 3.3 1.9c-.8.5-1.1.9-1.1 1.7M8 12.2v.3",
  theme: "M8 2a6 6 0 1 0 0 12zM8 2a6 6 0 0 1 0 12",
  frame: "M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10",
  link: "M6.5 9.5l3-3M7 4.8l1.2-1.2a2.9 2.9 0 0 1 4.1 4.1L11.2 9M9 11.2l-1.2 1.2a2.9 2.9 0 0 1-4.1-4.1L4.8 7",
  left: "M2 3h12v10H2zM6.5 3v10",
  right: "M2 3h12v10H2zM9.5 3v10",
  plots: "M2.5 2.5v11h11M5 10l2.5-3.5L10 8.5l3-4.5",
} as const;
const FILLED: readonly string[] = ["run", "stop", "record"];

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  svg.classList.add("icon");
  if (FILLED.includes(name)) svg.classList.add("filled");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}
