import { Emitter } from "./emitter";
import { type Frame, readFrame } from "./frame";
import {
  type Command,
  type Dof,
  type Dress,
  type Example,
  type Field,
  readMessage,
  type Scene,
  type Setting,
  type SkinFile,
  type Status,
  type Values,
} from "./protocol";
import { Malformed } from "./schema";
import type { Receiver, Transport } from "./transport/transport";

/** A setting of an actuator or a degree of freedom. */
type Drive = Exclude<Setting, { type: "physics" }>;

export interface SessionEvents {
  connected: boolean;
  examples: Example[];
  scene: Scene;
  status: Status;
  frame: Frame;
  /** Whether it goes on by itself, or has steps to make. */
  running: boolean;
  /** Which worlds are shown, in order. */
  shown: number[];
  /** What somebody else has set: another page, or the program. */
  changed: Setting[];
  /** The physics as it was last set. */
  physics: Field[];
  /** A file that bodies may wear, and what a program has them wear. */
  skinFile: SkinFile;
  dress: Dress;
  /** What went wrong, for people. */
  error: string;
  /** The type of a command that was refused. */
  refused: string;
}

/** What the page knows of the engine: the last of everything it said. Commands go out through it. */
export class Session extends Emitter<SessionEvents> implements Receiver {
  examples: Example[] = [];
  scene: Scene | null = null;
  status: Status | null = null;
  frame: Frame | null = null;
  /**
   * By the last status; or by a frame after it that it does not run any more, as the frame comes first where steps have
   * been made. That it runs a frame does not say: it may be of before, and have waited for another to be drawn.
   */
  running = false;
  shown: number[] = [];
  private readonly transport: Transport;
  /** Whether a frame came that is not yet on the screen. */
  private undrawn = false;
  /** The physics before what was asked for and not yet answered. */
  private accepted: Values | null = null;
  /** Of the drives that were set of late, their settings as the engine had them before. */
  private readonly before = new Map<string, Before>();
  private statuses = 0;
  /** Whether it was asked to run, and no status has come since. */
  private asked = false;

  constructor(connect: (receiver: Receiver) => Transport) {
    super();
    this.transport = connect(this);
  }

  send(command: Command): void {
    this.transport.send(command);
    // Not to wait for the engine's answer.
    if (command.type === "show") this.show(command.worlds);
    if (command.type === "run") this.asked = true;
    if (command.type === "physics") {
      this.accepted ??= Object.fromEntries(this.scene?.physics.map(({ name, value }) => [name, value]) ?? []);
      this.setPhysics(command.values);
    }
    if (command.type === "joint" || command.type === "control") {
      for (const single of singles(command)) this.remember(single);
      this.setDrive(command);
    }
  }

  /** Takes over what somebody else has set. */
  private change(setting: Setting): void {
    if (setting.type === "physics") {
      if (this.accepted) Object.assign(this.accepted, setting.values);
      this.setPhysics(setting.values);
    } else {
      for (const single of singles(setting)) this.changeDrive(single);
    }
  }

  /** What was said before the engine heard this page's own word does not take it back. */
  private changeDrive(single: Drive): void {
    const before = this.before.get(keyOf(single));
    if (before) before.drive = single;
    if (!before || performance.now() - before.at > UNDERWAY) this.setDrive(single);
  }

  /** The last frame that came is on the screen. */
  drawn(): void {
    this.undrawn = false;
    this.transport.drawn();
  }

  /** Lets go of the engine. */
  close(): void {
    this.transport.close();
  }

  connected(connected: boolean): void {
    this.emit("connected", connected);
  }

  text(json: string): void {
    this.guarded(() => this.read(json));
  }

  binary(bytes: ArrayBuffer): void {
    const frame = this.guarded(() => this.check(readFrame(bytes)));
    if (frame) {
      this.frame = frame;
      this.undrawn = true;
      if (!frame.running && !this.asked) this.setRunning(false);
      this.emit("frame", frame);
    } else {
      this.drawn();
    }
  }

  failed(reason: string): void {
    this.emit("error", reason);
  }

  private read(json: string): void {
    const message = readMessage(json);
    switch (message.type) {
      case "welcome":
        this.examples = message.examples;
        this.emit("examples", message.examples);
        break;
      case "scene":
        this.scene = message;
        this.before.clear();
        this.frame = null;
        // What was to be drawn of the last scene never will be.
        if (this.undrawn) this.drawn();
        this.shown = message.shown;
        this.emit("scene", message);
        this.emit("physics", message.physics);
        // Who hears of the scene may have asked for other worlds of it.
        this.emit("shown", this.shown);
        break;
      case "status":
        this.status = message;
        this.accepted = null;
        this.settle();
        if (!same(message.shown, this.shown)) this.show(message.shown);
        this.asked = false;
        this.setRunning(message.running);
        this.emit("status", message);
        break;
      case "changed":
        for (const setting of message.commands) this.change(setting);
        this.emit("changed", message.commands);
        break;
      case "skin_file":
        this.emit("skinFile", message);
        break;
      case "dress":
        if (message.scene !== this.scene?.id) break;
        checkBodies(message, this.scene.bodies.length);
        this.emit("dress", message);
        break;
      case "error":
        if (message.refused === "physics" && this.accepted) this.setPhysics(this.accepted);
        if (message.refused === "joint" || message.refused === "control") {
          this.restoreDrive(message.refused);
        }
        if (message.refused !== null) this.emit("refused", message.refused);
        this.emit("error", message.message);
    }
  }

  /** The frame, or null where it is of a scene that is gone. */
  private check(frame: Frame): Frame | null {
    const scene = this.scene;
    if (!scene || frame.scene !== scene.id) return null;
    if (frame.bodies !== scene.bodies.length) {
      throw new Malformed(`a frame has ${frame.bodies} bodies, its scene ${scene.bodies.length}`);
    }
    return frame;
  }

  private setPhysics(values: Values): void {
    if (!this.scene) return;
    for (const field of this.scene.physics) field.value = values[field.name] ?? field.value;
    this.emit("physics", this.scene.physics);
  }

  /** Remembers a setting as it is before it is set, unless it was set of late. */
  private remember(single: Drive): void {
    const key = keyOf(single);
    const { drive, wrong } = this.before.get(key) ?? { drive: this.drive(single), wrong: 0 };
    this.before.delete(key);
    if (!drive) return;
    this.before.set(key, {
      drive,
      wrong: wrong + (this.canBe(single) ? 0 : 1),
      since: this.statuses,
      at: performance.now(),
    });
  }

  /** A status may have been under way when a command was sent; after the next, that was not refused. */
  private settle(): void {
    this.statuses += 1;
    for (const [key, { since }] of this.before) if (since + 2 <= this.statuses) this.before.delete(key);
  }

  /** One setting, as it is. */
  private drive(single: Drive): Drive | null {
    if (single.type === "control") {
      const actuator = this.scene?.actuators[single.actuator];
      return actuator ? { ...single, value: actuator.value } : null;
    }
    const own = this.dof(single.dof);
    const [name] = settingsOf(single);
    return own && name ? { type: "joint", dof: single.dof, [name]: own[name] } : null;
  }

  /**
   * What was refused is as before. Of several that were set since, it is the one that cannot be: a negative gain, a
   * control out of its range; else the last.
   */
  private restoreDrive(type: Drive["type"]): void {
    const candidates = [...this.before].filter(([, { drive }]) => drive.type === type);
    const [, before] = candidates.find(([, { wrong }]) => wrong > 0) ?? candidates.at(-1) ?? [];
    if (!before) return;
    const { drive } = before;
    before.wrong -= 1;
    this.setDrive(drive);
    this.emit("changed", [drive]);
  }

  private canBe(drive: Drive): boolean {
    if (drive.type === "joint") return (drive.stiffness ?? 0) >= 0 && (drive.damping ?? 0) >= 0;
    const slider = this.scene?.actuators[drive.actuator]?.slider;
    return !slider?.strict || (drive.value >= slider.min && drive.value <= slider.max);
  }

  private dof(wanted: number): Dof | undefined {
    return this.scene?.joints.flatMap(({ dofs }) => dofs).find(({ dof }) => dof === wanted);
  }

  /** The scene says how drives are, for who looks at it later. */
  private setDrive(command: Drive): void {
    if (command.type === "control") {
      const actuator = this.scene?.actuators[command.actuator];
      if (actuator) actuator.value = command.value;
    } else {
      const own = this.dof(command.dof);
      if (!own) return;
      own.position = command.position ?? own.position;
      own.stiffness = command.stiffness ?? own.stiffness;
      own.velocity = command.velocity ?? own.velocity;
      own.damping = command.damping ?? own.damping;
    }
  }

  private setRunning(running: boolean): void {
    if (this.running === running) return;
    this.running = running;
    this.emit("running", running);
  }

  private show(worlds: number[]): void {
    this.shown = worlds;
    this.emit("shown", worlds);
  }

  /** A malformed message is told, and changes nothing. */
  private guarded<T>(read: () => T): T | null {
    try {
      return read();
    } catch (error) {
      if (!(error instanceof Malformed)) throw error;
      this.failed(`A message from the engine was not understood. ${error.message}`);
      return null;
    }
  }
}

/** A setting as it was. */
interface Before {
  drive: Drive;
  /** How often it was set since to what it cannot be. */
  wrong: number;
  /** How many statuses had come when it was set last, and when that was [ms]. */
  since: number;
  at: number;
}

/** Time for which a message may be under way [ms]. */
const UNDERWAY = 500;

const JOINT_SETTINGS = ["position", "stiffness", "velocity", "damping"] as const;

function settingsOf(drive: Extract<Drive, { type: "joint" }>) {
  return JOINT_SETTINGS.filter((name) => drive[name] !== undefined);
}

/** A command as commands that set one thing each. */
function singles(drive: Drive): Drive[] {
  if (drive.type === "control") return [drive];
  return settingsOf(drive).map((name) => ({ type: "joint", dof: drive.dof, [name]: drive[name] }));
}

/** What a command sets that sets one thing. */
function keyOf(single: Drive): string {
  return single.type === "control"
    ? `control ${single.actuator}`
    : `joint ${single.dof} ${settingsOf(single).join()}`;
}

function checkBodies({ outfits }: Dress, end: number): void {
  for (const row of outfits.flatMap(({ bodies }) => bodies ?? [])) {
    if (row >= end) throw new Malformed(`dresses body ${row} of ${end}`);
  }
}

/** Whether two lists hold the same. */
export function same(a: readonly number[], b: readonly number[]): boolean {
  return a.length === b.length && a.every((x, i) => x === b[i]);
}
