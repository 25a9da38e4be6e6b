import type { TrailChoice } from "./overlays/trails";

/** What is drawn, as chosen on the page. */
export interface ViewOptions {
  grid: boolean;
  shadows: boolean;
  translucent: boolean;
  wireframe: boolean;
  contacts: boolean;
  forces: boolean;
  joints: boolean;
  frames: boolean;
  masses: boolean;
  particles: boolean;
  trails: TrailChoice;
  /** Row of the scene's camera that is shown in a corner; −1 none. */
  inset: number;
}

export const VIEW_OPTIONS: Readonly<ViewOptions> = {
  grid: true,
  shadows: true,
  translucent: false,
  wireframe: false,
  contacts: false,
  forces: false,
  joints: false,
  frames: false,
  masses: false,
  particles: true,
  trails: "none",
  inset: -1,
};
