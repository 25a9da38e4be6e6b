import { type Address, emptyAddress, formatAddress, parseAddress } from "./address";
import type { Controls } from "./controls";
import type { Example, Field, Scene, Values } from "./protocol";
import type { Session } from "./session";
import type { View } from "./view/view";

/** Time after the last change until the address tells it [ms]. */
const WAIT = 300;

/** Keeps the page's address telling what the page shows, and opens what it tells. */
export class Share {
  private address: Address;
  /** What is yet to be done with the scene that the address asked for. */
  private asked: Address | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly view: View,
  ) {
    this.address = parseAddress(location.hash);
    session.on("examples", (examples) => this.open(examples));
    session.on("scene", (scene) => this.scene(scene));
    session.on("shown", (worlds) => this.shown(worlds));
    addEventListener("hashchange", () => {
      this.address = parseAddress(location.hash);
      this.open(session.examples);
    });
  }

  /** Whether the scene that comes is to be seen from the viewpoint it was shared with. */
  get keepsViewpoint(): boolean {
    return this.asked?.viewpoint !== null && this.asked !== null;
  }

  /** Opens an example as it is. */
  openExample(name: string): void {
    this.address = { ...emptyAddress(), example: name };
    this.controls.open(name);
  }

  /** Physics that the user has set. */
  setPhysics(values: Values): void {
    Object.assign(this.address.physics, values);
    this.controls.physics(values);
    this.soon();
  }

  /** The camera moved. */
  moved(): void {
    this.soon();
  }

  private open(examples: Example[]): void {
    const { example, build, physics } = this.address;
    if (!examples.some(({ name }) => name === example) || example === null) return;
    this.asked = structuredClone(this.address);
    this.controls.open(example, build, physics);
  }

  private scene(scene: Scene): void {
    const example = this.session.examples.find(({ name }) => name === scene.name);
    if (this.address.example !== scene.name) this.address.physics = {};
    this.address.example = example?.name ?? null;
    this.address.build = example ? changes(example.build, scene.build) : {};
    const asked = this.asked;
    if (asked?.viewpoint) this.view.rig.go(asked.viewpoint, true);
    if (asked?.mount && scene.bodies[asked.mount.body]) {
      this.view.mount(asked.mount.mount, { row: 0, body: asked.mount.body });
      if (asked.viewpoint) this.view.rig.go(asked.viewpoint, true);
    }
    this.soon();
  }

  private shown(worlds: number[]): void {
    const replicas = this.asked?.replicas;
    this.asked = null;
    if (replicas) this.controls.show(replicas.first, replicas.count);
    else this.address.replicas = { first: worlds[0] ?? 0, count: worlds.length };
    this.soon();
  }

  private soon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), WAIT);
  }

  private write(): void {
    const { rig, carried } = this.view;
    this.address.viewpoint = this.session.scene ? rig.viewpoint : null;
    this.address.mount = rig.mount === "free" ? null : { mount: rig.mount, body: carried.body };
    history.replaceState(null, "", `#${formatAddress(this.address)}`);
  }
}

/** Values that are not the fields' own. */
function changes(own: Field[], now: Field[]): Values {
  const before = new Map(own.map(({ name, value }) => [name, value]));
  return Object.fromEntries(now.filter((f) => before.get(f.name) !== f.value).map((f) => [f.name, f.value]));
}
