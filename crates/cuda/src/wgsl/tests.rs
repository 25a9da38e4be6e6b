//! What a few constructs become; nothing is compiled.

use super::{WgslError, to_cuda};

const BINDINGS: &str = "@group(0) @binding(0) var<storage, read_write> out: array<u32>;
@group(0) @binding(2) var<uniform> size: u32;
@group(0) @binding(1) var<storage, read> data: array<vec2<f32>>;
";

/// What comes behind the prelude.
fn translated(text: &str) -> String {
    let text = to_cuda(&format!("{BINDINGS}{text}")).unwrap().text;
    let (_, shader) = text.split_once("namespace shader {\n").unwrap();
    numbered_anew(shader)
}

/// With names of values, which naga numbers, numbered from 0 in the order in which they come.
fn numbered_anew(text: &str) -> String {
    let is_name = |word: &str| {
        let digits = word.strip_prefix('e').unwrap_or("");
        !digits.is_empty() && digits.bytes().all(|c| c.is_ascii_digit())
    };
    let mut known: Vec<&str> = Vec::new();
    let mut anew = String::new();
    for word in text.split_inclusive(|c: char| !c.is_ascii_alphanumeric()) {
        let (name, end) = word.split_at(
            word.trim_end_matches(|c: char| !c.is_ascii_alphanumeric())
                .len(),
        );
        if is_name(name) {
            let number = known
                .iter()
                .position(|it| *it == name)
                .unwrap_or(known.len());
            if number == known.len() {
                known.push(name);
            }
            anew += &format!("e{number}{end}");
        } else {
            anew += word;
        }
    }
    anew
}

/// The same of an entry point's statements.
fn body(statements: &str) -> String {
    let entry = "@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32)";
    let text = translated(&format!("{entry} {{ {statements} }}"));
    let (_, body) = text.split_once("const u32 i = threadIdx.x;\n").unwrap();
    let lines = body.lines().map(str::trim);
    lines.collect::<Vec<_>>().join("\n")
}

fn refused(text: &str) -> String {
    to_cuda(text).unwrap_err().to_string()
}

#[test]
fn a_kernel_takes_all_that_is_bound_in_the_order_of_its_numbers() {
    let text = translated("@compute @workgroup_size(8, 2) fn main() {}");
    let head = "extern \"C\" __global__ void __launch_bounds__(16) entry_main(u32* __restrict__ out, \
                const vec2<f32>* __restrict__ data, const u32* __restrict__ size, \
                const u32* __restrict__ blocks) {";
    assert!(text.contains(head), "{text}");
}

#[test]
fn what_is_read_has_a_name_from_there_on() {
    let expected = "const u32 a = globals.out[i];\n\
                    globals.out[2] = a + (7u * globals.size);\n\
                    const u32 e0 = globals.out[2];\n\
                    globals.out[1] = e0 + a;\n}\n}";
    assert_eq!(
        body("let a = out[i]; out[2] = a + 7u * size; out[1] = out[2] + a;"),
        expected
    );
}

#[test]
fn a_loop_with_continue_goes_on_at_a_label() {
    let text = body("for (var k = 0u; k < 9u; k++) { if (k == i) { continue; } out[k] = 1u; }");
    assert!(text.contains("goto next;\n}\n"), "{text}");
    assert!(
        text.contains("}\nnext:;\nconst u32 e3 = k;\nk = e3 + 1u;\n}\n"),
        "{text}"
    );
}

#[test]
fn whole_numbers_are_divided_as_wgsl_has_it() {
    let text = body("out[0] = out[1] / 3u; out[2] = i / size; out[3] = 1u << i;");
    assert!(text.contains(" / 3u;"), "{text}");
    assert!(text.contains("maths::quotient(i, globals.size)"), "{text}");
    assert!(text.contains("maths::shifted_left(1u, i)"), "{text}");
}

#[test]
fn numbers_have_their_bits() {
    let text = body("out[0] = u32(data[0].x * 0.1 + 1e-45 - 1.5);");
    assert!(text.contains("0x1.99999ap-4f"), "{text}");
    assert!(text.contains("0x0.000002p-126f"), "{text}");
    assert!(text.contains("- 1.5f)"), "{text}");
}

#[test]
fn what_cannot_be_translated_is_told() {
    let vectors = "@group(0) @binding(0) var<storage> a: array<vec3<f32>>;";
    assert_eq!(
        refused(&format!(
            "{vectors} @compute @workgroup_size(1) fn main() {{}}"
        )),
        "this of WGSL has no CUDA yet: an array in a buffer whose items vec3<f32> lie 16 bytes apart, but take 12 in C++"
    );
    assert!(matches!(to_cuda("fn"), Err(WgslError::Parse(_))));
    let invalid = "fn f() -> u32 {}";
    assert!(matches!(to_cuda(invalid), Err(WgslError::Invalid(_))));
}
