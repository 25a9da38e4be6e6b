// Writes the columns of some worlds, as resets set them: columns[number][i] of world places[i], of which there are `count`
// with so many `numbers` each; the state is that of so many `worlds`.
extern "C" __global__ void place(
    float* __restrict__ state, const float* __restrict__ columns, const unsigned int* __restrict__ places,
    const unsigned int count, const unsigned int numbers, const unsigned int worlds) {
    const unsigned int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) { return; }
    for (unsigned int number = 0u; number < numbers; number++) {
        state[number * worlds + places[i]] = columns[number * count + i];
    }
}
