import { Emitter } from "./emitter";
import { type Frame, readFrame } from "./frame";
import {
  type Command,
  type Dof,
  type Example,
  type Field,
  readMessage,
  type Scene,
  type Setting,
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
  /** Which worlds are shown, in order. */
  shown: number[];
  /** What somebody else has set: another page, or the program. */
  changed: Setting[];
  /** The physics as it was last set. */
  physics: Field[];
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
  shown: number[] = [];
  private readonly transport: Transport;
  /** Whether a frame came that is not yet on the screen. */
  private undrawn = false;
  /** The physics before what was asked for and not yet answered. */
  private accepted: Values | null = null;
  /** What was set last of the drives, as it was before. */
  private before: Drive | null = null;

  constructor(connect: (receiver: Receiver) => Transport) {
    super();
    this.transport = connect(this);
  }

  send(command: Command): void {
    this.transport.send(command);
    // Not to wait for the engine's answer.
    if (command.type === "show") this.show(command.worlds);
    if (command.type === "physics") {
      this.accepted ??= Object.fromEntries(this.scene?.physics.map(({ name, value }) => [name, value]) ?? []);
      this.setPhysics(command.values);
    }
    if (command.type === "joint" || command.type === "control") {
      this.before = this.drive(command);
      this.setDrive(command);
    }
  }

  /** Takes over what somebody else has set. */
  private change(setting: Setting): void {
    if (setting.type === "physics") {
      if (this.accepted) Object.assign(this.accepted, setting.values);
      this.setPhysics(setting.values);
    } else {
      this.setDrive(setting);
    }
  }

  /** The last frame that came is on the screen. */
  drawn(): void {
    this.undrawn = false;
    this.transport.drawn();
  }

  connected(connected: boolean): void {
    this.emit("connected", connected);
  }

  text(json: string): void {
    this.guarded(() => this.read(json));
  }

  binary(bytes: ArrayBuffer): void {
    let frame: Frame | null = null;
    this.guarded(() => {
      frame = this.check(readFrame(bytes));
    });
    if (frame) {
      this.frame = frame;
      this.undrawn = true;
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
        if (!same(message.shown, this.shown)) this.show(message.shown);
        this.emit("status", message);
        break;
      case "changed":
        for (const setting of message.commands) this.change(setting);
        this.emit("changed", message.commands);
        break;
      case "error":
        if (message.refused === "physics" && this.accepted) this.setPhysics(this.accepted);
        if (message.refused === "joint" || message.refused === "control") this.restoreDrive();
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

  /** What a command is about to set, as it is. */
  private drive(command: Drive): Drive | null {
    if (command.type === "control") {
      const actuator = this.scene?.actuators[command.actuator];
      return actuator ? { ...command, value: actuator.value } : null;
    }
    const own = this.dof(command.dof);
    if (!own) return null;
    const { dof, position, stiffness, velocity, damping } = own;
    return { type: "joint", dof, position, stiffness, velocity, damping };
  }

  /** The last drive is as it was: it cannot be as was asked. */
  private restoreDrive(): void {
    if (!this.before) return;
    this.setDrive(this.before);
    this.emit("changed", [this.before]);
    this.before = null;
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

  private show(worlds: number[]): void {
    this.shown = worlds;
    this.emit("shown", worlds);
  }

  /** A malformed message is told, and changes nothing. */
  private guarded(read: () => void): void {
    try {
      read();
    } catch (error) {
      if (!(error instanceof Malformed)) throw error;
      this.failed(`A message from the engine was not understood. ${error.message}`);
    }
  }
}

/** Whether two lists hold the same. */
export function same(a: readonly number[], b: readonly number[]): boolean {
  return a.length === b.length && a.every((x, i) => x === b[i]);
}
