/** What is compiled for the card, and the buffers that it sees. */

/** Texts that are kept, as the next model may need them: piles have some fifty. */
const KEPT = 96;
const COMPUTE = 0x4;

/** Kinds of buffers, by their numbers. */
const KINDS: GPUBufferBindingType[] = ["storage", "read-only-storage", "uniform"];

/** An entry point of a text, with the bindings that it sees. */
export interface Kernel {
  /** Null until it is compiled. */
  pipeline: GPUComputePipeline | null;
  readonly layout: GPUBindGroupLayout;
  readonly sees: number[];
}

/** Buffers by their bindings, of which a kernel sees some. */
export class Bindings {
  private readonly groups = new Map<GPUBindGroupLayout, GPUBindGroup>();

  constructor(private readonly buffers: GPUBuffer[]) {}

  of(device: GPUDevice, { layout, sees }: Kernel): GPUBindGroup {
    let group = this.groups.get(layout);
    if (!group) {
      const entries = sees.map((binding) => ({ binding, resource: { buffer: this.buffers[binding] } }));
      group = device.createBindGroup({ layout, entries });
      this.groups.set(layout, group);
    }
    return group;
  }
}

/** A text, and what was asked for of it. */
export interface Text {
  readonly text: string;
  readonly module: GPUShaderModule;
  /** What is wrong with it; it is no failure of the card. */
  readonly wrong: Promise<GPUError | null>;
  readonly kernels: Map<string, Kernel>;
}

/** What is compiled of texts. */
export class Compiler {
  /** The text that was asked for last at the end. */
  private readonly texts = new Map<string, Text>();
  private readonly layouts = new Map<string, GPUBindGroupLayout>();
  private begun: Promise<Error | null>[] = [];
  /** Texts that were asked for since all was compiled the last time. */
  private readonly asked = new Set<string>();

  constructor(private readonly device: GPUDevice) {}

  text(text: string): Text {
    const own = this.texts.get(text) ?? this.read(text);
    this.texts.delete(text);
    this.texts.set(text, own);
    this.asked.add(text);
    return own;
  }

  private read(text: string): Text {
    this.device.pushErrorScope("validation");
    const module = this.device.createShaderModule({ code: text });
    return { text, module, wrong: this.device.popErrorScope(), kernels: new Map() };
  }

  /** Begins to compile an entry point that sees these bindings of these kinds, unless it is known. */
  kernel(of: Text, name: string, sees: number[], kinds: number[]): Kernel {
    const known = of.kernels.get(name);
    if (known) return known;
    const kernel: Kernel = { pipeline: null, layout: this.layout(sees, kinds), sees };
    of.kernels.set(name, kernel);
    this.begun.push(this.compile(of, name, kernel));
    return kernel;
  }

  /** What is wrong with it. */
  private async compile(of: Text, name: string, kernel: Kernel): Promise<Error | null> {
    try {
      const wrong = await of.wrong;
      if (wrong) throw new Error(wrong.message);
      kernel.pipeline = await this.device.createComputePipelineAsync({
        layout: this.device.createPipelineLayout({ bindGroupLayouts: [kernel.layout] }),
        compute: { module: of.module, entryPoint: name },
      });
      return null;
    } catch (error) {
      // Asked for anew, it is tried anew.
      this.texts.delete(of.text);
      return error as Error;
    }
  }

  private layout(sees: number[], kinds: number[]): GPUBindGroupLayout {
    const key = sees.map((binding, i) => `${binding} ${kinds[i]}`).join();
    let layout = this.layouts.get(key);
    if (!layout) {
      const entries = sees.map((binding, i) => ({
        binding,
        visibility: COMPUTE,
        buffer: { type: KINDS[kinds[i]] },
      }));
      layout = this.device.createBindGroupLayout({ entries });
      this.layouts.set(key, layout);
    }
    return layout;
  }

  /** Waits until all is compiled that was begun. */
  async compiled(): Promise<void> {
    const begun = this.begun;
    this.begun = [];
    const wrong = (await Promise.all(begun)).find((error) => error !== null);
    this.forget();
    if (wrong) throw wrong;
  }

  /** Lets go what was not asked for for the longest time, but nothing of the present model. */
  private forget(): void {
    for (const text of this.texts.keys()) {
      if (this.texts.size <= KEPT || this.asked.has(text)) break;
      this.texts.delete(text);
    }
    this.asked.clear();
  }
}
