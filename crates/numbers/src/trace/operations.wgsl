// What WGSL lacks, or leaves loose.
fn lesser(a: f32, b: f32) -> f32 {
    return select(b, a, a < b);
}
fn greater(a: f32, b: f32) -> f32 {
    return select(b, a, a > b);
}
fn nearest(x: f32) -> f32 {
    return round(x);
}
fn whole(x: f32) -> u32 {
    return u32(x);
}
fn with_sign(x: f32, sign: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) & 0x7fffffffu) | (bitcast<u32>(sign) & 0x80000000u));
}
fn power_of_two(n: i32) -> f32 {
    return bitcast<f32>(u32(n + 127) << 23u);
}
// x * 2^n in two factors, each a normal power of two.
fn scaled(x: f32, n: f32) -> f32 {
    let whole = i32(lesser(greater(n, -252.0f), 252.0f));
    let half = whole >> 1u;
    return x * power_of_two(half) * power_of_two(whole - half);
}
fn fraction(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) & 0x807fffffu) | 0x3f800000u);
}
fn exponent(x: f32) -> f32 {
    return f32(i32((bitcast<u32>(x) >> 23u) & 0xffu) - 127);
}
