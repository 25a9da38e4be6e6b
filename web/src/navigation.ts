import type { Selection } from "./selection";
import type { Share } from "./share";
import type { Carrier, Mount, Viewpoint } from "./view/camera_rig";
import type { View } from "./view/view";

/** Turn of the view by a drag over the whole height of the canvas, and by a key [rad]. */
const [DRAG_TURN, KEY_TURN] = [Math.PI, Math.PI / 24];
/** Steps of keys: a share of the view's height, a factor of the distance. */
const [KEY_PAN, KEY_ZOOM] = [0.05, 1.15];

/** Moves the camera, and tells the page's address of it. */
export class Navigation {
  constructor(
    private readonly view: View,
    private readonly share: Share,
    private readonly selection: Selection,
  ) {}

  /** Drags are in heights of the canvas. */
  orbit(right: number, down: number): void {
    this.moved(() => this.view.rig.orbit(-DRAG_TURN * right, DRAG_TURN * down));
  }

  pan(right: number, down: number): void {
    this.moved(() => this.view.rig.pan(-right, down));
  }

  zoom(factor: number): void {
    this.moved(() => this.view.rig.zoom(factor));
  }

  /** Turns, or moves where shift is held, as an arrow key says. */
  arrow(key: string): void {
    const right = key.endsWith("Right") ? 1 : key.endsWith("Left") ? -1 : 0;
    const up = key.endsWith("Up") ? 1 : key.endsWith("Down") ? -1 : 0;
    const { rig } = this.view;
    if (key.startsWith("Shift+")) this.moved(() => rig.pan(KEY_PAN * right, KEY_PAN * up));
    else this.moved(() => rig.orbit(KEY_TURN * right, KEY_TURN * up));
  }

  step(closer: boolean): void {
    this.zoom(closer ? 1 / KEY_ZOOM : KEY_ZOOM);
  }

  /** Sees the whole scene, or the picked body; a body's eyes look straight ahead. */
  frame(): void {
    const { rig } = this.view;
    if (rig.mount === "ride") this.moved(() => rig.lookAhead());
    else this.moved(() => this.view.frameScene());
  }

  /** Mounts the camera on the picked body; takes it off where it is mounted so. */
  mount(mount: Mount): void {
    const picked = this.selection.drawn;
    if (mount !== "free" && !picked) return;
    const wanted = mount === this.mounted ? "free" : mount;
    this.moved(() => this.view.mount(wanted, picked ?? undefined));
  }

  /** How the picked body carries the camera. */
  get mounted(): Mount {
    const { carried } = this.view;
    const { now } = this.selection;
    return carried && carried.body === now?.body && carried.world === now.world ? carried.mount : "free";
  }

  /** Goes to a viewpoint, carried by a body or by none. */
  go(viewpoint: Viewpoint, carrier: Carrier | null = null): void {
    this.moved(() => {
      this.view.carried = carrier;
      this.view.rig.go(viewpoint);
    });
  }

  private moved(move: () => void): void {
    move();
    this.view.invalidate();
    this.share.moved();
  }
}
