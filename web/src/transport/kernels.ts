/** What is compiled for the card, and the buffers that it sees. */

/** Texts whose kernels nobody uses any more and that are kept, as the next model may need them: piles have some fifty. */
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
  readonly kernels: Map<string, Kernel>;
}

/** What is compiled of texts. */
export class Compiler {
  /** The text that was asked for last at the end. */
  private readonly texts = new Map<string, Text>();
  private readonly layouts = new Map<string, GPUBindGroupLayout>();
  private begun: Promise<Error | null>[] = [];

  constructor(private readonly device: GPUDevice) {}

  text(text: string): Text {
    const kernels = new Map<string, Kernel>();
    const own = this.texts.get(text) ?? {
      text,
      module: this.device.createShaderModule({ code: text }),
      kernels,
    };
    this.texts.delete(text);
    this.texts.set(text, own);
    const [oldest] = this.texts.keys();
    if (this.texts.size > KEPT) this.texts.delete(oldest);
    return own;
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
    if (wrong) throw wrong;
  }
}
