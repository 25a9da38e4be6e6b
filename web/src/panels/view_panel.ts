import type { Navigation } from "../navigation";
import type { Camera } from "../protocol";
import type { Session } from "../session";
import { keep, recall } from "../store";
import { button, Checkbox, h, Select } from "../ui/dom";
import type { Carrier, Viewpoint } from "../view/camera_rig";
import { VIEW_OPTIONS, type ViewOptions } from "../view/options";
import type { TrailChoice } from "../view/overlays/trails";
import type { View } from "../view/view";

type Flag = { [K in keyof ViewOptions]: ViewOptions[K] extends boolean ? K : never }[keyof ViewOptions];
const FLAGS: [Flag, string, string][] = [
  ["contacts", "Contact points", "Where shapes touch."],
  ["forces", "Contact forces", "Arrows; an ordinary body's weight is as long as the body is wide."],
  ["joints", "Joints", "Axes and limits, with a hand where the joint is; of the first replica shown."],
  ["frames", "Frames", "Axes of bodies: x red, y green, z blue."],
  ["masses", "Centres of mass", "Balls in quarters."],
  ["grid", "Grid", "Lines on the ground."],
  ["shadows", "Shadows", "Shadows of the sun."],
  ["translucent", "See-through", "Bodies are drawn so that one sees what is inside."],
  ["wireframe", "Wireframe", "Triangles only."],
  // Last, since it is there only where there are some.
  ["particles", "Particles", "Particles of fluids and soft bodies."],
];
const TRAILS: [TrailChoice, string][] = [
  ["none", "No trails"],
  ["picked", "Trail of the picked body"],
  ["all", "Trails of all bodies"],
];

/** From where a scene was seen when that was kept. */
interface Place {
  viewpoint: Viewpoint;
  carrier: Carrier | null;
}

/** What is drawn, and from where. */
export class ViewPanel {
  readonly element: HTMLElement;
  private readonly boxes: [Flag, Checkbox][];
  private readonly trails: Select<TrailChoice>;
  private readonly cameras: Select<number>;
  /** The frame of the inset, for the picture. */
  readonly inset = h("div", { class: "inset", hidden: true });
  /** Places kept, and the scene's cameras. */
  private readonly saved = h("span", { class: "contents" });
  private readonly keepIt: HTMLButtonElement;
  private readonly particles: HTMLElement | undefined;
  /** The scene that the inset is of. */
  private sceneName = "";

  constructor(
    private readonly session: Session,
    private readonly view: View,
    private readonly navigation: Navigation,
  ) {
    view.options = { ...VIEW_OPTIONS, ...recall<Partial<ViewOptions>>("view", {}), inset: -1 };
    this.boxes = FLAGS.map(([flag, label, help]) => [
      flag,
      new Checkbox(label, help, (on) => this.set({ [flag]: on })),
    ]);
    this.trails = new Select("Trails", "The ways that centres of mass have come. (T)", TRAILS, (trails) =>
      this.set({ trails }),
    );
    this.cameras = new Select<number>("Inset", "What a robot's camera sees, in a corner.", [], (inset) =>
      this.chooseInset(inset),
    );
    this.keepIt = button("Keep viewpoint", "Keeps the camera's place. (Shift with a digit)", () =>
      this.save(),
    );
    this.particles = this.boxes.find(([flag]) => flag === "particles")?.[1].element;
    this.element = h(
      "div",
      {},
      h("div", { class: "checks" }, ...this.boxes.map(([, box]) => box.element)),
      h("div", { class: "bar" }, this.trails.element, this.cameras.element),
      h("div", { class: "bar" }, this.keepIt, this.saved),
    );
    session.on("frame", ({ particles }) => this.showParticles(particles.length > 0));
    session.on("scene", ({ name, cameras }) => {
      this.showParticles(false);
      const options = cameras.map(({ name }, row): [number, string] => [row, `Camera ${name || row}`]);
      this.cameras.setOptions([[-1, "No inset"], ...options]);
      this.cameras.element.hidden = cameras.length === 0;
      // What a robot sees with its own eyes is shown at first, but to those who did not want to see it.
      const eyes = cameras.findIndex(({ body, mode }) => body >= 0 && mode === "fixed");
      if (name !== this.sceneName) this.set({ inset: recall("inset", true) ? eyes : -1 });
      else if (!cameras[view.options.inset]) this.set({ inset: -1 });
      this.sceneName = name;
      this.showSaved();
    });
    this.show();
  }

  set(options: Partial<ViewOptions>): void {
    this.view.options = { ...this.view.options, ...options };
    const camera = this.session.scene?.cameras[this.view.options.inset];
    this.inset.hidden = !camera;
    this.inset.textContent = camera?.name ?? "";
    keep("view", this.view.options);
    this.show();
  }

  private chooseInset(inset: number): void {
    keep("inset", inset >= 0);
    this.set({ inset });
  }

  private showParticles(some: boolean): void {
    if (this.particles) this.particles.hidden = !some;
  }

  /** Trails of none, the picked, all, in turn. */
  turnTrails(): void {
    const choices = TRAILS.map(([choice]) => choice);
    this.set({ trails: choices[(choices.indexOf(this.view.options.trails) + 1) % choices.length] });
  }

  /** Keeps the viewpoint for this example, under a number from 1 to 9 or the next free one. */
  save(place = this.places().findIndex((kept) => !kept)): void {
    if (place < 0 || place > 8) return;
    const places = this.places();
    places[place] = { viewpoint: this.view.rig.viewpoint, carrier: this.view.carried };
    keep(this.key(), places);
    this.showSaved();
  }

  recall(place: number): void {
    const kept = this.places()[place];
    if (kept) this.navigation.go(kept.viewpoint, kept.carrier);
  }

  private forget(): void {
    keep(this.key(), []);
    this.showSaved();
    // The button that was pressed is gone.
    this.keepIt.focus();
  }

  private places(): (Place | null)[] {
    const kept = recall<(Place | null)[]>(this.key(), []);
    return Array.from({ length: 9 }, (_, place) => kept[place] ?? null);
  }

  private key(): string {
    return `places.${this.session.scene?.name}`;
  }

  private show(): void {
    for (const [flag, box] of this.boxes) box.on = this.view.options[flag];
    this.trails.value = this.view.options.trails;
    this.cameras.value = this.view.options.inset;
  }

  private showSaved(): void {
    const buttons = this.places().flatMap((kept, place) =>
      kept
        ? [
            button(String(place + 1), `Goes to viewpoint ${place + 1}. (${place + 1})`, () =>
              this.recall(place),
            ),
          ]
        : [],
    );
    const cameras = this.session.scene?.cameras.map((camera) => this.cameraButton(camera)) ?? [];
    const forget = button("Forget", "Forgets the viewpoints kept for this scene.", () => this.forget());
    this.saved.replaceChildren(...buttons, ...(buttons.length ? [forget] : []), ...cameras);
  }

  private cameraButton(camera: Camera): HTMLButtonElement {
    return button(camera.name, `Goes to where the camera ${camera.name} is now.`, () => {
      const viewpoint = this.view.viewpointOf(camera);
      if (viewpoint) this.navigation.go(viewpoint);
    });
  }
}
