//! Texts of WGSL do on a card what they say, by whatever way they get there.

use crate::card::{Card, card};
use ::piles::{Card as _, Commands as _};
use std::iter::once;

const BINDINGS: &str = "
@group(0) @binding(0) var<storage, read_write> out: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read> data: array<u32>;
@group(0) @binding(2) var<uniform> size: u32;
fn put(i: u32, x: u32) { atomicStore(&out[i], x); }
fn real(i: u32) -> f32 { return bitcast<f32>(data[i]); }
";

/// How many workgroups run: so many, or as many as stand in a buffer, of at most so many.
#[derive(Clone, Copy)]
enum Groups {
    Some(u32),
    Told(u32, u32),
}

/// What a text leaves, of words that are zero before.
fn left_by(text: &str, groups: Groups, data: &[u32], length: usize) -> Vec<u32> {
    let card: Card = card();
    let layout = card.layout(1, 1);
    let text = format!("{BINDINGS}{text}");
    let [kernel] = card
        .entries(&text, piles::seen(&text, ["main"]), &layout)
        .unwrap();
    let [out, given] = [length, data.len()].map(|words| card.buffer(words as u64).unwrap());
    card.write(&given, 0, bytemuck::cast_slice(data)).unwrap();
    let size = card.uniform(&[data.len() as u32]).unwrap();
    let bindings = card.bind(&layout, &[&out, &given, &size]);
    let launches = card.launches(6).unwrap();
    let mut todo = card.commands(None);
    match groups {
        Groups::Some(groups) => todo.run(&kernel, &bindings, groups),
        Groups::Told(groups, most) => {
            let counts = [7, 1, 1, groups, 1, 1];
            let counts = bytemuck::cast_slice(&counts);
            card.write(&launches, 0, counts).unwrap();
            todo.run_told(&kernel, &bindings, (&launches, 1), most);
        }
    }
    let mut left = Vec::new();
    let read = |words: &[f32]| left.extend(words.iter().map(|word| word.to_bits()));
    card.fetch(todo, &mut Default::default(), &out, once(0..length), read)
        .unwrap();
    left
}

/// The same of one invocation's statements, and of functions before them.
fn left_by_one(functions: &str, statements: &str, data: &[u32], length: usize) -> Vec<u32> {
    let text = format!("{functions} @compute @workgroup_size(1) fn main() {{ {statements} }}");
    left_by(&text, Groups::Some(1), data, length)
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn loops_go_on_and_end_where_they_say() {
    let nested = "
        var n = 0u;
        for (var i = 0u; i < 5u; i++) {
            for (var j = 0u; j < 5u; j++) {
                if (j == i) { continue; }
                if (j > 3u) { break; }
                n = n * 3u + i * 5u + j;
                if (n > 1000000u) { n %= 1000u; continue; }
            }
            if (i == 3u) { continue; }
            n += 1u;
        }
        put(0u, n);
        var k = 0u;
        var sum = 0u;
        loop {
            if (k == 3u) { k += 2u; continue; }
            sum += k;
            continuing { k += 1u; break if k >= 9u; }
        }
        put(1u, sum);
        put(2u, k);
        var last = 0u;
        for (var i = 0u; i < 4u; i++) {
            var fresh: u32;
            var all: array<u32, 2>;
            fresh += i;
            all[i & 1u] += fresh + 1u;
            last = last * 10u + fresh + all[0] + all[1];
        }
        put(3u, last);";
    let mut n: u32 = 0;
    for i in 0..5 {
        for j in 0..5 {
            if j == i {
                continue;
            }
            if j > 3 {
                break;
            }
            n = n * 3 + i * 5 + j;
            if n > 1_000_000 {
                n %= 1000;
            }
        }
        n += u32::from(i != 3);
    }
    // 0 + 1 + 2, and 6 + 7 + 8.
    assert_eq!(left_by_one("", nested, &[0], 4), [n, 24, 9, 1357]);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn switches_break_return_and_go_on() {
    let functions = "
        fn kind(x: u32) -> u32 {
            switch x {
                case 1u, 2u: { return 10u; }
                case 7u: { if (size > 3u) { break; } return 20u; }
                default: { return 30u; }
            }
            return 40u;
        }";
    let statements = "
        var n = 0u;
        for (var i = 0u; i < size; i++) {
            switch data[i] {
                case 0u: { continue; }
                case 5u: { n += 1000u; break; }
                default: { n += kind(data[i]); }
            }
            n += 1u;
        }
        put(0u, n);";
    // Of 0 nothing; 5: 1000; 1 and 2: 10; 7: 40; 9: 30; and one each.
    let data = [0, 5, 1, 2, 7, 9];
    assert_eq!(left_by_one(functions, statements, &data, 1), [1095]);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_is_read_is_read_in_its_turn() {
    let functions = "
        struct Both { a: u32, b: array<u32, 3> }
        fn bump(a: ptr<function, u32>) -> u32 { *a += 1u; return *a; }
        fn filled(x: u32) -> Both { var both: Both; both.a = x; both.b[x & 1u] = x; return both; }";
    let statements = "
        var a = data[0];
        let s = a + bump(&a) * 100u + a;
        put(0u, s);
        put(1u, a);
        let before = atomicLoad(&out[0]);
        put(0u, 1u);
        put(2u, before + atomicLoad(&out[0]));
        var one = filled(data[0]);
        var two = one;
        two.b[2] = 9u;
        put(3u, one.a * 1000u + one.b[0] * 100u + one.b[1] * 10u + one.b[2]);
        put(4u, two.b[2]);";
    let left = left_by_one(functions, statements, &[5], 5);
    assert_eq!(left, [1, 6, 612, 5050, 9]);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn whole_numbers_wrap_and_divide() {
    let statements = "
        put(0u, data[0] * data[1]);
        put(1u, data[1] / data[2]);
        put(2u, bitcast<u32>(-bitcast<i32>(data[3]) / 3));
        put(3u, bitcast<u32>(bitcast<i32>(data[3]) % 4));
        put(4u, bitcast<u32>(bitcast<i32>(data[4]) >> 4u));
        put(5u, data[4] >> 4u);
        put(6u, u32(real(5u)));
        put(7u, bitcast<u32>(i32(real(6u))));
        put(8u, bitcast<u32>(f32(data[4])));
        put(9u, u32(data[0] > data[1]) + 2u * u32(bool(data[1])));
        put(10u, bitcast<u32>(round(real(7u))));
        put(11u, data[0] - data[4]);";
    let seven = (-7_i32) as u32;
    let high = 0x8000_0001_u32;
    let reals = [3.99_f32, -3.99, 2.5].map(f32::to_bits);
    let data = [
        0xffff_ffff,
        17,
        5,
        seven,
        high,
        reals[0],
        reals[1],
        reals[2],
    ];
    let expected = [
        0xffff_ffff_u32.wrapping_mul(17),
        3,
        2,
        (-3_i32) as u32,
        (high as i32 >> 4) as u32,
        high >> 4,
        3,
        (-3_i32) as u32,
        (high as f32).to_bits(),
        3,
        2.0_f32.to_bits(),
        0xffff_ffff - high,
    ];
    assert_eq!(left_by_one("", statements, &data, 12), expected);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn vectors_are_taken_apart_and_put_together() {
    let statements = "
        let a = vec3(real(0u), real(1u), real(2u));
        var b = a.zxy;
        b[size - 2u] = 10.0;
        let picked = select(a, b, a < b);
        put(0u, u32(picked.x * 100.0 + picked.y * 10.0 + picked.z));
        put(1u, u32(any(a == b)) + 2u * u32(all(a < vec3(9.0))));
        let c = cross(a, b);
        put(2u, u32(dot(c, a) + 1.0));
        put(3u, u32(length(vec2(a.z, 4.0)) + 0.5));
        let words = vec4(data[3], 1u, 2u, 3u);
        put(4u, words.wzyx[size - 4u] + min(words, words.yxwz).x * 10u);
        let grown = max(abs(a - b), vec3(0.5)) * 2.0;
        put(5u, u32(grown.x) * 100u + u32(grown.y) * 10u + u32(grown.z));";
    // a = (1, 2, 3), b = (3, 1, 10): picked (3, 2, 10); differences (2, 1, 7).
    let reals = [1.0_f32, 2.0, 3.0].map(f32::to_bits);
    let data = [reals[0], reals[1], reals[2], 7];
    let left = left_by_one("", statements, &data, 6);
    assert_eq!(left, [330, 2, 1, 5, 13, 434]);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn invocations_share_words_in_turn() {
    let text = "
        var<workgroup> own: array<u32, 64>;
        var<workgroup> all: atomic<u32>;
        @compute @workgroup_size(64)
        fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) i: u32,
            @builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
            own[i] = data[id.x];
            workgroupBarrier();
            for (var reach = 1u; reach < 64u; reach = reach << 1u) {
                var more = 0u;
                if (i >= reach) { more = own[i - reach]; }
                workgroupBarrier();
                own[i] += more;
                workgroupBarrier();
            }
            atomicAdd(&all, own[63u - i] & 1u);
            workgroupBarrier();
            atomicAdd(&out[0], data[id.x]);
            atomicMax(&out[1], own[i] * groups.x);
            atomicOr(&out[2], 1u << (id.x % 32u));
            if (i == 63u) { put(3u + group.x, own[i] + 100000u * atomicLoad(&all)); }
        }";
    let data: Vec<u32> = (0..192).map(|i| i * i % 7).collect();
    let left = left_by(text, Groups::Some(3), &data, 6);
    let blocks = data.chunks(64).map(|block| {
        let sums = block.iter().scan(0, |sum, x| {
            *sum += x;
            Some(*sum)
        });
        let odd: u32 = sums.map(|sum| sum & 1).sum();
        block.iter().sum::<u32>() + 100_000 * odd
    });
    let blocks = Vec::from_iter(blocks);
    let most = data.chunks(64).map(|block| block.iter().sum::<u32>());
    let expected = [data.iter().sum(), 3 * most.max().unwrap(), u32::MAX];
    assert_eq!(left[..3], expected);
    assert_eq!(left[3..], blocks);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn as_many_workgroups_run_as_stand_in_a_buffer() {
    let text = "
        @compute @workgroup_size(4)
        fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) all: vec3<u32>) {
            put(id.x, id.x + 10u * all.x);
        }";
    for (told, expected) in [
        (2, [20, 21, 22, 23, 24, 25, 26, 27, 0, 0, 0, 0]),
        (0, [0; 12]),
        (3, std::array::from_fn(|i| i as u32 + 30)),
    ] {
        assert_eq!(left_by(text, Groups::Told(told, 3), &[0], 12), expected);
    }
}
