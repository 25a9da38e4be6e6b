// One thread steps one world, then those that lie whole grids beyond it. A world's number at an offset lies at
// offset * worlds + world, or so in a piece of a few worlds, so that neighbouring threads read neighbours.
//
// To be compiled without contraction (--fmad=false), and with division and square root rounded as IEEE 754 has it,
// which is the default: then each operation here gives the bits that it gives on the CPU.
typedef float f32;
typedef unsigned int u32;

__device__ __forceinline__ f32 lesser(f32 a, f32 b) {
    return a < b ? a : b;
}
__device__ __forceinline__ f32 greater(f32 a, f32 b) {
    return a > b ? a : b;
}
__device__ __forceinline__ f32 select(f32 no, f32 yes, bool mask) {
    return mask ? yes : no;
}
// Halves to even.
__device__ __forceinline__ f32 nearest(f32 x) {
    return rintf(x);
}
// Towards zero; what no u32 is becomes the nearest, NaN zero.
__device__ __forceinline__ u32 whole(f32 x) {
    return __float2uint_rz(x);
}
__device__ __forceinline__ f32 with_sign(f32 x, f32 sign) {
    return copysignf(x, sign);
}
__device__ __forceinline__ f32 power_of_two(int n) {
    return __uint_as_float(u32(n + 127) << 23u);
}
// x * 2^n in two factors, each a normal power of two.
__device__ __forceinline__ f32 scaled(f32 x, f32 n) {
    const int all = __float2int_rz(lesser(greater(n, -252.0f), 252.0f));
    const int half = all >> 1;
    return x * power_of_two(half) * power_of_two(all - half);
}
__device__ __forceinline__ f32 fraction(f32 x) {
    return __uint_as_float((__float_as_uint(x) & 0x807fffffu) | 0x3f800000u);
}
__device__ __forceinline__ f32 exponent(f32 x) {
    return f32(int((__float_as_uint(x) >> 23u) & 0xffu) - 127);
}
