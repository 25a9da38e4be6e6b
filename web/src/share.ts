import { type Address, emptyAddress, formatAddress, parseAddress } from "./address";
import type { Controls } from "./controls";
import type { Notice } from "./notice";
import type { Field, Scene, Values } from "./protocol";
import type { Session } from "./session";
import type { View } from "./view/view";

/** Time after the last change until the address tells it [ms]. */
const WAIT = 300;

const COPIED = "The address is copied.";

/**
 * Keeps the page's address telling what the page shows, and opens what it tells. A scene of the example that
 * the address names is shown as the address says; one of another example is shown as it comes.
 */
export class Share {
  private address: Address;
  /** The example that was asked for, until its scene is here. */
  private opening: string | null = null;
  /** The scene that is shown. */
  private showing: string | null = null;
  /** The number of the last scene. */
  private last: number | null = null;
  /** Whether the next scene is the one that the engine has when the page comes to it. */
  private greeted = false;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly session: Session,
    private readonly controls: Controls,
    private readonly view: View,
    private readonly notice: Notice,
  ) {
    this.address = parseAddress(location.hash);
    session.on("examples", () => {
      this.greeted = true;
    });
    session.on("scene", (scene) => {
      if (this.greeted) this.greet(scene);
      else this.scene(scene);
      this.greeted = false;
      this.last = scene.id;
    });
    session.on("shown", (worlds) => this.shown(worlds));
    session.on("refused", (type) => this.refused(type));
    session.on("changed", (settings) => {
      for (const setting of settings) if (setting.type === "physics") this.tellPhysics(setting.values);
    });
    session.on("error", () => {
      this.opening = null;
    });
    addEventListener("hashchange", ({ newURL }) => {
      // The address itself may have been written anew since, before this event came.
      this.address = parseAddress(new URL(newURL).hash);
      // What names no example is about the scene that is shown.
      if (!this.open() && session.scene) this.scene(session.scene);
    });
  }

  /** Opens an example as it is. */
  openExample(name: string): void {
    this.address = { ...emptyAddress(), example: name };
    this.open();
  }

  /** Physics that the user has set. */
  setPhysics(values: Values): void {
    this.controls.physics(values);
    this.tellPhysics(values);
  }

  private tellPhysics(values: Values): void {
    Object.assign(this.address.physics, values);
    this.soon();
  }

  /** The address says what is, not what was refused. */
  private refused(type: string): void {
    const { physics, build, example } = this.address;
    if (type === "physics") {
      for (const { name, value } of this.session.scene?.physics ?? []) {
        if (name in physics) physics[name] = value;
      }
      this.soon();
    } else if (type === "open" && example !== null && this.opening === example) {
      // An example that was to be built in a way it is not comes as it is.
      if (Object.keys({ ...physics, ...build }).length) this.openExample(example);
    }
  }

  /** The camera moved. */
  moved(): void {
    const { rig, carried } = this.view;
    this.address.viewpoint = rig.viewpoint;
    this.address.mount = rig.mount === "free" ? null : { mount: rig.mount, body: carried.body };
    this.soon();
  }

  /** Puts the address into the clipboard. */
  async copy(): Promise<void> {
    this.write();
    try {
      await navigator.clipboard.writeText(location.href);
      this.notice.tell(COPIED);
      setTimeout(() => this.notice.clear(COPIED), 4000);
    } catch {
      this.notice.tell("The browser lets no page write to the clipboard here; copy the address by hand.");
    }
  }

  /** Opens the example of the address; false where it names none. */
  private open(): boolean {
    const { example, build, physics } = this.address;
    const { examples } = this.session;
    if (example === null) return false;
    if (!examples.some(({ name }) => name === example)) {
      if (examples.length) this.notice.tell(`There is no example ${example}.`);
      return false;
    }
    this.opening = example;
    this.controls.open(example, build, physics);
    return true;
  }

  /**
   * The scene that the engine has when the page comes, which gives way to the address's; or when the page comes back.
   * Then it goes on, since others may watch it, unless the engine began anew, with other numbers of scenes.
   */
  private greet(scene: Scene): void {
    const wentOn = this.last !== null && scene.id >= this.last;
    if (wentOn || !this.open()) this.scene(scene);
  }

  private scene(scene: Scene): void {
    if (this.opening !== null && this.opening !== scene.name) return;
    this.opening = null;
    const example = this.session.examples.find(({ name }) => name === scene.name);
    const first = this.showing === null;
    const told = this.address.example ?? this.showing ?? scene.name;
    this.showing = scene.name;
    if (told !== scene.name) this.address = emptyAddress();
    this.address.example = example?.name ?? null;
    this.address.build = example ? changes(example.build, scene.build) : {};
    // A file is not opened by its name, but its physics can be set; not so that of a program.
    const { physics } = this.address;
    const known = scene.physics.some(({ name }) => name in physics);
    if (first && !example && known) this.controls.physics(physics);
    this.look(scene);
    this.soon();
  }

  /** Sees a scene as the address says. */
  private look(scene: Scene): void {
    const { replicas, viewpoint, mount } = this.address;
    if (replicas && !sameReplicas(scene.shown, replicas)) this.controls.show(replicas.first, replicas.count);
    if (mount && scene.bodies[mount.body]) this.view.mount(mount.mount, { row: 0, body: mount.body });
    else this.address.mount = null;
    if (viewpoint) this.view.lookFrom(viewpoint);
  }

  private shown(worlds: number[]): void {
    // Those that a scene comes with are nobody's choice.
    if (this.opening !== null || worlds === this.session.scene?.shown) return;
    this.address.replicas = { first: worlds[0] ?? 0, count: worlds.length };
    this.soon();
  }

  private soon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), WAIT);
  }

  private write(): void {
    history.replaceState(null, "", `#${formatAddress(this.address)}`);
  }
}

function sameReplicas(worlds: number[], { first, count }: { first: number; count: number }): boolean {
  return worlds.length === count && worlds.every((world, row) => world === first + row);
}

/** Values that are not the fields' own. */
function changes(own: Field[], now: Field[]): Values {
  const before = new Map(own.map(({ name, value }) => [name, value]));
  return Object.fromEntries(now.filter((f) => before.get(f.name) !== f.value).map((f) => [f.name, f.value]));
}
