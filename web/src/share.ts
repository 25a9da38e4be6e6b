import { type Address, emptyAddress, formatAddress, parseAddress } from "./address";
import type { Controls } from "./controls";
import type { Notice } from "./notice";
import type { Command, Field, Scene, Values } from "./protocol";
import type { Session } from "./session";
import type { View } from "./view/view";

/** Time after the last change until the address tells it [ms]. */
const WAIT = 300;

type FileCommand = Extract<Command, { type: "file" }>;

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
  /** Robot files that were opened here, by their names: they can be opened again. */
  readonly files = new Map<string, FileCommand>();
  /** The file that was sent, until its scene is here. */
  private sent: FileCommand | null = null;
  /** Whether what is opened becomes a step of the browser's history, to which one can go back. */
  private stepping = false;

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
      this.opening = this.sent = null;
      this.stepping = false;
    });
    // Addresses tell no file; steps of the history do.
    addEventListener("popstate", ({ state }) => {
      const file = this.files.get(state?.file);
      if (file) this.send(file);
    });
    addEventListener("hashchange", ({ newURL }) => {
      if (this.sent) return;
      this.notice.clear();
      // The address itself may have been written anew since, before this event came.
      this.address = parseAddress(new URL(newURL).hash);
      // What names no example is about the scene that is shown.
      if (!this.open() && session.scene) this.scene(session.scene);
    });
  }

  /** Whether an example was asked for that is not yet here. */
  get awaits(): boolean {
    return this.opening !== null;
  }

  /** Opens an example as it is. */
  openExample(name: string): void {
    this.notice.clear();
    this.stepping = true;
    this.openPlain(name);
  }

  private openPlain(example: string): void {
    this.address = { ...emptyAddress(), example };
    this.open();
  }

  /** Opens a robot file. */
  openFile(file: FileCommand): void {
    this.stepping = true;
    this.send(file);
  }

  private send(file: FileCommand): void {
    this.notice.clear();
    this.opening = null;
    this.sent = file;
    this.session.send(file);
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
      if (Object.keys({ ...physics, ...build }).length) this.openPlain(example);
    }
  }

  /** The camera moved. */
  moved(): void {
    this.address.viewpoint = this.view.rig.viewpoint;
    this.address.carrier = this.view.carried;
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
   * The scene that the engine has when the page comes, which gives way to the address's unless it is that; or when the
   * page comes back. Then it goes on, since others may watch it, unless the engine began anew, with other numbers of
   * scenes.
   */
  private greet(scene: Scene): void {
    const wentOn = this.last !== null && scene.id >= this.last;
    if (wentOn || this.tells(scene) || !this.open()) this.scene(scene);
  }

  /** Whether the address tells of this scene: its example, built as it is, under the physics that is told. */
  private tells({ name, build, physics }: Scene): boolean {
    const { address } = this;
    const example = this.session.examples.find((each) => each.name === name);
    if (!example || address.example !== name) return false;
    const values = Object.fromEntries(example.build.map((field) => [field.name, field.value]));
    return agree({ ...values, ...address.build }, build) && agree(address.physics, physics);
  }

  private scene(scene: Scene): void {
    if (this.opening !== null && this.opening !== scene.name) return;
    this.opening = null;
    if (this.sent?.name === scene.name) this.files.set(scene.name, this.sent);
    this.sent = null;
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
    const { replicas, viewpoint, carrier } = this.address;
    if (replicas && !sameReplicas(scene.shown, replicas)) this.controls.show(replicas.first, replicas.count);
    if (carrier && scene.bodies[carrier.body]) this.view.carried = carrier;
    else this.address.carrier = null;
    if (viewpoint) this.view.lookFrom(viewpoint);
  }

  private shown(worlds: number[]): void {
    // Those that a scene comes with are nobody's choice.
    if (this.opening !== null || worlds === this.session.scene?.shown) return;
    this.address.replicas = { first: worlds[0] ?? 0, count: worlds.length };
    if (this.address.carrier) this.address.carrier = this.view.carried;
    this.soon();
  }

  private soon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), WAIT);
  }

  private write(): void {
    const address = `#${formatAddress(this.address)}`;
    const file = this.showing !== null && this.files.has(this.showing) ? this.showing : null;
    if (this.stepping) history.pushState({ file }, "", address);
    else history.replaceState({ file }, "", address);
    this.stepping = false;
  }
}

/** Whether fields have these values. */
function agree(values: Values, fields: Field[]): boolean {
  const now = new Map(fields.map(({ name, value }) => [name, value]));
  return Object.entries(values).every(([name, value]) => now.get(name) === value);
}

function sameReplicas(worlds: number[], { first, count }: { first: number; count: number }): boolean {
  return worlds.length === count && worlds.every((world, row) => world === first + row);
}

/** Values that are not the fields' own. */
function changes(own: Field[], now: Field[]): Values {
  const before = new Map(own.map(({ name, value }) => [name, value]));
  return Object.fromEntries(now.filter((f) => before.get(f.name) !== f.value).map((f) => [f.name, f.value]));
}
