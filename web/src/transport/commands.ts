/** What the engine asks of the card together, as it writes it down: words that name kernels, bindings and buffers. */

import type { Bindings, Kernel } from "./kernels";

/** Bytes of a word. */
export const WORD = 4;

/** What begins a command, and how many words follow: the engine has the same. */
const RUN = 0; // kernel, bindings, workgroups
const RUN_TOLD = 1; // kernel, bindings, buffer with numbers of workgroups, which three of them
const COPY = 2; // buffer, first word, buffer, first word there, words

/** What numbers in commands stand for. */
export interface Things {
  kernel(number: number): Kernel;
  bindings(number: number): Bindings;
  buffer(number: number): GPUBuffer;
}

/** Writes commands for the card. Runs that follow each other are one pass. */
export function encode(device: GPUDevice, words: Uint32Array, things: Things): GPUCommandBuffer {
  const encoder = device.createCommandEncoder();
  let pass = null as GPUComputePassEncoder | null;
  let at = 0;
  const next = () => words[at++];
  const set = (): GPUComputePassEncoder => {
    const kernel = things.kernel(next());
    if (!kernel.pipeline) throw new Error("a kernel is not compiled yet");
    pass ??= encoder.beginComputePass();
    pass.setPipeline(kernel.pipeline);
    pass.setBindGroup(0, things.bindings(next()).of(device, kernel));
    return pass;
  };
  while (at < words.length) {
    const command = next();
    if (command === RUN) {
      set().dispatchWorkgroups(next());
    } else if (command === RUN_TOLD) {
      set().dispatchWorkgroupsIndirect(things.buffer(next()), 3 * next() * WORD);
    } else if (command === COPY) {
      pass?.end();
      pass = null;
      const [from, start, to, place, count] = [next(), next(), next(), next(), next()];
      encoder.copyBufferToBuffer(
        things.buffer(from),
        start * WORD,
        things.buffer(to),
        place * WORD,
        count * WORD,
      );
    } else {
      throw new Error(`there is no command ${command}`);
    }
  }
  pass?.end();
  return encoder.finish();
}
