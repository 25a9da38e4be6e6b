// What WGSL has and CUDA C++ lacks, or does in its own way.
//
// To be compiled without contraction (--fmad=false), and with division and square root rounded as IEEE 754 has it,
// which is the default: then each operation here gives the bits that it gives on the CPU.
typedef float f32;
typedef unsigned int u32;
typedef int i32;

#define DEVICE __device__ __forceinline__

namespace wgsl {

// Aligned as in WGSL, so that vectors of two and four are read and written at once; those of three lie packed.
template <typename T> struct alignas(2 * sizeof(T)) vec2 {
    T x, y;
    static DEVICE vec2 splat(T a) { return {a, a}; }
    DEVICE T at(u32 i) const { return i == 0u ? x : y; }
    DEVICE void put(u32 i, T a) {
        if (i == 0u) x = a;
        else y = a;
    }
};
template <typename T> struct vec3 {
    T x, y, z;
    static DEVICE vec3 splat(T a) { return {a, a, a}; }
    DEVICE T at(u32 i) const { return i == 0u ? x : i == 1u ? y : z; }
    DEVICE void put(u32 i, T a) {
        if (i == 0u) x = a;
        else if (i == 1u) y = a;
        else z = a;
    }
};
template <typename T> struct alignas(4 * sizeof(T)) vec4 {
    T x, y, z, w;
    static DEVICE vec4 splat(T a) { return {a, a, a, a}; }
    DEVICE T at(u32 i) const { return i == 0u ? x : i == 1u ? y : i == 2u ? z : w; }
    DEVICE void put(u32 i, T a) {
        if (i == 0u) x = a;
        else if (i == 1u) y = a;
        else if (i == 2u) z = a;
        else w = a;
    }
};

// What is beyond its end is its last item.
template <typename T, u32 N> struct Array {
    T items[N];
    DEVICE T& operator[](u32 i) { return items[i < N ? i : N - 1u]; }
    DEVICE const T& operator[](u32 i) const { return items[i < N ? i : N - 1u]; }
};

// The same for each component, where what is done to one is `OF`.
#define LIFT1(NAME, R, OF) \
    template <typename T> DEVICE vec2<R> NAME(vec2<T> a) { return {OF(a.x), OF(a.y)}; } \
    template <typename T> DEVICE vec3<R> NAME(vec3<T> a) { return {OF(a.x), OF(a.y), OF(a.z)}; } \
    template <typename T> DEVICE vec4<R> NAME(vec4<T> a) { return {OF(a.x), OF(a.y), OF(a.z), OF(a.w)}; }
#define LIFT2(NAME, R, OF) \
    template <typename T> DEVICE vec2<R> NAME(vec2<T> a, vec2<T> b) { return {OF(a.x, b.x), OF(a.y, b.y)}; } \
    template <typename T> DEVICE vec3<R> NAME(vec3<T> a, vec3<T> b) { \
        return {OF(a.x, b.x), OF(a.y, b.y), OF(a.z, b.z)}; \
    } \
    template <typename T> DEVICE vec4<R> NAME(vec4<T> a, vec4<T> b) { \
        return {OF(a.x, b.x), OF(a.y, b.y), OF(a.z, b.z), OF(a.w, b.w)}; \
    }
#define LIFT3(NAME, C, OF) \
    template <typename T> DEVICE vec2<T> NAME(vec2<T> a, vec2<T> b, vec2<C> c) { \
        return {OF(a.x, b.x, c.x), OF(a.y, b.y, c.y)}; \
    } \
    template <typename T> DEVICE vec3<T> NAME(vec3<T> a, vec3<T> b, vec3<C> c) { \
        return {OF(a.x, b.x, c.x), OF(a.y, b.y, c.y), OF(a.z, b.z, c.z)}; \
    } \
    template <typename T> DEVICE vec4<T> NAME(vec4<T> a, vec4<T> b, vec4<C> c) { \
        return {OF(a.x, b.x, c.x), OF(a.y, b.y, c.y), OF(a.z, b.z, c.z), OF(a.w, b.w, c.w)}; \
    }

namespace maths {

// Whole numbers wrap.
DEVICE f32 sum(f32 a, f32 b) { return a + b; }
DEVICE u32 sum(u32 a, u32 b) { return a + b; }
DEVICE i32 sum(i32 a, i32 b) { return i32(u32(a) + u32(b)); }
DEVICE f32 difference(f32 a, f32 b) { return a - b; }
DEVICE u32 difference(u32 a, u32 b) { return a - b; }
DEVICE i32 difference(i32 a, i32 b) { return i32(u32(a) - u32(b)); }
DEVICE f32 product(f32 a, f32 b) { return a * b; }
DEVICE u32 product(u32 a, u32 b) { return a * b; }
DEVICE i32 product(i32 a, i32 b) { return i32(u32(a) * u32(b)); }
DEVICE f32 negative(f32 a) { return -a; }
DEVICE i32 negative(i32 a) { return i32(0u - u32(a)); }
// By zero, and where the quotient is no i32, they are divided by one.
DEVICE f32 quotient(f32 a, f32 b) { return a / b; }
DEVICE u32 quotient(u32 a, u32 b) { return a / (b == 0u ? 1u : b); }
DEVICE i32 divisor(i32 a, i32 b) { return b == 0 || (b == -1 && a == -2147483647 - 1) ? 1 : b; }
DEVICE i32 quotient(i32 a, i32 b) { return a / divisor(a, b); }
DEVICE f32 remainder(f32 a, f32 b) { return a - b * ::truncf(a / b); }
DEVICE u32 remainder(u32 a, u32 b) { return a % (b == 0u ? 1u : b); }
DEVICE i32 remainder(i32 a, i32 b) { return a % divisor(a, b); }
DEVICE u32 shifted_left(u32 a, u32 n) { return a << (n & 31u); }
DEVICE i32 shifted_left(i32 a, u32 n) { return i32(u32(a) << (n & 31u)); }
DEVICE u32 shifted_right(u32 a, u32 n) { return a >> (n & 31u); }
DEVICE i32 shifted_right(i32 a, u32 n) { return a >> (n & 31u); }

// What no whole number is becomes the nearest, NaN zero.
DEVICE u32 to_u32(f32 a) { return ::__float2uint_rz(a); }
DEVICE u32 to_u32(i32 a) { return u32(a); }
DEVICE u32 to_u32(bool a) { return u32(a); }
DEVICE i32 to_i32(f32 a) { return ::__float2int_rz(a); }
DEVICE i32 to_i32(u32 a) { return i32(a); }
DEVICE i32 to_i32(bool a) { return i32(a); }
DEVICE f32 to_f32(u32 a) { return f32(a); }
DEVICE f32 to_f32(i32 a) { return f32(a); }
DEVICE f32 to_f32(bool a) { return f32(a); }
template <typename T> DEVICE bool to_bool(T a) { return a != T(0); }
DEVICE u32 as_u32(f32 a) { return ::__float_as_uint(a); }
DEVICE u32 as_u32(i32 a) { return u32(a); }
DEVICE i32 as_i32(f32 a) { return i32(::__float_as_uint(a)); }
DEVICE i32 as_i32(u32 a) { return i32(a); }
DEVICE f32 as_f32(u32 a) { return ::__uint_as_float(a); }
DEVICE f32 as_f32(i32 a) { return ::__uint_as_float(u32(a)); }

template <typename T> DEVICE T min(T a, T b) { return a < b ? a : b; }
template <typename T> DEVICE T max(T a, T b) { return a > b ? a : b; }
template <typename T> DEVICE T clamp(T a, T low, T high) { return maths::min(maths::max(a, low), high); }
DEVICE f32 saturate(f32 a) { return maths::clamp(a, 0.0f, 1.0f); }
DEVICE f32 abs(f32 a) { return ::fabsf(a); }
DEVICE u32 abs(u32 a) { return a; }
DEVICE i32 abs(i32 a) { return a < 0 ? negative(a) : a; }
DEVICE f32 sign(f32 a) { return a > 0.0f ? 1.0f : a < 0.0f ? -1.0f : 0.0f; }
DEVICE i32 sign(i32 a) { return a > 0 ? 1 : a < 0 ? -1 : 0; }
DEVICE f32 floor(f32 a) { return ::floorf(a); }
DEVICE f32 ceil(f32 a) { return ::ceilf(a); }
DEVICE f32 trunc(f32 a) { return ::truncf(a); }
// Halves to even.
DEVICE f32 round(f32 a) { return ::rintf(a); }
DEVICE f32 fract(f32 a) { return a - ::floorf(a); }
DEVICE f32 sqrt(f32 a) { return ::sqrtf(a); }
DEVICE f32 inverse_sqrt(f32 a) { return 1.0f / ::sqrtf(a); }
DEVICE f32 fma(f32 a, f32 b, f32 c) { return ::fmaf(a, b, c); }
DEVICE f32 mix(f32 a, f32 b, f32 t) { return a * (1.0f - t) + b * t; }
DEVICE f32 step(f32 edge, f32 a) { return edge <= a ? 1.0f : 0.0f; }
DEVICE f32 length(f32 a) { return ::fabsf(a); }
template <typename T> DEVICE T select(T no, T yes, bool which) { return which ? yes : no; }

DEVICE u32 count_leading_zeros(u32 a) { return u32(::__clz(i32(a))); }
DEVICE i32 count_leading_zeros(i32 a) { return ::__clz(a); }
DEVICE u32 count_trailing_zeros(u32 a) { return u32(::__clz(i32(::__brev(a)))); }
DEVICE i32 count_trailing_zeros(i32 a) { return ::__clz(i32(::__brev(u32(a)))); }
DEVICE u32 count_one_bits(u32 a) { return u32(::__popc(a)); }
DEVICE i32 count_one_bits(i32 a) { return ::__popc(u32(a)); }
DEVICE u32 reverse_bits(u32 a) { return ::__brev(a); }
DEVICE i32 reverse_bits(i32 a) { return i32(::__brev(u32(a))); }
// Of none, all bits.
DEVICE u32 first_leading_bit(u32 a) { return 31u - count_leading_zeros(a); }
DEVICE i32 first_leading_bit(i32 a) { return i32(first_leading_bit(u32(a < 0 ? ~a : a))); }
DEVICE u32 first_trailing_bit(u32 a) { return a == 0u ? ~0u : count_trailing_zeros(a); }
DEVICE i32 first_trailing_bit(i32 a) { return i32(first_trailing_bit(u32(a))); }

}

#define SAME(a, b) ((a) == (b))
#define OTHER(a, b) ((a) != (b))
#define LESS(a, b) ((a) < (b))
#define LESS_OR_SAME(a, b) ((a) <= (b))
#define MORE(a, b) ((a) > (b))
#define MORE_OR_SAME(a, b) ((a) >= (b))
#define BOTH(a, b) T((a) & (b))
#define EITHER(a, b) T((a) | (b))
#define ONE_OF(a, b) T((a) ^ (b))
#define NOT(a) (!(a))
#define COMPLEMENT(a) T(~(a))
LIFT2(operator+, T, maths::sum)
LIFT2(operator-, T, maths::difference)
LIFT2(operator*, T, maths::product)
LIFT2(operator/, T, maths::quotient)
LIFT2(operator%, T, maths::remainder)
LIFT2(operator==, bool, SAME)
LIFT2(operator!=, bool, OTHER)
LIFT2(operator<, bool, LESS)
LIFT2(operator<=, bool, LESS_OR_SAME)
LIFT2(operator>, bool, MORE)
LIFT2(operator>=, bool, MORE_OR_SAME)
LIFT2(operator&, T, BOTH)
LIFT2(operator|, T, EITHER)
LIFT2(operator^, T, ONE_OF)
LIFT1(operator-, T, maths::negative)
LIFT1(operator!, bool, NOT)
LIFT1(operator~, T, COMPLEMENT)
template <typename T> DEVICE vec2<T> operator*(vec2<T> a, T b) { return a * vec2<T>::splat(b); }
template <typename T> DEVICE vec3<T> operator*(vec3<T> a, T b) { return a * vec3<T>::splat(b); }
template <typename T> DEVICE vec4<T> operator*(vec4<T> a, T b) { return a * vec4<T>::splat(b); }
template <typename T> DEVICE vec2<T> operator*(T a, vec2<T> b) { return vec2<T>::splat(a) * b; }
template <typename T> DEVICE vec3<T> operator*(T a, vec3<T> b) { return vec3<T>::splat(a) * b; }
template <typename T> DEVICE vec4<T> operator*(T a, vec4<T> b) { return vec4<T>::splat(a) * b; }

namespace maths {

#define SHIFTED(OF) \
    template <typename T> DEVICE vec2<T> OF(vec2<T> a, vec2<u32> n) { return {OF(a.x, n.x), OF(a.y, n.y)}; } \
    template <typename T> DEVICE vec3<T> OF(vec3<T> a, vec3<u32> n) { \
        return {OF(a.x, n.x), OF(a.y, n.y), OF(a.z, n.z)}; \
    } \
    template <typename T> DEVICE vec4<T> OF(vec4<T> a, vec4<u32> n) { \
        return {OF(a.x, n.x), OF(a.y, n.y), OF(a.z, n.z), OF(a.w, n.w)}; \
    }
SHIFTED(shifted_left)
SHIFTED(shifted_right)
LIFT1(to_u32, u32, maths::to_u32)
LIFT1(to_i32, i32, maths::to_i32)
LIFT1(to_f32, f32, maths::to_f32)
LIFT1(to_bool, bool, maths::to_bool)
LIFT1(as_u32, u32, maths::as_u32)
LIFT1(as_i32, i32, maths::as_i32)
LIFT1(as_f32, f32, maths::as_f32)
LIFT2(min, T, maths::min)
LIFT2(max, T, maths::max)
LIFT3(clamp, T, maths::clamp)
LIFT1(saturate, T, maths::saturate)
LIFT1(abs, T, maths::abs)
LIFT1(sign, T, maths::sign)
LIFT1(floor, T, maths::floor)
LIFT1(ceil, T, maths::ceil)
LIFT1(trunc, T, maths::trunc)
LIFT1(round, T, maths::round)
LIFT1(fract, T, maths::fract)
LIFT1(sqrt, T, maths::sqrt)
LIFT1(inverse_sqrt, T, maths::inverse_sqrt)
LIFT3(fma, T, maths::fma)
LIFT3(mix, T, maths::mix)
LIFT2(step, T, maths::step)
LIFT3(select, bool, maths::select)
LIFT1(count_leading_zeros, T, maths::count_leading_zeros)
LIFT1(count_trailing_zeros, T, maths::count_trailing_zeros)
LIFT1(count_one_bits, T, maths::count_one_bits)
LIFT1(reverse_bits, T, maths::reverse_bits)
LIFT1(first_leading_bit, T, maths::first_leading_bit)
LIFT1(first_trailing_bit, T, maths::first_trailing_bit)
template <typename T> DEVICE vec2<T> mix(vec2<T> a, vec2<T> b, T t) { return maths::mix(a, b, vec2<T>::splat(t)); }
template <typename T> DEVICE vec3<T> mix(vec3<T> a, vec3<T> b, T t) { return maths::mix(a, b, vec3<T>::splat(t)); }
template <typename T> DEVICE vec4<T> mix(vec4<T> a, vec4<T> b, T t) { return maths::mix(a, b, vec4<T>::splat(t)); }

DEVICE bool all(bool a) { return a; }
DEVICE bool all(vec2<bool> a) { return a.x & a.y; }
DEVICE bool all(vec3<bool> a) { return a.x & a.y & a.z; }
DEVICE bool all(vec4<bool> a) { return a.x & a.y & a.z & a.w; }
DEVICE bool any(bool a) { return a; }
DEVICE bool any(vec2<bool> a) { return a.x | a.y; }
DEVICE bool any(vec3<bool> a) { return a.x | a.y | a.z; }
DEVICE bool any(vec4<bool> a) { return a.x | a.y | a.z | a.w; }

// Summed from the first component on.
template <typename T> DEVICE T dot(vec2<T> a, vec2<T> b) {
    const vec2<T> c = a * b;
    return maths::sum(c.x, c.y);
}
template <typename T> DEVICE T dot(vec3<T> a, vec3<T> b) {
    const vec3<T> c = a * b;
    return maths::sum(maths::sum(c.x, c.y), c.z);
}
template <typename T> DEVICE T dot(vec4<T> a, vec4<T> b) {
    const vec4<T> c = a * b;
    return maths::sum(maths::sum(maths::sum(c.x, c.y), c.z), c.w);
}
DEVICE vec3<f32> cross(vec3<f32> a, vec3<f32> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename V> DEVICE f32 length(V a) { return ::sqrtf(maths::dot(a, a)); }
DEVICE f32 distance(f32 a, f32 b) { return ::fabsf(a - b); }
template <typename V> DEVICE f32 distance(V a, V b) { return maths::length(a - b); }
template <typename V> DEVICE V normalize(V a) { return a / V::splat(maths::length(a)); }

// Words that other threads write.
template <typename T> DEVICE T load(const T& from) { return *static_cast<const volatile T*>(&from); }
template <typename T> DEVICE void store(T& to, T a) { *static_cast<volatile T*>(&to) = a; }
// What was there, and whether it was exchanged.
template <typename R, typename T> DEVICE R exchanged(T& at, T compared, T a) {
    const T old = ::atomicCAS(&at, compared, a);
    return {old, old == compared};
}

// What a block shares begins as zero, which its threads write together.
template <typename T> DEVICE void clear(T& shared, u32 thread, u32) {
    if (thread == 0u) shared = T();
}
template <typename T, u32 N> DEVICE void clear(Array<T, N>& shared, u32 thread, u32 threads) {
    for (u32 i = thread; i < N; i += threads) shared.items[i] = T();
}

}
}
#undef DEVICE
#undef LIFT1
#undef LIFT2
#undef LIFT3
#undef SHIFTED
#undef SAME
#undef OTHER
#undef LESS
#undef LESS_OR_SAME
#undef MORE
#undef MORE_OR_SAME
#undef BOTH
#undef EITHER
#undef ONE_OF
#undef NOT
#undef COMPLEMENT
