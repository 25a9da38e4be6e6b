// Where a memory has a world's number, of which each world has so many: worlds lie in pieces of so many.
__device__ unsigned int held(
    const unsigned int number, const unsigned int world, const unsigned int numbers, const unsigned int piece) {
    return ((world / piece) * numbers + number) * piece + world % piece;
}
// Writes the columns of some worlds, as resets set them: columns[number][i] of world places[i], of which there are `count`
// with so many `numbers` each.
extern "C" __global__ void place(
    float* __restrict__ memory, const float* __restrict__ columns, const unsigned int* __restrict__ places,
    const unsigned int count, const unsigned int numbers, const unsigned int piece) {
    const unsigned int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= count) { return; }
    for (unsigned int number = 0u; number < numbers; number++) {
        memory[held(number, places[i], numbers, piece)] = columns[number * count + i];
    }
}
// Reads rows of all worlds, `count` from the one numbered `first`.
extern "C" __global__ void gather(
    const float* __restrict__ state, float* __restrict__ rows, const unsigned int first, const unsigned int count,
    const unsigned int numbers, const unsigned int worlds, const unsigned int piece) {
    const unsigned int world = blockIdx.x * blockDim.x + threadIdx.x;
    if (world >= worlds) { return; }
    for (unsigned int i = 0u; i < count; i++) {
        rows[i * worlds + world] = state[held(first + i, world, numbers, piece)];
    }
}
